//! Inference of the human's belief against exact computation, against humans who are simulated from the model itself, against
//! its own plain reference, and under whatever may come.

mod calibration;
mod drop_outs;
mod exact;
mod fitting;
mod fitting_answers;
mod grid;
mod laws;
mod observed;
mod particles;
mod proposals;
mod recorded;
mod unknown_gaze;
mod waiting;
mod world;

use tomcom::mind::model::{HumanModel, LookingModel};

/// A human who looks at nothing while the gaze is unknown.
fn looks_at_nothing() -> HumanModel {
    let looking = LookingModel { looks_hz: 0.0, other_looks_hz: 0.0, capture: 0.0, ..LookingModel::default() };
    HumanModel { looking, ..HumanModel::default() }
}
