//! The header of a log: its first line, with everything that a replay needs; and the correction of a code that was
//! typed wrong when the session began.

use serde::{Deserialize, Serialize};

use crate::SessionSpec;
use tomcom_core::base::time::SessionTime;

pub const FORMAT: &str = "tomcom-session";
/// The version that this program writes and reads.
pub const VERSION: u32 = 3;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogHeader {
    /// Always [`FORMAT`].
    pub format: String,
    pub version: u32,
    /// Version of the program that wrote the log.
    pub program: String,
    /// With the same seed, another trial has other orders and another participant.
    pub trial: u64,
    /// Wall clock time (UTC, RFC 3339) at session time 0, or at that of [`PreviousPart`]; of live sessions only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
    /// The part of the session that this recording continues.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continues: Option<PreviousPart>,
    /// Name of the recording whose trial this one repeats.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redoes: Option<String>,
    pub session: SessionSpec,
    /// What differs from the named human model, in words: `decision.tau = 8.0, not 4.0`.
    pub human_model_differs: Vec<String>,
    pub layout: RecordedFile,
    pub recipes: RecordedFile,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keys: Option<RecordedFile>,
    /// From a file beside the log; `session` has the corrected code.
    #[serde(skip)]
    pub correction: Option<CodeCorrection>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreviousPart {
    /// Name of its folder, in the same parent folder.
    pub recording: String,
    /// In all earlier parts: the sequence number of this part's first event.
    pub events: u64,
    /// Session time at which this part continues.
    pub t_ns: SessionTime,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedFile {
    /// As messages show it.
    pub path: String,
    pub text: String,
}

impl LogHeader {
    /// The participant's code as the log has it, without corrections.
    pub fn recorded_code(&self) -> &str {
        self.correction.as_ref().map_or(&self.session.participant.code, |correction| &correction.before)
    }

    pub fn new(session: SessionSpec, trial: u64, layout: RecordedFile, recipes: RecordedFile) -> LogHeader {
        LogHeader {
            format: FORMAT.to_string(),
            version: VERSION,
            program: env!("CARGO_PKG_VERSION").to_string(),
            trial,
            started: None,
            continues: None,
            redoes: None,
            human_model_differs: session.human.differences(),
            session,
            layout,
            recipes,
            keys: None,
            correction: None,
        }
    }
}

/// A later decision that the recording belongs to another participant than its log says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CodeCorrection {
    pub before: String,
    pub after: String,
    pub why: String,
    /// Account on the computer from which the code was corrected; empty if it is not known.
    pub by: String,
    /// UTC, RFC 3339.
    pub at: String,
}

impl CodeCorrection {
    /// "P02 is P03 (typed wrong; lab, 2026-03-14T10:00:00Z)".
    pub fn in_words(&self) -> String {
        let CodeCorrection { why, by, at, .. } = self;
        let by = if by.is_empty() { String::new() } else { format!("{by}, ") };
        format!("{} ({why}; {by}{at})", self.codes())
    }

    /// "P02 is P03".
    pub fn codes(&self) -> String {
        format!("{} is {}", self.before, self.after)
    }
}
