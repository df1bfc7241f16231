//! Check of pairing codes, which pages of the display and gaze senders send. Each wrong code locks its sender's network
//! address for a while, and each further one locks it longer. A lock holds for all connections of an address together.
//! Wrong codes of many addresses lock nobody else: beyond a few in a second, all codes are answered later, the right one
//! too. The number of open connections then bounds how many codes can be tried. The sender address of a datagram can be
//! forged, so of datagrams only these few are checked at all.

use std::collections::hash_map::RandomState;
use std::collections::{BTreeMap, VecDeque};
use std::hash::BuildHasher;
use std::net::IpAddr;
use std::time::{Duration, Instant};

use super::connection_table::network_of;

/// Time for which a network address is locked after a wrong pairing code.
const WAIT: Duration = Duration::from_secs(1);
/// Number of wrong pairing codes that count as typing errors; each further one doubles the lock time.
const SLIPS: u32 = 4;
/// Longest time for which a network address is locked.
const LONGEST: Duration = Duration::from_secs(300);
/// Time after the end of an address's lock at which the address's wrong codes are forgotten.
const FORGOTTEN: Duration = Duration::from_secs(3600);
/// Largest number of wrong codes of all addresses together, within [`WAIT`], that slow down no other sender.
const MOST_WRONG: u32 = 10;
/// Time after which a code is checked if there were more wrong ones. 256 connections then try 128 codes a second: in an
/// hour, 1 of 2,300 chances to find a code of 30 bits.
const SLOWED: Duration = Duration::from_secs(2);
/// Number of addresses whose wrong codes are remembered; beyond it, the address whose lock ends first is forgotten.
const MAX_ADDRESSES: usize = 1024;
/// Number of paired participant pages that are remembered.
const MAX_PAGES: usize = 64;

/// Result of an attempt to pair with a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PairingVerdict {
    Right,
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

    /// Time to wait before a code from the page with this name is to be checked ([`PairingCodeCheck::attempt`]). A page
    /// that has paired before need not wait with the right code.
    pub fn delay(&self, page: Option<&str>, typed: &str, now: Instant) -> Duration {
        let is_crowded = self.recent(now).is_some_and(|(_, count)| count >= MOST_WRONG);
        if is_crowded && !self.is_known(page, typed) { SLOWED } else { Duration::ZERO }
    }

    /// The present counting interval for wrong codes of all addresses; `None` if it is over.
    fn recent(&self, now: Instant) -> Option<(Instant, u32)> {
        self.recent.filter(|(since, _)| now < *since + WAIT)
    }

    /// Whether the code is right and comes from a page that has paired before.
    fn is_known(&self, page: Option<&str>, typed: &str) -> bool {
        is_code(typed, &self.code) && page.is_some_and(|page| self.known.iter().any(|known| known == page))
    }

    /// Checks a code that came from this address or from the page with this name. A page that has paired before is
    /// admitted with the right code even while its address is locked, so that nobody can lock out the participant's
    /// page.
    pub fn attempt(&mut self, address: IpAddr, page: Option<&str>, typed: &str, now: Instant) -> PairingVerdict {
        let address = network_of(address);
        if self.is_known(page, typed) {
            return PairingVerdict::Right;
        }
        let before = self.wrong.get(&address).filter(|wrong| now < wrong.locked_until + FORGOTTEN).copied();
        if let Some(wrong) = before.filter(|wrong| now < wrong.locked_until) {
            return PairingVerdict::Locked(wrong.locked_until - now);
        }
        if is_code(typed, &self.code) {
            self.wrong.remove(&address);
            self.known.extend(page.map(str::to_string));
            if self.known.len() > MAX_PAGES {
                self.known.pop_front();
            }
            return PairingVerdict::Right;
        }
        self.recent = self.recent(now).map(|(since, count)| (since, count.saturating_add(1))).or(Some((now, 1)));
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

/// Time for which a network address is locked after this number of wrong codes.
fn wait_after(count: u32) -> Duration {
    let doublings = count.saturating_sub(SLIPS).min(16);
    (WAIT * 2_u32.pow(doublings)).min(LONGEST)
}

/// Letters and digits of pairing codes, without those that are easily confused.
const SIGNS: &[u8; 32] = b"ABCDEFGHJKLMNPQRSTUVWXYZ23456789";

/// An unpredictable pairing code of six characters. The code comes from the operating system's random source (through
/// the seeds of the standard library's hash maps), not from the session's seed, which is recorded.
pub(super) fn pairing_code() -> String {
    let bits = RandomState::new().hash_one("pairing code");
    (0..6).map(|place| char::from(SIGNS[(bits >> (5 * place)) as usize % SIGNS.len()])).collect()
}

/// Whether a typed text is the pairing code, ignoring case and spaces; texts are compared in constant time.
pub(super) fn is_code(typed: &str, code: &str) -> bool {
    let typed: Vec<u8> =
        typed.bytes().filter(u8::is_ascii_alphanumeric).map(|byte| byte.to_ascii_uppercase()).collect();
    let differing = typed.iter().zip(code.bytes()).filter(|(a, b)| **a != *b).count();
    typed.len() == code.len() && differing == 0
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
    fn a_new_page_is_let_in_later_while_wrong_codes_come_from_everywhere() {
        let (mut desk, start) = (desk(), Instant::now());
        for step in 0..60_000_u32 {
            let now = start + Duration::from_millis(2) * step;
            desk.attempt(IpAddr::V4(step.into()), None, "WRONG2", now);
            if step % 1000 == 999 {
                let name = format!("page {step}");
                assert_eq!(desk.delay(Some(&name), "ABC234", now), SLOWED, "every answer is slower");
                assert_eq!(desk.attempt(THERE, Some(&name), "ABC234", now + SLOWED), PairingVerdict::Right);
                assert_eq!(desk.delay(Some(&name), "ABC234", now), Duration::ZERO, "it has paired before");
                assert_eq!(desk.delay(Some(&name), "AAAAAA", now), SLOWED, "its name is no code");
            }
        }
        let later = start + Duration::from_secs(122);
        assert_eq!(desk.delay(Some("new"), "ABC234", later), Duration::ZERO, "afterwards all is as before");
    }

    #[test]
    fn datagrams_of_made_up_addresses_buy_no_more_than_ten_guesses_a_second() {
        let (mut desk, start) = (desk(), Instant::now());
        let guess = |desk: &mut PairingCodeCheck, step: u32| {
            let now = start + Duration::from_micros(100) * step;
            desk.delay(None, "WRONG2", now).is_zero()
                && matches!(desk.attempt(IpAddr::V4(step.into()), None, "WRONG2", now), PairingVerdict::Wrong(_))
        };
        let checked = (0..600_000).filter(|step| guess(&mut desk, *step)).count();
        assert!((590..=600).contains(&checked), "{checked} codes in a minute");
        let later = start + Duration::from_secs(62);
        assert_eq!(desk.attempt(THERE, None, "ABC234", later), PairingVerdict::Right);
        // Test: a sender without a name is not recognised the next time.
        assert_eq!(desk.attempt(THERE, None, "WRONG2", later), PairingVerdict::Wrong(WAIT));
        assert_eq!(desk.attempt(THERE, None, "ABC234", later), PairingVerdict::Locked(WAIT));
    }

    #[test]
    fn a_code_is_known_by_its_signs() {
        let code = pairing_code();
        assert_eq!(code.len(), 6);
        assert!(is_code(&format!(" {} ", code.to_lowercase()), &code));
        assert!(!is_code(&code[1..], &code) && !is_code("", &code) && !is_code(&format!("{code}A"), &code));
        assert_ne!(code, pairing_code());
    }
}
