//! The repeat rule: a signal is not sent again before the human may have forgotten its content.

use super::recommendation::aspects_told;
use super::signal::{Signal, signals};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, Kitchen, LocationId, State};
use crate::mind::dirichlet::DirichletBelief;

/// Expected P(truth) above which the human is assumed to know the content of a signal.
const KNOWN: f64 = 0.9;

/// The repeat rule's memory: signals that must not be sent again yet. A signal may be repeated once P(truth) of its
/// aspects has passed 0.9 and fallen again, or the truth has changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repeats {
    /// The last signal about each location.
    told: [Option<Told>; MAX_LOCATIONS],
}

/// Content of a signal that the display showed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    /// Code of the location's content when the signal was shown.
    code: u8,
    was_known: bool,
}

impl Repeats {
    /// Records that the display showed a signal.
    pub fn shown(&mut self, kitchen: &Kitchen, state: State, signal: &Signal) {
        if let Some(location) = signal.location(kitchen) {
            self.told[location.index()] = Some(Told { code: state.code(location), was_known: false });
        }
    }

    /// Forgets the last signal about the location, because it was not shown after all.
    pub fn not_shown(&mut self, location: LocationId) {
        self.told[location.index()] = None;
    }

    /// Applies the repeat rule after a change of the estimate or of the true state.
    pub fn update(&mut self, kitchen: &Kitchen, state: State, belief: &DirichletBelief) {
        for (location, signal) in signals(kitchen, true) {
            let slot = &mut self.told[location.index()];
            let Some(told) = slot else { continue };
            let p_truth = |aspect: AspectId| belief.p_truth(kitchen, state, aspect);
            let known = aspects_told(kitchen, state, &signal).into_iter().map(p_truth).fold(1.0, f64::min) > KNOWN;
            if told.code != state.code(location) || told.was_known && !known {
                *slot = None;
            } else {
                told.was_known |= known;
            }
        }
    }

    /// The available signals that the repeat rule allows now.
    pub fn allowed(&self, kitchen: &Kitchen, own_hand: bool) -> Vec<Signal> {
        let all = signals(kitchen, own_hand).into_iter();
        all.filter(|(location, _)| self.told[location.index()].is_none()).map(|(_, signal)| signal).collect()
    }
}
