//! Inference of the human's belief against exact computation, against humans who are simulated from the model itself, against
//! its own plain reference, and under whatever may come.

mod calibration;
mod exact;
mod freezes;
mod grid;
mod laws;
mod paper;
mod particles;
mod proposals;
mod signals;
mod unknown_gaze;
mod world;

use rand::RngExt;
use tomcom_core::base::rng::Stream;
use tomcom_core::kitchen::{Kitchen, LocationId, State};
use tomcom_core::mind::dirichlet::{Dirichlet, LEAST_MEAN, PRECISIONS};
use tomcom_core::mind::model::PAPER_2021;
use tomcom_core::mind::model::{HumanModel, LookingModel};

/// The model for the tiny kitchen: places are all but certain at first, so that little has to be gone through, and whatever
/// is possible is gone through instead of drawn.
fn tiny_model() -> HumanModel {
    let mut model = HumanModel::default();
    model.prior.location_truth = 0.99999;
    model.prior.location_precision = 100.0;
    model.inference.states = 4096;
    // The grid of exact beliefs has no signals that wait to be read.
    model.signal = PAPER_2021.signal;
    model
}

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
