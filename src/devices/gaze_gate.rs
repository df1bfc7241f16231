//! Which senders of gaze may send, and reports of those that are rejected. Every program of this computer may send gaze; of
//! other computers, those that the session lists or, if the session lists none, those that know the pairing code.

use std::collections::VecDeque;
use std::mem::discriminant;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;

use super::gaze_input::{GazeSenderRejection, TrackerMessage};
use super::gaze_line::code_in;
use super::pairing::{PairingCodeCheck, PairingVerdict};
use crate::lock;

/// Number of paired senders of datagrams that are remembered.
const MAX_PAIRED: usize = 64;

/// Condition under which gaze from an address is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GazeAdmission {
    /// Gaze from the address is read without a condition.
    Open,
    /// Gaze from the address is read once it has sent the pairing code.
    ByCode,
    /// Gaze from the address is never read.
    Never,
}

/// Access check for senders of gaze, which reports those that it rejects. Connections and datagrams have separate
/// access checks, so that wrong codes in datagrams, whose sender addresses can be forged, lock no connection out.
#[derive(Debug)]
pub(super) struct GazeAccessCheck {
    listed: Vec<IpAddr>,
    /// Check of pairing codes; `None` if no code is accepted.
    code_check: Option<PairingCodeCheck>,
    /// Senders of datagrams that have sent the right code, oldest first.
    paired: VecDeque<SocketAddr>,
    rejections: RejectionReporter,
}

impl GazeAccessCheck {
    pub fn new(listed: &[IpAddr], code: Option<&String>, rejections: RejectionReporter) -> GazeAccessCheck {
        let code_check = code.map(|code| PairingCodeCheck::new(code.clone()));
        let listed = listed.iter().map(IpAddr::to_canonical).collect();
        GazeAccessCheck { listed, code_check, paired: VecDeque::new(), rejections }
    }

    /// Condition under which gaze from this network address is read.
    pub fn admission(&self, from: IpAddr) -> GazeAdmission {
        // A socket for both IP versions reports IPv4 addresses as IPv6 addresses, which are converted back.
        let from = from.to_canonical();
        match from.is_loopback() || self.listed.contains(&from) {
            true => GazeAdmission::Open,
            false if self.code_check.is_some() => GazeAdmission::ByCode,
            false => GazeAdmission::Never,
        }
    }

    /// Time to wait before the pairing code of a sender is to be checked ([`GazeAccessCheck::pair`]).
    pub fn delay(&self, code: &str, now: Instant) -> Duration {
        self.code_check.as_ref().map_or(Duration::ZERO, |code_check| code_check.delay(None, code, now))
    }

    /// Checks the pairing code of a sender that needs a code, and reports the sender if it is rejected.
    ///
    /// # Errors
    /// Why the sender is rejected, and for how long codes from the sender's address are not checked.
    pub fn pair(
        &mut self,
        from: SocketAddr,
        code: Option<&str>,
        now: Instant,
    ) -> Result<(), (GazeSenderRejection, Duration)> {
        let verdict = match (&mut self.code_check, code) {
            (Some(code_check), Some(code)) => Some(code_check.attempt(from.ip(), None, code, now)),
            _ => None,
        };
        let (why, wait) = match verdict {
            Some(PairingVerdict::Right) => return Ok(()),
            Some(PairingVerdict::Wrong(wait)) => (GazeSenderRejection::WrongCode, wait),
            Some(PairingVerdict::Locked(wait)) => (GazeSenderRejection::Locked, wait),
            None => (GazeSenderRejection::Unpaired, Duration::ZERO),
        };
        self.rejections.report(from, why.clone(), now);
        Err((why, wait))
    }

    /// The lines of a datagram that are to be read; `None` if its sender is rejected. A datagram with the right code as
    /// its first line pairs its address and port; later datagrams from there need no code.
    pub fn lines<'a>(&mut self, from: SocketAddr, datagram: &'a [u8], now: Instant) -> Option<&'a [u8]> {
        let first = datagram.iter().position(|&byte| byte == b'\n').unwrap_or(datagram.len());
        let code = code_in(&datagram[..first]);
        let lines = if code.is_some() { &datagram[first..] } else { datagram };
        match self.admission(from.ip()) {
            GazeAdmission::Open => Some(lines),
            GazeAdmission::ByCode if self.paired.contains(&from) => Some(lines),
            GazeAdmission::ByCode if code.as_ref().is_some_and(|code| !self.delay(code, now).is_zero()) => {
                self.rejections.report(from, GazeSenderRejection::Locked, now);
                None
            }
            GazeAdmission::ByCode => {
                self.pair(from, code.as_deref(), now).ok()?;
                self.paired.push_back(from);
                if self.paired.len() > MAX_PAIRED {
                    self.paired.pop_front();
                }
                Some(lines)
            }
            GazeAdmission::Never => {
                self.rejections.report(from, GazeSenderRejection::Unlisted, now);
                None
            }
        }
    }
}

/// Least time between two notices about rejected senders, of which there can be thousands, and between two notices about
/// one sender.
const NOTICE: Duration = Duration::from_millis(100);
const AGAIN: Duration = Duration::from_secs(1);
/// Number of rejected senders that are remembered, so that each counts once.
const MAX_SENDERS: usize = 256;

/// Reports rejected senders to the session; all connections and datagrams share one.
#[derive(Clone, Debug)]
pub(super) struct RejectionReporter {
    news: Sender<TrackerMessage>,
    known: Arc<Mutex<RejectedSenders>>,
}

#[derive(Debug, Default)]
struct RejectedSenders {
    /// Rejected senders, each with the last reason and the time of the last notice about it.
    senders: Vec<(SocketAddr, GazeSenderRejection, Instant)>,
    /// Time of the last notice, and number of senders that no notice has counted yet.
    told: Option<Instant>,
    uncounted: u64,
}

impl RejectionReporter {
    /// A reporter that has rejected nobody yet.
    pub fn new(news: Sender<TrackerMessage>) -> RejectionReporter {
        RejectionReporter { news, known: Arc::default() }
    }

    /// Reports that a sender was rejected. A program that connects again does so from another port, so connections count
    /// by their address, with port 0; datagrams count by address and port.
    pub fn report(&self, from: SocketAddr, why: GazeSenderRejection, now: Instant) {
        let from = SocketAddr::new(from.ip().to_canonical(), from.port());
        let mut known = lock(&self.known);
        match known.senders.iter_mut().find(|(sender, ..)| *sender == from) {
            Some((_, before, told)) => {
                let is_same = discriminant(before) == discriminant(&why);
                if is_same && now.saturating_duration_since(*told) < AGAIN {
                    return;
                }
                (*before, *told) = (why.clone(), now);
            }
            None => {
                if known.senders.len() == MAX_SENDERS {
                    known.senders.remove(0);
                }
                known.senders.push((from, why.clone(), now));
                known.uncounted += 1;
            }
        }
        if known.told.is_some_and(|told| now.saturating_duration_since(told) < NOTICE) {
            return;
        }
        let rejected = TrackerMessage::Rejected { from: from.ip(), why, senders: known.uncounted };
        // A message queue that is closed or full has worse consequences than a missing notice.
        if self.news.try_send(rejected).is_ok() {
            (known.told, known.uncounted) = (Some(now), 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::sync::mpsc::{Receiver, channel};

    const SAMPLE: &[u8] = b"{\"x\": 0.5, \"y\": 0.5, \"confidence\": 1}\n";

    fn gate(listed: &[&str], code: Option<&str>) -> (GazeAccessCheck, Receiver<TrackerMessage>) {
        let (news, told) = channel(16);
        let listed: Vec<IpAddr> = listed.iter().map(|address| address.parse().expect("an address")).collect();
        (GazeAccessCheck::new(&listed, code.map(str::to_string).as_ref(), RejectionReporter::new(news)), told)
    }

    fn sender(port: u16) -> SocketAddr {
        SocketAddr::from(([192, 168, 1, 20], port))
    }

    #[test]
    fn a_datagram_with_the_code_pairs_its_sender_and_no_other() {
        let (mut gate, mut told) = gate(&[], Some("ABC234"));
        let mut now = Instant::now();
        let paired = [b"{\"pair\": \"abc 234\"}\n", SAMPLE].concat();
        assert_eq!(gate.lines(sender(1), SAMPLE, now), None);
        assert_eq!(gate.lines(sender(1), &paired, now).map(<[u8]>::trim_ascii), Some(SAMPLE.trim_ascii()));
        assert_eq!(gate.lines(sender(1), SAMPLE, now), Some(SAMPLE), "paired");
        assert_eq!(gate.lines(sender(2), SAMPLE, now), None, "another program there is not");
        // Test: a code from a paired sender is not checked, so it may be repeated, and nobody can guess codes in its
        // name.
        assert_eq!(gate.lines(sender(1), b"{\"pair\": \"WRONG2\"}", now), Some(&b""[..]));
        now += NOTICE;
        assert_eq!(gate.lines(sender(2), b"{\"pair\": \"WRONG2\"}", now), None);
        now += NOTICE;
        assert_eq!(gate.lines(sender(2), &paired, now), None, "locked");
        assert_eq!(gate.lines(sender(1), SAMPLE, now), Some(SAMPLE), "who is paired stays");
        let rejected = |why, senders| Ok(TrackerMessage::Rejected { from: sender(0).ip(), why, senders });
        assert_eq!(told.try_recv(), rejected(GazeSenderRejection::Unpaired, 1));
        assert_eq!(told.try_recv(), rejected(GazeSenderRejection::WrongCode, 1));
        assert_eq!(told.try_recv(), rejected(GazeSenderRejection::Locked, 0));
        assert!(told.try_recv().is_err());
        now += Duration::from_secs(1);
        assert!(gate.lines(sender(2), &paired, now).is_some());
        for port in 10..200 {
            assert!(gate.lines(sender(port), &paired, now).is_some());
        }
        assert!(gate.paired.len() == MAX_PAIRED && gate.lines(sender(1), SAMPLE, now).is_none());
    }

    #[test]
    fn a_list_lets_in_whom_it_lists_and_asks_for_no_code() {
        let (mut gate, mut told) = gate(&["192.168.1.20"], None);
        let now = Instant::now();
        let mapped: IpAddr = "::ffff:192.168.1.20".parse().expect("an address");
        let [here, other]: [IpAddr; 2] =
            ["127.0.0.1", "192.168.1.21"].map(|address| address.parse().expect("an address"));
        assert_eq!(
            [here, mapped, other].map(|from| gate.admission(from)),
            [GazeAdmission::Open, GazeAdmission::Open, GazeAdmission::Never]
        );
        assert_eq!(gate.lines(SocketAddr::new(other, 1), SAMPLE, now), None);
        let rejected = TrackerMessage::Rejected { from: other, why: GazeSenderRejection::Unlisted, senders: 1 };
        assert_eq!(told.try_recv(), Ok(rejected));
        // Test: a sender of gaze that needs no code may still send one.
        assert_eq!(gate.lines(sender(1), b"{\"pair\": \"anything\"}\n{}", now), Some(&b"\n{}"[..]));
    }

    #[test]
    fn senders_are_counted_and_not_what_they_send() {
        let (news, mut told) = channel(64);
        let reporter = RejectionReporter::new(news);
        let (one, other) = (SocketAddr::from(([127, 0, 0, 1], 7)), SocketAddr::from(([127, 0, 0, 1], 8)));
        let start = Instant::now();
        let at = |ms: u64| start + Duration::from_millis(ms);
        let mut heard = |from: SocketAddr, why: &GazeSenderRejection, ms: u64| {
            reporter.report(from, why.clone(), at(ms));
            told.try_recv().ok().map(|news| match news {
                TrackerMessage::Rejected { why, senders, .. } => (why, senders),
                other => panic!("{other:?}"),
            })
        };
        let (utf16, mark) = (GazeSenderRejection::Utf16, GazeSenderRejection::ByteOrderMark);
        assert_eq!(heard(one, &utf16, 0), Some((utf16.clone(), 1)));
        for datagram in 1..61 {
            assert_eq!(heard(one, &utf16, 16 * datagram), None, "datagram {datagram} of one program");
        }
        // What goes on is told again, and counts nobody a second time; nor does another reason.
        assert_eq!(heard(one, &utf16, 1000), Some((utf16.clone(), 0)));
        assert_eq!(heard(one, &mark, 1100), Some((mark.clone(), 0)));
        // Of many senders at once the notice comes later, and counts all of them.
        assert_eq!(heard(other, &mark, 1150), None);
        assert_eq!(heard(SocketAddr::from(([127, 0, 0, 1], 9)), &mark, 1200), Some((mark, 2)));
    }
}
