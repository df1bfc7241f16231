//! The queue of pending timers of a running session.

use std::collections::BTreeSet;

use super::session_effect::Timer;
use tomcom_core::base::time::SessionTime;

/// Pending timers in the order in which they are due; timers due at once keep the order in which they were set.
#[derive(Clone, Debug, Default)]
pub struct TimerQueue {
    pending: BTreeSet<(SessionTime, u64, Timer)>,
    set_so_far: u64,
}

impl TimerQueue {
    /// Adds a timer that is due at this session time.
    pub fn set(&mut self, time: SessionTime, timer: Timer) {
        self.pending.insert((time, self.set_so_far, timer));
        self.set_so_far += 1;
    }

    /// Removes all timers of this kind from the queue.
    pub fn cancel(&mut self, timer: Timer) {
        self.pending.retain(|(_, _, pending)| *pending != timer);
    }

    /// Removes all timers from the queue.
    pub fn cancel_all(&mut self) {
        self.pending.clear();
    }

    /// Postpones all timers of the queue by a duration.
    pub fn postpone(&mut self, by: SessionTime) {
        let pending = std::mem::take(&mut self.pending);
        self.pending = pending.into_iter().map(|(time, serial, timer)| (time + by, serial, timer)).collect();
    }

    /// Session time at which the next timer of the queue is due.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.pending.first().map(|(time, _, _)| *time)
    }

    /// Removes the timer that is due next from the queue, and returns it.
    pub fn take_first(&mut self) -> Option<Timer> {
        self.pending.pop_first().map(|(_, _, timer)| timer)
    }
}
