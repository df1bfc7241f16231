//! Simulated participants for tests and simulated studies, with errors of known cause.
//!
//! A simulated participant differs from the assistant's human model: it acts on one most probable world, plans sub-goals and
//! pursues them for some seconds, sees only fixated locations, and forgets recipes in steps.
//!
//! Modules from the ground up:
//!
//! - Components: [`population`] (distribution of traits), [`true_beliefs`], `memory` (of recipes), `eyes`, `attention`.
//! - Consequences of beliefs: `decision` (next presses), `learning` (from own presses), `witness` (for the recording).
//! - The participant: `simulated` (its data), then its behaviour: `targets`, `looking`, `thinking`, `hand`, `acting` (in time).

mod acting;
mod attention;
mod decision;
mod eyes;
pub mod gaze_gaps;
mod hand;
mod learning;
mod looking;
mod memory;
pub mod population;
mod simulated;
mod targets;
mod thinking;
pub mod true_beliefs;
mod witness;

pub use simulated::{ParticipantAction, SimulatedParticipant};
