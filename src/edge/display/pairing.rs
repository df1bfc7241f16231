//! Attempts at the pairing code. Each wrong code locks its address for a while, and longer with every further one. Locks hold
//! for all connections of an address together.

use std::collections::{BTreeMap, VecDeque};
use std::net::IpAddr;
use std::time::{Duration, Instant};

use super::code::is_code;

/// Lock after a wrong code.
const WAIT: Duration = Duration::from_secs(1);
/// Number of wrong codes that count as typing errors; each further one doubles the lock.
const SLIPS: u32 = 4;
/// Longest lock.
const LONGEST: Duration = Duration::from_secs(300);
/// Time after the end of its lock at which an address starts anew.
const FORGOTTEN: Duration = Duration::from_secs(3600);
/// Number of addresses whose wrong codes are remembered; beyond it, the address whose lock ends first is forgotten.
const MAX_ADDRESSES: usize = 1024;
/// Number of paired pages that are remembered.
const MAX_PAGES: usize = 64;

/// Result of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairingVerdict {
    Right,
    /// The code was wrong, and the address is locked for this time.
    Wrong(Duration),
    /// The code was not checked: the address is locked for this time.
    Locked(Duration),
}

/// Wrong codes of an address.
#[derive(Clone, Copy, Debug)]
struct WrongCodes {
    count: u32,
    locked_until: Instant,
}

/// The pairing code and the history of attempts.
#[derive(Debug)]
pub(super) struct PairingDesk {
    code: String,
    wrong: BTreeMap<IpAddr, WrongCodes>,
    /// Names of paired pages, the oldest first. A name is a random number that only its page knows.
    known: VecDeque<String>,
}

impl PairingDesk {
    /// A desk that asks for this code and has seen nobody yet.
    pub fn new(code: String) -> PairingDesk {
        PairingDesk { code, wrong: BTreeMap::new(), known: VecDeque::new() }
    }

    /// Checks a code. A page that has paired before is let in with the right code even while its address is locked, so that
    /// nobody can lock out the participant's page.
    pub fn attempt(&mut self, address: IpAddr, page: &str, typed: &str, now: Instant) -> PairingVerdict {
        let is_right = is_code(typed, &self.code);
        if is_right && self.known.iter().any(|known| known == page) {
            return PairingVerdict::Right;
        }
        let before = self.wrong.get(&address).filter(|wrong| now < wrong.locked_until + FORGOTTEN).copied();
        if let Some(wrong) = before.filter(|wrong| now < wrong.locked_until) {
            return PairingVerdict::Locked(wrong.locked_until - now);
        }
        if is_right {
            self.wrong.remove(&address);
            self.known.push_back(page.to_string());
            if self.known.len() > MAX_PAGES {
                self.known.pop_front();
            }
            return PairingVerdict::Right;
        }
        let count = before.map_or(0, |wrong| wrong.count).saturating_add(1);
        let wait = wait_after(count);
        self.wrong.insert(address, WrongCodes { count, locked_until: now + wait });
        if self.wrong.len() > MAX_ADDRESSES {
            let first = self.wrong.iter().min_by_key(|(_, wrong)| wrong.locked_until).map(|(address, _)| *address);
            first.map(|first| self.wrong.remove(&first));
        }
        PairingVerdict::Wrong(wait)
    }
}

/// Lock after this number of wrong codes.
fn wait_after(count: u32) -> Duration {
    let doublings = count.saturating_sub(SLIPS).min(16);
    (WAIT * 2_u32.pow(doublings)).min(LONGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 7));
    const THERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 8));

    fn desk() -> PairingDesk {
        PairingDesk::new("ABC234".to_string())
    }

    #[test]
    fn who_guesses_tries_some_dozen_codes_an_hour_however_often_it_asks() {
        let (mut desk, start) = (desk(), Instant::now());
        let tried = |verdict| matches!(verdict, PairingVerdict::Wrong(_));
        // 400 times a second, as from 400 connections.
        let times = (0..3600 * 400).map(|step| start + Duration::from_micros(2500 * step));
        let looked_at = times.filter(|now| tried(desk.attempt(HERE, "guesser", "AAAAAA", *now))).count();
        assert!((10..30).contains(&looked_at), "{looked_at} codes in an hour");
    }

    #[test]
    fn waits_double_after_some_slips_and_only_for_their_address() {
        let (mut desk, mut now) = (desk(), Instant::now());
        let mut waits = Vec::new();
        for _ in 0..14 {
            let PairingVerdict::Wrong(wait) = desk.attempt(HERE, "page", "WRONG2", now) else { panic!("a wrong code") };
            assert_eq!(desk.attempt(HERE, "page", "ABC234", now), PairingVerdict::Locked(wait), "not looked at");
            assert_eq!(desk.attempt(THERE, &format!("page {now:?}"), "abc 234", now), PairingVerdict::Right);
            waits.push(wait.as_secs());
            now += wait;
        }
        assert_eq!(waits, [1, 1, 1, 1, 2, 4, 8, 16, 32, 64, 128, 256, 300, 300]);
        assert_eq!(desk.attempt(HERE, "page", "ABC234", now), PairingVerdict::Right, "after its wait");
        assert_eq!(desk.attempt(HERE, "other", "WRONG2", now), PairingVerdict::Wrong(WAIT), "slips begin anew");
    }

    #[test]
    fn a_page_that_was_let_in_comes_back_while_its_address_is_locked() {
        let (mut desk, now) = (desk(), Instant::now());
        assert_eq!(desk.attempt(HERE, "participant", "ABC234", now), PairingVerdict::Right);
        assert_eq!(desk.attempt(HERE, "guesser", "AAAAAA", now), PairingVerdict::Wrong(WAIT));
        assert_eq!(desk.attempt(HERE, "participant", "ABC234", now), PairingVerdict::Right);
        assert_eq!(desk.attempt(HERE, "guesser", "ABC234", now), PairingVerdict::Locked(WAIT));
        // Its name alone is no code.
        assert_eq!(desk.attempt(HERE, "participant", "AAAAAA", now), PairingVerdict::Locked(WAIT));
    }

    #[test]
    fn attempts_from_many_addresses_are_kept_in_bounded_memory() {
        let (mut desk, now) = (desk(), Instant::now());
        for number in 0..5000_u32 {
            desk.attempt(IpAddr::V4(number.into()), "page", "WRONG2", now);
        }
        for number in 0..200 {
            desk.attempt(THERE, &format!("page {number}"), "ABC234", now);
        }
        assert!(desk.wrong.len() <= MAX_ADDRESSES && desk.known.len() <= MAX_PAGES);
    }
}
