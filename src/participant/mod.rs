//! Simulated participants: people for tests, who err for reasons that one can name.
//!
//! A simulated participant is not the assistant's model of a human: it holds one version of the world for true and acts on
//! it, it thinks in sub-goals and keeps to them, it sees only what it looks at, and its memory of recipes fails in steps.
//!
//! The files from the ground up:
//!
//! - What a person consists of: [`population`] (whom one draws), [`beliefs`], `memory` (of recipes), `eyes`, `attention`.
//! - What follows from beliefs: `decision` (the next presses), `learning` (from the own presses), `witness` (for the record).
//! - The person: `simulated` (state), then what it does: `targets`, `looking`, `thinking`, `hand`, `acting` (in time).

mod acting;
mod attention;
pub mod beliefs;
mod decision;
mod eyes;
mod hand;
mod learning;
mod looking;
mod memory;
pub mod population;
mod simulated;
mod targets;
mod thinking;
mod witness;

pub use simulated::{ParticipantAction, SimulatedParticipant};
