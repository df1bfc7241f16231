//! Communication: the signals that wizard and assistant can send to the participant, and the concepts that decide which
//! signal to send when.
//!
//! The files from the ground up:
//!
//! - `signal`, [`recommendation`] (a concept's answer), [`repeats`] (the rule against repeated signals), [`situation`].
//! - `concept_name`, [`settings`], [`concept`] (the interface), [`offer`] (a recommendation as the wizard sees it).
//! - Implementations of the interface: [`planner`] (ToM-Com), [`tom`], [`dev`]; [`concepts`] creates one by its name.

pub mod concept;
mod concept_name;
pub mod concepts;
pub mod dev;
pub mod offer;
pub mod planner;
pub mod recommendation;
pub mod repeats;
pub mod settings;
mod signal;
pub mod situation;
pub mod tom;

pub use signal::{HighlightSet, Sender, Signal, available, signals, unavailable};
