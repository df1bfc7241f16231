//! Check of pairing codes, which pages of the display and gaze senders send. Each wrong code locks its sender's network
//! address for a while, and each further one locks it longer. A lock holds for all connections of an address together.
//! Of all addresses together, only a few wrong codes per second are checked, since the sender address of a datagram can
//! be forged.

use std::collections::{BTreeMap, VecDeque};
use std::net::IpAddr;
use std::time::{Duration, Instant};

use super::connection_table::network_of;
use super::pairing_code::is_code;

/// Time for which a network address is locked after a wrong pairing code.
const WAIT: Duration = Duration::from_secs(1);
/// Number of wrong pairing codes that count as typing errors; each further one doubles the lock time.
const SLIPS: u32 = 4;
/// Longest time for which a network address is locked.
const LONGEST: Duration = Duration::from_secs(300);
/// Time after the end of an address's lock at which the address's wrong codes are forgotten.
const FORGOTTEN: Duration = Duration::from_secs(3600);
/// Largest number of wrong codes of all addresses together that are checked within [`WAIT`].
const MOST_WRONG: u32 = 10;
/// Number of addresses whose wrong codes are remembered; beyond it, the address whose lock ends first is forgotten.
const MAX_ADDRESSES: usize = 1024;
/// Number of paired participant pages that are remembered.
const MAX_PAGES: usize = 64;

/// Result of an attempt to pair with a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairingVerdict {
    Right,
    /// The pairing code was wrong, and the sender's address is locked for this time.
    Wrong(Duration),
    /// The pairing code was not checked: the sender's address is still locked for this time.
    Locked(Duration),
}

/// Wrong pairing codes that a network address has sent.
#[derive(Clone, Copy, Debug)]
struct WrongCodes {
    count: u32,
    locked_until: Instant,
}

/// The pairing code and the history of attempts to pair.
#[derive(Debug)]
pub(super) struct PairingCodeCheck {
    code: String,
    wrong: BTreeMap<IpAddr, WrongCodes>,
    /// Start of the present counting interval for wrong codes of all addresses, and number of wrong codes in it.
    recent: Option<(Instant, u32)>,
    /// Names of paired pages, oldest first. A page's name is a random number that only this page knows.
    known: VecDeque<String>,
}

impl PairingCodeCheck {
    /// A check of this code without any attempt so far.
    pub fn new(code: String) -> PairingCodeCheck {
        PairingCodeCheck { code, wrong: BTreeMap::new(), recent: None, known: VecDeque::new() }
    }

    /// Checks a code that came from this address or from the page with this name. A page that has paired before is
    /// admitted with the right code even while its address is locked, so that nobody can lock out the participant's
    /// page.
    pub fn attempt(&mut self, address: IpAddr, page: Option<&str>, typed: &str, now: Instant) -> PairingVerdict {
        let (address, is_right) = (network_of(address), is_code(typed, &self.code));
        if is_right && page.is_some_and(|page| self.known.iter().any(|known| known == page)) {
            return PairingVerdict::Right;
        }
        let before = self.wrong.get(&address).filter(|wrong| now < wrong.locked_until + FORGOTTEN).copied();
        if let Some(wrong) = before.filter(|wrong| now < wrong.locked_until) {
            return PairingVerdict::Locked(wrong.locked_until - now);
        }
        if let Some(left) = self.crowd_lock(now) {
            return PairingVerdict::Locked(left);
        }
        if is_right {
            self.wrong.remove(&address);
            self.known.extend(page.map(str::to_string));
            if self.known.len() > MAX_PAGES {
                self.known.pop_front();
            }
            return PairingVerdict::Right;
        }
        self.recent = self.recent.map(|(since, count)| (since, count + 1)).or(Some((now, 1)));
        let count = before.map_or(0, |wrong| wrong.count).saturating_add(1);
        let wait = wait_after(count);
        self.wrong.insert(address, WrongCodes { count, locked_until: now + wait });
        if self.wrong.len() > MAX_ADDRESSES {
            let first = self.wrong.iter().min_by_key(|(_, wrong)| wrong.locked_until).map(|(address, _)| *address);
            first.map(|first| self.wrong.remove(&first));
        }
        PairingVerdict::Wrong(wait)
    }

    /// Time for which no code of any sender is checked, since there were too many wrong ones; `None` if codes are
    /// checked.
    fn crowd_lock(&mut self, now: Instant) -> Option<Duration> {
        self.recent = self.recent.filter(|(since, _)| now < *since + WAIT);
        self.recent.filter(|(_, count)| *count >= MOST_WRONG).map(|(since, _)| since + WAIT - now)
    }
}

/// Time for which a network address is locked after this number of wrong codes.
fn wait_after(count: u32) -> Duration {
    let doublings = count.saturating_sub(SLIPS).min(16);
    (WAIT * 2_u32.pow(doublings)).min(LONGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 7));
    const THERE: IpAddr = IpAddr::V4(std::net::Ipv4Addr::new(10, 0, 0, 8));

    fn desk() -> PairingCodeCheck {
        PairingCodeCheck::new("ABC234".to_string())
    }

    #[test]
    fn who_guesses_tries_some_dozen_codes_an_hour_however_often_it_asks() {
        let (mut desk, start) = (desk(), Instant::now());
        let tried = |verdict| matches!(verdict, PairingVerdict::Wrong(_));
        // Test: codes are tried 400 times per second, as if from 400 connections.
        let times = (0..3600 * 400).map(|step| start + Duration::from_micros(2500 * step));
        let looked_at = times.filter(|now| tried(desk.attempt(HERE, Some("guesser"), "AAAAAA", *now))).count();
        assert!((10..30).contains(&looked_at), "{looked_at} codes in an hour");
    }

    #[test]
    fn waits_double_after_some_slips_and_only_for_their_address() {
        let (mut desk, mut now) = (desk(), Instant::now());
        let mut waits = Vec::new();
        for _ in 0..14 {
            let PairingVerdict::Wrong(wait) = desk.attempt(HERE, Some("page"), "WRONG2", now) else {
                panic!("a wrong code")
            };
            assert_eq!(desk.attempt(HERE, Some("page"), "ABC234", now), PairingVerdict::Locked(wait), "not looked at");
            assert_eq!(desk.attempt(THERE, Some(&format!("page {now:?}")), "abc 234", now), PairingVerdict::Right);
            waits.push(wait.as_secs());
            now += wait;
        }
        assert_eq!(waits, [1, 1, 1, 1, 2, 4, 8, 16, 32, 64, 128, 256, 300, 300]);
        assert_eq!(desk.attempt(HERE, Some("page"), "ABC234", now), PairingVerdict::Right, "after its wait");
        assert_eq!(desk.attempt(HERE, Some("other"), "WRONG2", now), PairingVerdict::Wrong(WAIT), "slips begin anew");
    }

    #[test]
    fn a_page_that_was_let_in_comes_back_while_its_address_is_locked() {
        let (mut desk, now) = (desk(), Instant::now());
        assert_eq!(desk.attempt(HERE, Some("participant"), "ABC234", now), PairingVerdict::Right);
        assert_eq!(desk.attempt(HERE, Some("guesser"), "AAAAAA", now), PairingVerdict::Wrong(WAIT));
        assert_eq!(desk.attempt(HERE, Some("participant"), "ABC234", now), PairingVerdict::Right);
        assert_eq!(desk.attempt(HERE, Some("guesser"), "ABC234", now), PairingVerdict::Locked(WAIT));
        // Test: the name of a paired page does not replace the pairing code.
        assert_eq!(desk.attempt(HERE, Some("participant"), "AAAAAA", now), PairingVerdict::Locked(WAIT));
    }

    #[test]
    fn attempts_from_many_addresses_are_kept_in_bounded_memory() {
        let (mut desk, now) = (desk(), Instant::now());
        for number in 0..5000_u32 {
            desk.attempt(IpAddr::V4(number.into()), None, "WRONG2", now + WAIT * number);
        }
        for number in 0..200 {
            desk.attempt(THERE, Some(&format!("page {number}")), "ABC234", now + WAIT * 6000);
        }
        assert!(desk.wrong.len() == MAX_ADDRESSES && desk.known.len() == MAX_PAGES);
    }

    #[test]
    fn addresses_that_are_made_up_buy_no_more_than_ten_guesses_a_second() {
        let (mut desk, start) = (desk(), Instant::now());
        let guess = |desk: &mut PairingCodeCheck, step: u32| {
            let now = start + Duration::from_micros(100) * step;
            matches!(desk.attempt(IpAddr::V4(step.into()), None, "WRONG2", now), PairingVerdict::Wrong(_))
        };
        let checked = (0..600_000).filter(|step| guess(&mut desk, *step)).count();
        assert!((590..=600).contains(&checked), "{checked} codes in a minute");
        let later = start + Duration::from_secs(62);
        assert_eq!(desk.attempt(THERE, None, "ABC234", later), PairingVerdict::Right);
        // Test: a sender without a name is not recognised the next time.
        assert_eq!(desk.attempt(THERE, None, "WRONG2", later), PairingVerdict::Wrong(WAIT));
        assert_eq!(desk.attempt(THERE, None, "ABC234", later), PairingVerdict::Locked(WAIT));
    }
}
