//! The first line of a log: everything that is needed to replay it on its own.

use serde::{Deserialize, Serialize};

use super::settings::SessionSpec;
use crate::base::time::SessionTime;

/// The name of the log's format.
pub const FORMAT: &str = "tomcom-session";
/// The version of the format that this program writes and reads.
pub const VERSION: u32 = 1;

/// The header of a log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// Always [`FORMAT`].
    pub format: String,
    /// The version of the format.
    pub version: u32,
    /// The version of the program that wrote the log.
    pub program: String,
    /// Which trial of its seed it is: trials with the same seed and another index have other orders and participants.
    pub trial: u64,
    /// Wall clock when the recording began (UTC, RFC 3339): at session time 0, or at that of [`Continues`]. Of live
    /// sessions only: a simulated log has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
    /// What this recording is a later part of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continues: Option<Continues>,
    /// The recording, beside this one, whose trial is done again here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redoes: Option<String>,
    /// The settings, the seed among them, as they were in force.
    pub session: SessionSpec,
    pub layout: FileText,
    pub recipes: FileText,
    /// The key file, if the session had one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keys: Option<FileText>,
}

/// The part before: the session goes on from where that was cut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Continues {
    /// The name of its folder, which is beside the later part's.
    pub recording: String,
    /// The events until then, of all parts: the first event here has this number.
    pub events: u64,
    /// The session time at which it goes on.
    pub t_ns: SessionTime,
}

/// A file with its whole text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileText {
    /// Where it was read, for messages.
    pub path: String,
    pub text: String,
}

impl Header {
    /// The header of a session that this program runs.
    pub fn new(session: SessionSpec, trial: u64, layout: FileText, recipes: FileText) -> Header {
        let program = env!("CARGO_PKG_VERSION").to_string();
        let (format, version) = (FORMAT.to_string(), VERSION);
        Header {
            format,
            version,
            program,
            trial,
            started: None,
            continues: None,
            redoes: None,
            session,
            layout,
            recipes,
            keys: None,
        }
    }
}
