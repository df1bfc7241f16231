//! The condition of a trial.

use serde::{Deserialize, Serialize};

/// Who sends signals in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Nobody sends signals (unassisted).
    None,
    /// The person at the console sends signals.
    Wizard,
    /// The assistant sends signals by itself.
    Assistant,
}

impl Condition {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}
