//! Inference of the human's belief against exact computation, against the equations of the paper, against humans who are
//! simulated from the model itself, and against the plain reference.

mod calibration;
mod exact;
mod fitting;
mod fitting_answers;
mod freezes;
mod grid;
mod observed;
mod paper;
mod particles;
mod proposals;
mod recorded;
mod signals;
mod world;

use tomcom_core::mind::model::{HumanModel, LookingModel};
use tomcom_core::mind::model::PAPER_2021;

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
