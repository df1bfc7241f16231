//! The header of a log: its first line, with everything that a replay needs.

use serde::{Deserialize, Serialize};

use crate::SessionSpec;
use tomcom_core::base::time::SessionTime;

/// The name of the log's format, as every log's header has it.
pub const FORMAT: &str = "tomcom-session";
/// The version of the log's format that this program writes and reads.
pub const VERSION: u32 = 3;

/// The header of a log: its first line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogHeader {
    /// Name of the log's format, always [`FORMAT`].
    pub format: String,
    /// The version of the log's format.
    pub version: u32,
    /// The version of the program that wrote the log.
    pub program: String,
    /// Index of the recorded trial: with the same seed, another index gives other orders and another participant.
    pub trial: u64,
    /// Wall clock time at the beginning of the recording (UTC, RFC 3339), which is session time 0 or the session time
    /// of [`PreviousPart`]. Only live sessions have this time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
    /// The earlier part of the session that this recording continues.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continues: Option<PreviousPart>,
    /// Name of the recording whose trial this recording repeats.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redoes: Option<String>,
    /// All settings of the session in use, including the seed.
    pub session: SessionSpec,
    /// What differs from the named human model, in words: `decision.tau = 8.0, not 4.0`.
    pub human_model_differs: Vec<String>,
    /// The layout file of the kitchen, with its text.
    pub layout: RecordedFile,
    /// The recipe file of the kitchen, with its text.
    pub recipes: RecordedFile,
    /// The file with the wizard's key bindings, if the session had one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keys: Option<RecordedFile>,
    /// The correction of the participant's code that holds, from a file beside the log; `session` has the corrected
    /// code.
    #[serde(skip)]
    pub correction: Option<CodeCorrection>,
}

/// The previous part of a recording, after which this recording continues the session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreviousPart {
    /// Name of the previous part's folder, in the same parent folder.
    pub recording: String,
    /// Number of events in all earlier parts, which is the sequence number of the first event in this part.
    pub events: u64,
    /// Session time at which this part continues the session.
    pub t_ns: SessionTime,
}

/// A text file of a session: its path and its complete text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedFile {
    /// Path from which the file was read, as messages show it.
    pub path: String,
    /// The complete text of the file.
    pub text: String,
}

impl LogHeader {
    /// The participant's code as the log has it, without corrections.
    pub fn recorded_code(&self) -> &str {
        self.correction.as_ref().map_or(&self.session.participant.code, |correction| &correction.before)
    }

    /// The header for the log of a session that this program runs.
    pub fn new(session: SessionSpec, trial: u64, layout: RecordedFile, recipes: RecordedFile) -> LogHeader {
        let program = env!("CARGO_PKG_VERSION").to_string();
        let (format, version) = (FORMAT.to_string(), VERSION);
        LogHeader {
            format,
            version,
            program,
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
