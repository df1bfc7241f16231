//! Comparison of wizard and assistants in a running session, on a thread of its own.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use tomcom_session::history::comparison::SenderComparison;
use tomcom_session::watcher::SenderComparisonFollower;
use tomcom_session::{Event, TimestampedEvent};

/// The console's connection to the thread that compares wizard and assistants.
#[derive(Debug)]
pub struct ComparisonThreadHandle {
    tell: Sender<TimestampedEvent>,
    views: Receiver<SenderComparison>,
}

impl ComparisonThreadHandle {
    /// Starts the comparison's thread, which ends when the returned connection is dropped.
    pub fn start(mut follower: SenderComparisonFollower) -> ComparisonThreadHandle {
        let (tell, events) = channel::<TimestampedEvent>();
        let (show, views) = channel();
        thread::spawn(move || {
            while let Ok(stamped) = events.recv() {
                let before = follower.progress();
                // The session itself has accepted this event. If the comparison's copy of the session refuses the
                // event, the comparison ends.
                if follower.apply(&stamped).is_err() {
                    return;
                }
                let is_over = matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. });
                let is_news = is_over || follower.progress() != before;
                if is_news && show.send(follower.comparison(is_over)).is_err() {
                    return;
                }
            }
        });
        ComparisonThreadHandle { tell, views }
    }

    /// Passes an event of the session to the thread that compares wizard and assistants.
    pub fn tell(&self, stamped: &TimestampedEvent) {
        // If the comparison's thread has ended, the session continues without a comparison.
        let _ = self.tell.send(stamped.clone());
    }

    /// The final comparison, after all events that were passed to its thread.
    pub fn last(self) -> Option<SenderComparison> {
        drop(self.tell);
        self.views.into_iter().last()
    }

    /// The latest comparison of wizard and assistants, if there is a new one since the last call.
    pub fn newest(&self) -> Option<SenderComparison> {
        self.views.try_iter().last()
    }
}
