//! What a session file says about the wizard.

use serde::{Deserialize, Serialize};

/// The wizard: a person at the console, or a script with a person's limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WizardSpec {
    pub kind: WizardKind,
    /// From seeing to pressing the key, in seconds: the median, and the standard deviation of the logarithm.
    pub reaction_s: f64,
    pub reaction_spread: f64,
    /// Chance to see that a press of the participant was an error, and to ask oneself why.
    pub sees_errors: f64,
    /// Chance to see that the participant overlooks a change and is about to err because of it.
    pub sees_overlooked: f64,
    /// For so long a change may go unseen before anybody wonders, in seconds.
    pub overlooked_after_s: f64,
    /// Gaze that rests on a place for so long has read it, as far as the wizard can tell, in seconds.
    pub look_s: f64,
    /// Chance to take something else for the cause that could be it as well.
    pub guesses_wrong: f64,
    /// From one signal to the next at least, in seconds.
    pub rest_s: f64,
}

/// Who the wizard is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WizardKind {
    /// Somebody at the console.
    Person,
    /// The program, for simulated studies.
    Scripted,
}

impl Default for WizardSpec {
    fn default() -> Self {
        WizardSpec {
            kind: WizardKind::Person,
            reaction_s: 1.6,
            reaction_spread: 0.4,
            sees_errors: 0.7,
            sees_overlooked: 0.4,
            overlooked_after_s: 3.0,
            look_s: 0.15,
            guesses_wrong: 0.15,
            rest_s: 5.0,
        }
    }
}

impl WizardSpec {
    /// Whether nothing is said about the wizard.
    pub fn is_default(&self) -> bool {
        *self == WizardSpec::default()
    }
}
