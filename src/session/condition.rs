//! The condition of a trial: who sends signals.

use serde::{Deserialize, Serialize};

/// Who sends signals in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Unassisted condition: nobody sends signals to the human.
    None,
    /// Wizard condition: the wizard at the console sends signals.
    Wizard,
    /// Assistant condition: the assistant sends signals by itself.
    Assistant,
}

impl Condition {
    /// Name of the condition in logs, settings and tables.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}
