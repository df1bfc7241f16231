//! Correction of a participant's code that was typed wrong when the session began.

use serde::{Deserialize, Serialize};

/// A later decision that the recording belongs to another participant than its log says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CodeCorrection {
    /// The participant's code before the correction.
    pub before: String,
    /// The participant's code after the correction.
    pub after: String,
    /// Why the code was corrected.
    pub why: String,
    /// Name of the account on the computer from which the code was corrected; empty if it is not known.
    pub by: String,
    /// Time of the correction (UTC, RFC 3339).
    pub at: String,
}

impl CodeCorrection {
    /// The correction in words: "P02 is P03 (typed wrong; lab, 2026-03-14T10:00:00Z)".
    pub fn in_words(&self) -> String {
        let CodeCorrection { before, after, why, by, at } = self;
        let by = if by.is_empty() { String::new() } else { format!("{by}, ") };
        format!("{before} is {after} ({why}; {by}{at})")
    }
}
