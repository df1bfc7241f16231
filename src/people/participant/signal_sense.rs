//! A simulated participant's state regarding signals: the signal that will be read next, and how useful signals have
//! been.

use std::collections::VecDeque;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::{ButtonId, LocationId};

/// A simulated participant's state regarding signals from wizard or assistant.
#[derive(Clone, Debug)]
pub(super) struct SignalSense {
    /// A noticed signal: the time at which the participant will read the signal, the signal's location, and the signal.
    pub pending: Option<(SessionTime, Option<LocationId>, Signal)>,
    /// Proposed presses that the participant intends to make next.
    pub follows: VecDeque<ButtonId>,
    /// Session time until which the participant is reading a signal.
    pub busy_until: SessionTime,
    /// How useful the signals so far have been to the participant, from 0 to 1.
    pub worth: f64,
}

impl Default for SignalSense {
    fn default() -> SignalSense {
        SignalSense { pending: None, follows: VecDeque::new(), busy_until: SessionTime::ZERO, worth: 1.0 }
    }
}

impl SignalSense {
    /// Postpones the reading of a signal by `by`.
    pub fn postpone(&mut self, by: SessionTime) {
        self.pending = self.pending.take().map(|(time, location, signal)| (time + by, location, signal));
        self.busy_until = self.busy_until + by;
    }
}
