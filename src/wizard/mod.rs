//! A scripted wizard: sends signals in simulated studies as a person at the console would, who sees kitchen, presses and
//! gaze and knows the recipes, but does not see into the participant's head.
//!
//! It keeps in mind what the participant has seen of each place, and the last presses. When a press was an error, it may see
//! that, and asks itself which single false belief would make the press a good one: a place that is held for what it was when
//! it was last seen, or a recipe; of several the one that explains most of the last presses. When somebody else changed a
//! place, and that goes unseen, it may see that the participant is about to err. It thinks of one thing at a time, takes its
//! time, errs about the cause now and then, and gives up what would mislead nobody any more. So it is late, misses, and is
//! wrong, as people are.
//!
//! The files from the ground up: [`settings`], `thought` (what is taken for believed wrong), `seen` (what the participant has
//! seen, and what would explain a press), `scripted` (the wizard itself).

mod scripted;
mod seen;
pub mod settings;
mod thought;

pub use scripted::ScriptedWizard;
