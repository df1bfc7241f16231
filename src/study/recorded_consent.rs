//! The consent that a participant gave before anything else was recorded, for tables.

use serde::{Deserialize, Serialize};

use tomcom_session::wall_display::AnswerDevice;

/// A participant's consent, as the first event of a recording has it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedConsent {
    /// The code of the participant who consented.
    pub participant: String,
    /// Where the consent was given.
    pub on: AnswerDevice,
    /// Wall clock time at which the recording that begins with the consent began (UTC, RFC 3339).
    pub started: Option<String>,
    /// Digest of the text to which the participant consented.
    pub digest: String,
}

impl RecordedConsent {
    /// Where the consent was given, as tables name it.
    pub fn place(&self) -> &'static str {
        match self.on {
            AnswerDevice::Console => "console",
            AnswerDevice::Display => "display",
        }
    }
}
