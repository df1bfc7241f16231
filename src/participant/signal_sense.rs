//! What a simulated participant makes of signals: the one that it will read, and how useful they have been.

use std::collections::VecDeque;

use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::kitchen::{ButtonId, LocationId};

/// What the participant makes of signals.
#[derive(Clone, Debug)]
pub(super) struct SignalSense {
    /// A noticed signal with the location that it is about, and when it will be read.
    pub pending: Option<(SessionTime, Option<LocationId>, Signal)>,
    /// Proposed presses that the participant means to make next.
    pub follows: VecDeque<ButtonId>,
    /// Until when a signal is read.
    pub busy_until: SessionTime,
    /// How useful signals have been, 0 to 1.
    pub worth: f64,
}

impl Default for SignalSense {
    fn default() -> SignalSense {
        SignalSense { pending: None, follows: VecDeque::new(), busy_until: SessionTime::ZERO, worth: 1.0 }
    }
}

impl SignalSense {
    /// Postpones reading by `by`.
    pub fn postpone(&mut self, by: SessionTime) {
        self.pending = self.pending.take().map(|(time, location, signal)| (time + by, location, signal));
        self.busy_until = self.busy_until + by;
    }
}
