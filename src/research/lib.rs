//! What the development of tomcom itself measures, and labs do not need: how accurate and how fast estimate and planner are.
//!
//! Each command of the program `tomcom-research` ([`cli`]) is a module. [`mod@reference`] has filter and planner in their
//! plainest form, straight from the equations; the tests hold the crates of the program against them.

#![deny(unsafe_code)]

pub mod beliefs;
pub mod calibrate;
pub mod cli;
pub mod offers;
pub mod planner_accuracy;
pub mod reference;
pub mod robustness;
pub mod speed;
pub mod sweep;
