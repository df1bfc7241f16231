//! When data arrived at this computer. The program notices data when it reads them; if it stood still before, the data
//! may have waited as long, and count as arrived when they can have arrived first.

use std::time::{Duration, Instant};

use tokio::time::timeout_at;

/// Period in which an idle source of data is found to be empty.
const LOOK: Duration = Duration::from_millis(100);
/// Data that may have waited for longer than this have no known time of arrival: the program stood still.
const WAITED: Duration = Duration::from_millis(250);

/// The interval in which data arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Arrival {
    /// Instant at which the source was last found to be empty.
    pub after: Instant,
    pub by: Instant,
}

impl Arrival {
    /// Whether the data were read as soon as they had arrived.
    pub fn is_known(self) -> bool {
        self.by.saturating_duration_since(self.after) <= WAITED
    }

    /// Instant at which the data count as arrived: when they were read, or if they may have waited, when they can have
    /// arrived first.
    pub fn counted(self) -> Instant {
        if self.is_known() { self.by } else { self.after }
    }
}

/// Waits for data of one source, and keeps until when none had arrived.
#[derive(Clone, Copy, Debug)]
pub(super) struct ArrivalWatch {
    empty: Instant,
}

impl ArrivalWatch {
    /// The watch of a source that was empty at this instant.
    pub fn new(empty: Instant) -> ArrivalWatch {
        ArrivalWatch { empty }
    }

    /// Notes that the source was empty at this instant, as the operating system said.
    pub fn was_empty(&mut self, at: Instant) {
        self.empty = at;
    }

    /// Waits until `ready` completes. A period without data shows that the source was empty at its end: the runtime looks
    /// for data before it looks for timers that are due, also after the program stood still.
    pub async fn wait<F: Future>(&mut self, mut ready: impl FnMut() -> F) -> F::Output {
        loop {
            let until = Instant::now() + LOOK;
            match timeout_at(until.into(), ready()).await {
                Ok(found) => return found,
                Err(_) => self.empty = until,
            }
        }
    }

    pub fn arrival(self, read: Instant) -> Arrival {
        Arrival { after: self.empty, by: read }
    }
}

#[cfg(test)]
mod tests {
    use std::future::poll_fn;
    use std::task::Poll;

    use super::*;

    #[test]
    fn data_that_may_have_waited_count_as_arrived_when_the_source_was_last_empty() {
        let empty = Instant::now();
        let mut watch = ArrivalWatch::new(empty);
        for (read_ms, is_known) in [(0, true), (250, true), (251, false), (4000, false)] {
            let read = empty + Duration::from_millis(read_ms);
            let arrival = watch.arrival(read);
            assert_eq!(arrival.is_known(), is_known, "{read_ms} ms");
            assert_eq!(arrival.counted(), if is_known { read } else { empty }, "{read_ms} ms");
        }
        let later = empty + Duration::from_secs(4);
        watch.was_empty(later);
        assert!(watch.arrival(later).is_known());
    }

    #[tokio::test]
    async fn an_idle_source_is_found_empty_again_and_again() {
        let begun = Instant::now();
        let (mut watch, mut asked) = (ArrivalWatch::new(begun), 0);
        // Data come when they are waited for the third time.
        let ready = || {
            asked += 1;
            let is_there = asked == 3;
            poll_fn(move |_| if is_there { Poll::Ready(()) } else { Poll::Pending })
        };
        watch.wait(ready).await;
        let empty = watch.arrival(begun).after;
        assert!(empty >= begun + 2 * LOOK, "{:?}", empty - begun);
    }
}
