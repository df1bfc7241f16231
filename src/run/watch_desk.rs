//! The comparison of a running session, on a thread of its own.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use crate::analysis::watcher::ComparisonFollower;
use crate::history::comparison::LaneComparison;
use crate::session::{Event, Stamped};

impl ComparisonFollower {
    /// Follows on a thread of its own, which ends with the desk that tells it the events.
    pub fn on_thread(mut self) -> ComparisonDesk {
        let (tell, events) = channel::<Stamped>();
        let (show, views) = channel();
        thread::spawn(move || {
            while let Ok(stamped) = events.recv() {
                let before = self.progress();
                // The session took this event, so it fits; if it does not, there is nothing to compare any more.
                if self.apply(&stamped).is_err() {
                    return;
                }
                let is_over = matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. });
                let is_news = is_over || self.progress() != before;
                if is_news && show.send(self.comparison(is_over)).is_err() {
                    return;
                }
            }
        });
        ComparisonDesk { tell, views }
    }
}

/// Where a running console tells events, and where the comparisons come.
#[derive(Debug)]
pub struct ComparisonDesk {
    tell: Sender<Stamped>,
    views: Receiver<LaneComparison>,
}

impl ComparisonDesk {
    /// Tells an event.
    pub fn tell(&self, stamped: &Stamped) {
        // A thread that is gone compares nothing more, and the session goes on.
        let _ = self.tell.send(stamped.clone());
    }

    /// The last comparison, when all that was told is taken in; no more can be told.
    pub fn last(self) -> Option<LaneComparison> {
        drop(self.tell);
        self.views.into_iter().last()
    }

    /// The newest comparison since this was called last.
    pub fn newest(&self) -> Option<LaneComparison> {
        self.views.try_iter().last()
    }
}
