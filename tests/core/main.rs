//! The crate `tomcom-core` from outside, a module a theme.

mod files;
mod gaze;
mod inference;
mod kitchen;
mod measures;
mod robot;
mod scenarios;
