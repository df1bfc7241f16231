//! Communication: the signals that wizard and assistant can send to the participant, and the concepts that decide which
//! signal to send when.

pub mod concept;
pub mod offer;
pub mod planner;
pub mod recommendation;
pub mod settings;
pub mod signal;

pub use crate::measures::matching::SignalKind;
pub use signal::{HighlightSet, Sender, Signal, available, signals, unavailable};
