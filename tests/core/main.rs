//! The crate `tomcom-core` from outside, a module a theme.

mod cost_to_go;
mod files;
mod gaze;
mod inference;
mod kitchen;
mod measures;
mod oracle;
mod robot;
mod scenarios;
