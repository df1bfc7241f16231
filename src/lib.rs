//! tomcom: a console for Wizard-of-Oz experiments in human-robot cooperation.

pub mod arm;
pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod communication;
#[cfg(feature = "console")]
pub mod console;
#[cfg(feature = "display")]
pub mod display;
#[cfg(feature = "cli")]
pub mod edge;
pub mod gaze;
pub mod kitchen;
pub mod measures;
pub mod mind;
pub mod participant;
pub mod robot;
pub mod run;
#[cfg(feature = "rerun")]
pub mod scene;
pub mod session;
#[cfg(feature = "cli")]
pub mod study;
pub mod wizard;
