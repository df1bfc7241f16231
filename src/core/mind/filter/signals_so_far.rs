//! The signals of a trial as the estimate follows them: the signal on the display, and the last one before it.

use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, Kitchen, LocationId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::signal_model::SignalModel;

/// A signal on the display.
#[derive(Clone, Debug)]
pub struct SignalOnDisplay {
    /// The location that the signal is about.
    pub location: LocationId,
    /// The state aspects of which the human becomes certain by reading the signal.
    pub aspects: Vec<AspectId>,
    /// Session time at which the signal was shown.
    pub since: SessionTime,
    /// Probability that the participant notices the signal.
    pub noticed: f64,
    /// Probability that the signal has not been read yet.
    pub unread: f64,
}

impl SignalOnDisplay {
    /// Makes the estimate certain of the signal's aspects with the probability `share`.
    pub fn teach(
        &self,
        kitchen: &Kitchen,
        shown: State,
        model: &SignalModel,
        share: f64,
        belief: &mut DirichletBelief,
    ) {
        for &aspect in &self.aspects {
            let of_aspect = &mut belief.aspects[aspect.index()];
            let values = of_aspect.mean().len();
            of_aspect.learn(share, model.understood(kitchen.true_value(shown, aspect), values));
        }
    }
}

/// A signal that has left the display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndedSignal {
    /// The location that the signal was about.
    pub location: LocationId,
    /// Probability that the signal was read before it left the display.
    pub read: f64,
}

/// The signals of a trial, as far as they take time to be read.
#[derive(Clone, Debug, Default)]
pub struct SignalReadingHistory {
    /// The signal that is on the display now.
    pub standing: Option<SignalOnDisplay>,
    /// The last signal that has left the display, until the belief filter's function `take_signal_over` takes it.
    pub over: Option<EndedSignal>,
}

impl SignalReadingHistory {
    /// Moves the signal's times on by a duration for which the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.standing.iter_mut().for_each(|standing| standing.since = standing.since + by);
    }

    /// The signal on the display leaves the display.
    pub fn end(&mut self) {
        if let Some(SignalOnDisplay { location, unread, .. }) = self.standing.take() {
            self.over = Some(EndedSignal { location, read: 1.0 - unread });
        }
    }
}
