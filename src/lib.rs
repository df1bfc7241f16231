//! tomcom: a console for Wizard-of-Oz experiments in human-robot cooperation.

pub mod arm;
pub mod base;
pub mod cli;
pub mod communication;
pub mod console;
pub mod display;
pub mod edge;
pub mod gaze;
pub mod kitchen;
pub mod measures;
pub mod mind;
pub mod participant;
pub mod robot;
pub mod run;
pub mod scene;
pub mod session;
pub mod study;
pub mod wizard;
