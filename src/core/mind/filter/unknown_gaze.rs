//! The update of the estimate by time in which the gaze is unknown: the effect of perception is averaged (marginalised)
//! over plausible looking, in closed form.
//!
//! In a time dt location i is looked at with hazard h_i = dt (l0 + (ln - l0) n_i): l0 and ln are the rates of looks at
//! a place that the next press does not need, and at one that it needs (those of the looking model); n_i is the
//! probability that the next press needs the place, computed once after each event, and only where gaze is unknown. The
//! aspect learns the displayed content, with the confusions of any reading, with probability 1 - exp(-h_i). Hazards add
//! up, so it makes no difference how a gap is divided. A press of the human draws the looks since the last event anew,
//! see [`super::unseen_looks`].

use crate::kitchen::{Agent, ButtonId, Kitchen};
use crate::mind::dirichlet::Dirichlet;

/// A time of unknown gaze since the last event or known gaze.
#[derive(Clone, Debug)]
pub struct UnknownGazePeriod {
    /// Beliefs about all aspects at the beginning of the unknown gaze, apart from what has been forgotten since.
    pub before: Vec<Dirichlet>,
    /// By location: expected number of looks if the next press does not need the location, and the additional number if
    /// it certainly does.
    pub hazards: Vec<[f64; 2]>,
    /// Hazard that the signal on the display was read: the expected number of its readings in the unknown gaze.
    pub signal_hazard: f64,
}

/// For each button of the human, the bit set of locations at which the human looks before the press, without the
/// human's own hand.
pub fn watched(kitchen: &Kitchen) -> Vec<u32> {
    let own_hand = kitchen.hands[Agent::Human.index()];
    let bits = |button| {
        let places = kitchen.watched(ButtonId(button as u8)).into_iter().filter(|&place| place != own_hand);
        places.fold(0, |bits, place| bits | 1 << place.index())
    };
    (0..kitchen.buttons[Agent::Human.index()].len()).map(bits).collect()
}
