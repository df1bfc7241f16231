//! The consent that a participant gave before anything was recorded, for tables.

use serde::{Deserialize, Serialize};

use crate::session::wall_display::AnswerEntry;

/// A consent, as the first event of a recording says it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedConsent {
    /// The participant's code.
    pub participant: String,
    /// Where it was given; none: the recording does not say.
    pub on: Option<AnswerEntry>,
    /// Wall clock time at which the recording that begins with it began (UTC, RFC 3339).
    pub started: Option<String>,
    /// Digest of the text that was agreed to.
    pub digest: Option<String>,
}

impl RecordedConsent {
    /// Where it was given, as tables name it.
    pub fn place(&self) -> Option<&'static str> {
        self.on.map(|on| match on {
            AnswerEntry::Console => "console",
            AnswerEntry::Display => "display",
        })
    }
}
