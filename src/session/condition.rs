//! The condition of a trial.

use serde::{Deserialize, Serialize};

/// Who sends signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// Nobody: the unassisted condition.
    None,
    /// The person at the console.
    Wizard,
    /// The assistant by itself.
    Assistant,
}

impl Condition {
    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            Condition::None => "none",
            Condition::Wizard => "wizard",
            Condition::Assistant => "assistant",
        }
    }
}
