//! tomcom: a console for Wizard-of-Oz experiments in human-robot cooperation.

pub mod base;
pub mod edge;
pub mod kitchen;
