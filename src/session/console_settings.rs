//! Settings of the wizard's console in a session file.

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;

/// Settings of the wizard's console.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConsoleSpec {
    /// How much the wizard sees: kitchen, estimated belief, recommendations.
    pub visibility: WizardVisibility,
    /// Draw with ASCII characters only, for terminals and fonts without others.
    pub ascii: bool,
    /// Colour theme of the console: for a dark or a light terminal background.
    pub theme: ColourTheme,
    /// Whether a mouse click on a signal or on the offer sends the signal at once, without a question.
    pub click_sends: bool,
    /// Path of the file with the wizard's key bindings, relative to the session file; without a path the default keys
    /// apply.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<String>,
    /// Preset texts for the wizard's markers (time marks with a note): key 1 sets a marker with the first text.
    pub notes: Vec<String>,
    /// Preset reasons for aborting or excluding a trial.
    pub reasons: Vec<String>,
}

/// Largest number of preset notes for the wizard's markers (keys 1 to 5).
pub const MAX_NOTES: usize = 5;
/// Largest number of preset reasons for aborting or excluding a trial.
const MAX_REASONS: usize = 20;
/// Largest length of a preset note or reason, in characters.
const MAX_PRESET: usize = 40;

impl Default for ConsoleSpec {
    fn default() -> Self {
        let texts = |texts: [&str; 5]| texts.map(str::to_string).to_vec();
        ConsoleSpec {
            visibility: WizardVisibility::Recommendation,
            ascii: false,
            theme: ColourTheme::Auto,
            click_sends: false,
            keys: None,
            notes: texts(["wrong recipe", "overlooked a change", "slip", "waits for the robot", "look at this later"]),
            reasons: texts([
                "participant stopped",
                "technical failure",
                "wizard's mistake",
                "instructions not understood",
                "interrupted",
            ]),
        }
    }
}

impl ConsoleSpec {
    pub(super) fn check(&self) -> Result<(), SettingError> {
        let wrong = |key: &str, texts: &[String], most: usize, remedy| {
            let is_text = |text: &String| {
                let length = text.chars().count();
                (1..=MAX_PRESET).contains(&length) && text.trim() == text && !text.chars().any(char::is_control)
            };
            let is_wrong = texts.is_empty() || texts.len() > most || !texts.iter().all(is_text);
            is_wrong.then(|| SettingError::new(format!("console.{key}"), format!("{key} = {texts:?}"), remedy))
        };
        let notes = "1 to 5 texts of 1 to 40 characters, each on one line";
        let reasons = "1 to 20 texts of 1 to 40 characters, each on one line";
        let found = wrong("notes", &self.notes, MAX_NOTES, notes);
        found.or_else(|| wrong("reasons", &self.reasons, MAX_REASONS, reasons)).map_or(Ok(()), Err)
    }
}

/// Colour theme of the console.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColourTheme {
    /// Colours that fit the terminal's background; colours for a dark one if the terminal does not report its
    /// background.
    Auto,
    /// Colours for a dark terminal background.
    Dark,
    /// Colours for a light terminal background.
    Light,
}

/// Amount of information on the wizard's console.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WizardVisibility {
    /// The wizard sees kitchen and gaze only, as in the paper.
    State,
    /// The wizard sees kitchen, gaze and estimated belief.
    Belief,
    /// The wizard sees kitchen, gaze, estimated belief and recommendations.
    Recommendation,
}

impl WizardVisibility {
    /// Name of the wizard's visibility level in files.
    pub fn name(self) -> &'static str {
        match self {
            WizardVisibility::State => "state",
            WizardVisibility::Belief => "belief",
            WizardVisibility::Recommendation => "recommendation",
        }
    }

    /// Words for what the wizard sees at this visibility level.
    pub fn title(self) -> &'static str {
        match self {
            WizardVisibility::State => "kitchen and gaze",
            WizardVisibility::Belief => "kitchen, gaze and the estimated belief",
            WizardVisibility::Recommendation => {
                "kitchen, gaze, the estimated belief and the assistant's recommendation"
            }
        }
    }
}
