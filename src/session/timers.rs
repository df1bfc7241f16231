//! What is pending in a running session, by time.

use std::collections::BTreeSet;

use super::apply::Timer;
use crate::base::time::SessionTime;

/// Timers in the order in which they are due; those due at the same time in the order in which they were set.
#[derive(Clone, Debug, Default)]
pub struct TimerQueue {
    pending: BTreeSet<(SessionTime, u64, Timer)>,
    set_so_far: u64,
}

impl TimerQueue {
    pub fn set(&mut self, time: SessionTime, timer: Timer) {
        self.pending.insert((time, self.set_so_far, timer));
        self.set_so_far += 1;
    }

    /// Forgets every timer of this kind.
    pub fn cancel(&mut self, timer: Timer) {
        self.pending.retain(|(_, _, pending)| *pending != timer);
    }

    pub fn cancel_all(&mut self) {
        self.pending.clear();
    }

    /// Everything that is pending comes later by so much.
    pub fn postpone(&mut self, by: SessionTime) {
        let pending = std::mem::take(&mut self.pending);
        self.pending = pending.into_iter().map(|(time, serial, timer)| (time + by, serial, timer)).collect();
    }

    /// When the first timer is due.
    pub fn next_due(&self) -> Option<SessionTime> {
        self.pending.first().map(|(time, _, _)| *time)
    }

    /// Takes the first timer out.
    pub fn take_first(&mut self) -> Option<Timer> {
        self.pending.pop_first().map(|(_, _, timer)| timer)
    }
}
