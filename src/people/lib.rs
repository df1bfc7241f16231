//! People in simulation: participants whose beliefs are known, with gaze, errors and traits of their own, and the
//! scripted wizard.
//!
//! Participants decide by a plan of their own. They use neither the assistant's human model nor the cost to go: the cost
//! to go defines their errors and drives the assistant.

#![deny(unsafe_code)]

pub mod participant;
pub mod wizard;
