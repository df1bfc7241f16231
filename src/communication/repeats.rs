//! What was said already: nothing is said twice before it could have been forgotten again.

use super::recommendation::aspects_told;
use super::signal::{Signal, signals};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{AspectId, Kitchen, LocationId, State};
use crate::mind::dirichlet::DirichletBelief;

/// What was told is known when the truth has this expected probability.
const KNOWN: f64 = 0.9;

/// The signals that were shown, until they may be shown again: when P(truth) of what they are about has passed 0.9 and
/// fallen again, or the truth has changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repeats {
    /// By location.
    told: [Option<Told>; MAX_LOCATIONS],
}

/// What a signal told.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    /// The state's byte at the location.
    code: u8,
    was_known: bool,
}

impl Repeats {
    /// A signal was shown.
    pub fn shown(&mut self, kitchen: &Kitchen, state: State, signal: &Signal) {
        if let Some(location) = kitchen.location_named(signal.target()) {
            self.told[location.index()] = Some(Told { code: state.code(location), was_known: false });
        }
    }

    /// It was not shown after all.
    pub fn not_shown(&mut self, location: LocationId) {
        self.told[location.index()] = None;
    }

    /// The estimate or the truth may have changed.
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

    /// The signals that may be shown.
    pub fn allowed(&self, kitchen: &Kitchen, own_hand: bool) -> Vec<Signal> {
        let all = signals(kitchen, own_hand).into_iter();
        all.filter(|(location, _)| self.told[location.index()].is_none()).map(|(_, signal)| signal).collect()
    }
}
