//! The crate `tomcom-core` from outside, a module a theme.

mod files;
mod gaze;
mod inference;
mod kitchen;
mod measures;
mod recorded_times;
mod rng;
mod robot;
mod scenarios;
