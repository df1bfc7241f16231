//! The signals of a trial as the estimate follows them: the one on the display, and how many were read.

use crate::base::time::SessionTime;
use crate::kitchen::{AspectId, Kitchen, LocationId, LocationKind, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::signal_model::SignalModel;

/// A signal on the display.
#[derive(Clone, Debug)]
pub struct StandingSignal {
    /// The location that it is about.
    pub location: LocationId,
    /// The aspects that it makes certain once it is read.
    pub aspects: Vec<AspectId>,
    /// Session time at which it was shown.
    pub since: SessionTime,
    /// Probability that it is noticed.
    pub noticed: f64,
    /// Probability that it has not been read yet.
    pub unread: f64,
}

impl StandingSignal {
    /// Makes its aspects certain with the probability `share`.
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
pub struct SignalOver {
    /// The location that it was about.
    pub location: LocationId,
    /// Probability that it was read.
    pub read: f64,
}

/// The signals of a trial, as far as they take time to be read.
#[derive(Clone, Debug, Default)]
pub struct SignalsSoFar {
    /// The signal on the display.
    pub standing: Option<StandingSignal>,
    /// The last one that has left the display, until it is taken.
    pub over: Option<SignalOver>,
    /// Expected number of signals that were read, and number of signals that are over.
    read: f64,
    shown: f64,
}

impl SignalsSoFar {
    /// Moves all times on, because the task stood still.
    pub fn postpone(&mut self, by: SessionTime) {
        self.standing.iter_mut().for_each(|standing| standing.since = standing.since + by);
    }

    /// The signal leaves the display.
    pub fn end(&mut self) {
        if let Some(StandingSignal { location, unread, .. }) = self.standing.take() {
            (self.read, self.shown) = (self.read + 1.0 - unread, self.shown + 1.0);
            self.over = Some(SignalOver { location, read: 1.0 - unread });
        }
    }

    /// Expected probability that this person notices a signal about a location of this kind.
    pub fn noticed(&self, model: &SignalModel, kind: LocationKind) -> f64 {
        model.expected_noticed(kind, self.read, self.shown)
    }
}
