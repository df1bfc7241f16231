//! The crate `tomcom-people` from outside: a simulated participant, its slips, traits and drop-outs of gaze.

mod behaviour;
#[path = "../core/files.rs"]
mod files;
mod slips;
mod traits;
