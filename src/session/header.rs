//! The first line of a log: everything that is needed to replay it on its own.

use serde::{Deserialize, Serialize};

use super::settings::SessionSpec;

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
    /// Wall clock at session time 0 (UTC, RFC 3339), of live sessions only: a simulated log has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
    /// The settings, the seed among them, as they were in force.
    pub session: SessionSpec,
    pub layout: FileText,
    pub recipes: FileText,
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
        Header { format: FORMAT.to_string(), version: VERSION, program, trial, started: None, session, layout, recipes }
    }
}
