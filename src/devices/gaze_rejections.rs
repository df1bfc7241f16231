//! Reports senders of gaze that are rejected: each sender once, with what was found in its data.

use std::mem::discriminant;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;

use super::gaze_input::{GazeSenderRejection, TrackerMessage};

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
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
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
    use tokio::sync::mpsc::channel;

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
