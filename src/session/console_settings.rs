//! What a session file says about the console.

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;

/// The console.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ConsoleSpec {
    pub visibility: Visibility,
    /// Draw with ASCII signs only, for terminals and fonts without the others.
    pub ascii: bool,
    /// For which background the colours are.
    pub theme: ThemeChoice,
    /// The key file, relative to the session file; without one the keys are those of program and layout.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub keys: Option<String>,
    /// The notes of the markers, so that no text has to be typed while the trial runs: key 1 is the first.
    pub notes: Vec<String>,
    /// Why a trial is aborted or excluded: what the console offers.
    pub reasons: Vec<String>,
}

/// The console has so many keys for notes.
pub const MAX_NOTES: usize = 5;
/// No list of reasons is longer.
const MAX_REASONS: usize = 20;
/// No preset text is longer, in characters.
const MAX_PRESET: usize = 40;

impl Default for ConsoleSpec {
    fn default() -> Self {
        let texts = |texts: [&str; 5]| texts.map(str::to_string).to_vec();
        ConsoleSpec {
            visibility: Visibility::Recommendation,
            ascii: false,
            theme: ThemeChoice::Auto,
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

/// For which background of the terminal the colours are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ThemeChoice {
    /// The one that the terminal says it has; dark, if it does not say.
    Auto,
    Dark,
    Light,
}

/// How much the wizard sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Visibility {
    /// Kitchen and gaze, as the paper's wizard had.
    State,
    /// The estimated belief too.
    Belief,
    /// Everything.
    Recommendation,
}
