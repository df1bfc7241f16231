//! Inference of the human's belief in whole sessions: fits to recordings, drop-outs of the tracker, and the fast filter
//! against the reference on what was recorded.

mod drop_outs;
mod fitting;
mod fitting_answers;
mod fitting_intervals;
mod observed;
mod recorded;
#[path = "../../core/inference/world.rs"]
mod world;
