//! The condition of a trial: who sends signals.

use serde::{Deserialize, Serialize};

/// Who sends signals in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Nobody sends signals: the human is unassisted.
    None,
    /// The wizard at the console sends signals.
    Wizard,
    /// The assistant sends signals by itself.
    Assistant,
}

impl Condition {
    /// Name of the condition in files.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}
