//! What a simulated participant makes of signals: the one that it will read, and how useful they have been.

use crate::base::time::SessionTime;
use crate::communication::Signal;
use crate::kitchen::LocationId;

/// What the participant makes of signals.
#[derive(Clone, Debug)]
pub(super) struct SignalSense {
    /// A noticed signal, and when it will be read.
    pub pending: Option<(SessionTime, LocationId, Signal)>,
    /// Until when a signal is read.
    pub busy_until: SessionTime,
    /// How useful signals have been, 0 to 1.
    pub worth: f64,
}

impl Default for SignalSense {
    fn default() -> SignalSense {
        SignalSense { pending: None, busy_until: SessionTime::ZERO, worth: 1.0 }
    }
}

impl SignalSense {
    /// Postpones reading by `by`.
    pub fn postpone(&mut self, by: SessionTime) {
        self.pending = self.pending.take().map(|(time, location, signal)| (time + by, location, signal));
        self.busy_until = self.busy_until + by;
    }
}
