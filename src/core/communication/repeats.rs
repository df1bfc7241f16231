//! The rule against repeated signals: a signal that was read is not repeated before its content can have been
//! forgotten, and a signal that was probably missed is not repeated before it has left the display.

use super::recommendation::aspects_told;
use super::signal::{HighlightSet, Signal, signals};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, Kitchen, LocationId, State};
use crate::mind::dirichlet::DirichletBelief;

/// Expected P(truth) above which the human is assumed to know what a signal says.
const KNOWN: f64 = 0.9;
/// Probability of having been read below which a signal was probably missed.
const PROBABLY_READ: f64 = 0.5;

/// The signals that must not be repeated yet. A signal may be repeated once P(truth) of its aspects has passed 0.9 and
/// fallen again, or the truth has changed. Where signals can be missed, a signal that has left the display may also be
/// repeated if it was probably not read, or if P(truth) has not passed 0.9 until then. The planner bounds how often
/// somebody who notices nothing is told in vain, since the expected probability of being noticed falls with each missed
/// signal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalRepeatRule {
    /// The last signal about each location.
    told: [Option<Told>; MAX_LOCATIONS],
}

/// Content of a signal that the display showed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    /// Code of the location's content at the time when the signal was shown.
    code: u8,
    was_known: bool,
    /// Probability with which the signal was read before it left the display; `None` while the display shows it.
    read: Option<f64>,
}

impl SignalRepeatRule {
    /// Records that the display shows a signal.
    pub fn shown(&mut self, kitchen: &Kitchen, state: State, signal: &Signal) {
        if let Some(location) = signal.location(kitchen) {
            self.told[location.index()] = Some(Told { code: state.code(location), was_known: false, read: None });
        }
    }

    /// Forgets the last signal about the location, because it was not shown after all.
    pub fn not_shown(&mut self, location: LocationId) {
        self.told[location.index()] = None;
    }

    /// Records that the signal about a location has left the display, and with which probability it was read.
    pub fn over(&mut self, location: LocationId, read: f64) {
        if let Some(told) = &mut self.told[location.index()] {
            told.read = Some(read);
        }
    }

    /// Updates which signals may be repeated, after a change of the estimate or of the true state.
    pub fn update(&mut self, kitchen: &Kitchen, state: State, belief: &DirichletBelief) {
        for (location, signal) in signals(kitchen, HighlightSet::ALL) {
            let slot = &mut self.told[location.index()];
            let Some(told) = slot else { continue };
            let p_truth = |aspect: AspectId| belief.p_truth(kitchen, state, aspect);
            let known = aspects_told(kitchen, state, &signal).into_iter().map(p_truth).fold(1.0, f64::min) > KNOWN;
            let is_forgotten = told.was_known && !known;
            told.was_known |= known;
            let is_missed = told.read.is_some_and(|read| read < PROBABLY_READ || !told.was_known);
            if told.code != state.code(location) || is_forgotten || is_missed {
                *slot = None;
            }
        }
    }

    /// The available signals that the rule against repeats allows now.
    pub fn allowed(&self, kitchen: &Kitchen, highlights: HighlightSet) -> Vec<Signal> {
        let all = signals(kitchen, highlights).into_iter();
        all.filter(|(location, _)| self.told[location.index()].is_none()).map(|(_, signal)| signal).collect()
    }
}
