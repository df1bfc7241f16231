//! Inference of the human's belief under whatever may come. The plain reference, and exact computation: src/research.

mod laws;
mod signals;
mod unknown_gaze;

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::kitchen::{Kitchen, LocationId, State};
use tomcom_core::mind::dirichlet::{Dirichlet, LEAST_MEAN, PRECISIONS};
use tomcom_core::mind::model::{HumanModel, LookingModel};
use tomcom_core::mind::model::PAPER_2021;

/// A human who looks at nothing while the gaze is unknown, and believes signals at once.
fn looks_at_nothing() -> HumanModel {
    let looking = LookingModel { looks_hz: 0.0, other_looks_hz: 0.0, capture: 0.0, ..LookingModel::default() };
    HumanModel { looking, signal: PAPER_2021.signal, ..HumanModel::default() }
}

/// Holds a Dirichlet against what every one must be.
fn check_proper(dirichlet: &Dirichlet, story: &str) {
    let sum: f64 = dirichlet.mean().iter().sum();
    assert!((sum - 1.0).abs() < 1e-9, "{story}: the mean sums to {sum}");
    let least = dirichlet.mean().iter().copied().fold(f64::INFINITY, f64::min);
    assert!(least >= 0.1 * LEAST_MEAN, "{story}: a value has {least}");
    let precision = dirichlet.precision();
    assert!((PRECISIONS[0]..=PRECISIONS[1]).contains(&precision), "{story}: precision {precision}");
}

/// Any contents of all locations.
fn any_state(kitchen: &Kitchen, random: &mut Stream) -> State {
    let mut state = kitchen.empty_state();
    for (index, aspect) in kitchen.aspects[..kitchen.locations.len()].iter().enumerate() {
        state.set_code(LocationId(index as u8), aspect.values[random.random_range(0..aspect.values.len())]);
    }
    state
}

/// Numbers that no tracker should send, among usual ones.
fn any_number(random: &mut Stream) -> f64 {
    match random.random_range(0..8) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => -1e300,
        3 => random.random::<f64>() * 4.0 - 2.0,
        _ => random.random::<f64>(),
    }
}
