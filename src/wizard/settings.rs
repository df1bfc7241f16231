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

    /// The first setting that cannot be: its name, what it is, and what would be right.
    pub fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let chance = |key, value: f64| (key, value, (0.0..=1.0).contains(&value), "a number from 0 to 1");
        let seconds = |key, value: f64| (key, value, (0.0..=60.0).contains(&value), "seconds from 0 to 60");
        let spread = self.reaction_spread;
        let checks = [
            seconds("reaction_s", self.reaction_s),
            ("reaction_spread", spread, (0.0..=2.0).contains(&spread), "a number from 0 to 2"),
            chance("sees_errors", self.sees_errors),
            chance("sees_overlooked", self.sees_overlooked),
            seconds("overlooked_after_s", self.overlooked_after_s),
            seconds("look_s", self.look_s),
            chance("guesses_wrong", self.guesses_wrong),
            seconds("rest_s", self.rest_s),
        ];
        let wrong = checks.into_iter().find(|(_, _, is_right, _)| !is_right);
        wrong.map(|(key, value, _, remedy)| (key, format!("{key} = {value}"), remedy))
    }
}
