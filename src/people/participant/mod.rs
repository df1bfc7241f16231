//! Simulated participants for tests and simulated studies, with errors of known cause.
//!
//! A simulated participant differs from the assistant's human model: a participant acts on one most probable world,
//! plans by backward chaining, sees only fixated locations, and forgets recipes in steps. A participant knows nothing
//! of the cost to go that drives the assistant and defines errors.
//!
//! Modules from the ground up:
//!
//! - Components: `draws`, [`population`] (distribution of traits), [`true_beliefs`], `weighted_draw`, `memory` (of
//!   recipes), `eyes`, `attention`, `signal_sense`.
//! - Planning: `knowledge` (of buttons and processing steps), `goals` (missing parts), `habits` (and lapses),
//!   `planning` (backward chaining), `decision` (next presses).
//! - Consequences of beliefs: `learning` (from own presses), `witness` (for the recording).
//! - Errors of the hand: [`slips`] (which other button is hit).
//! - The participant: `simulated` (its data), then its behaviour: `targets`, `signals`, `looking`, `thinking`, `hand`,
//!   `acting`, `answering`.

mod acting;
mod answering;
mod attention;
mod decision;
mod draws;
mod eyes;
pub mod gaze_gaps;
mod goals;
mod habits;
mod hand;
mod knowledge;
mod learning;
mod looking;
mod memory;
mod planning;
pub mod population;
mod signal_sense;
mod signals;
mod simulated;
pub mod slips;
mod targets;
mod thinking;
pub mod true_beliefs;
mod weighted_draw;
mod witness;

pub use simulated::{ParticipantAction, SimulatedParticipant};
