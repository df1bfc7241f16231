//! Scripted wizard for simulated studies. The script sends signals as a person at the console would, who observes
//! kitchen, presses and gaze and knows the recipes, but not the participant's beliefs.
//!
//! The wizard remembers the last seen content of each location and the last presses. The wizard notices an error with a
//! set probability, and then searches for a single false belief that explains the press: the last seen content of a
//! location, or another recipe. Among several explanations, the wizard prefers those that explain most of the last
//! presses. When the robot changes a location and the participant does not look there, the wizard may foresee an error.
//! The wizard handles one false belief at a time, reacts after a delay, sometimes signals about another aspect, and
//! drops a planned signal once the false belief would mislead nobody. The wizard's signals are therefore sometimes
//! late, missing or wrong, as a person's signals are.
//!
//! Where the session shows recommendations, the scripted wizard also reads the assistant's offers: the wizard takes an
//! offer after a while, or ignores it and follows its own judgement alone.
//!
//! Modules from the ground up: [`settings`], `thought` (suspected false beliefs), `seen` (what the participant has
//! seen, and explanations of a press), `offer_reader`, `scripted` (the wizard itself).

mod offer_reader;
mod scripted;
mod seen;
pub mod settings;
mod thought;

pub use scripted::{ScriptedWizard, WizardAction};
