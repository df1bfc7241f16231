//! The header: the first line of a log, with everything that a replay needs.

use serde::{Deserialize, Serialize};

use super::settings::{ParticipantKind, SessionSpec};
use crate::base::time::SessionTime;

/// The name of the log's format.
pub const FORMAT: &str = "tomcom-session";
/// The version of the format that this program writes. It reads all versions from 1 on.
pub const VERSION: u32 = 2;
/// The version of the format since which recommendations become offers.
const OFFERS_SINCE: u32 = 2;
/// The version of the program since which simulated participants decide as they do now.
pub const PEOPLE_SINCE: &str = "0.2.0";

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
    /// Index of the trial: with the same seed, another index gives other orders and another participant.
    pub trial: u64,
    /// Wall clock time at the beginning of the recording (UTC, RFC 3339), which is session time 0 or that of [`Continues`]. Live
    /// sessions only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub started: Option<String>,
    /// The earlier part that this recording continues.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continues: Option<Continues>,
    /// Name of the recording whose trial is repeated here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub redoes: Option<String>,
    /// All settings in use, including the seed.
    pub session: SessionSpec,
    /// The layout file.
    pub layout: FileText,
    /// The recipe file.
    pub recipes: FileText,
    /// The key file, if the session had one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keys: Option<FileText>,
}

/// The previous part of a recording, after which the session continues.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Continues {
    /// Name of its folder, in the same parent folder.
    pub recording: String,
    /// Number of events in all earlier parts: the sequence number of the first event here.
    pub events: u64,
    /// Session time at which the session continues.
    pub t_ns: SessionTime,
}

/// A file with its whole text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileText {
    /// Path from which it was read, for messages.
    pub path: String,
    /// The whole text.
    pub text: String,
}

impl Header {
    /// Whether a simulated participant of an earlier version, who decided otherwise, took part.
    pub fn has_earlier_people(&self) -> bool {
        let numbers =
            |version: &str| version.split('.').map(|part| part.parse::<u64>().ok()).collect::<Option<Vec<_>>>();
        let is_earlier = numbers(&self.program).is_some_and(|program| Some(program) < numbers(PEOPLE_SINCE));
        self.session.participant.kind == ParticipantKind::Simulated && is_earlier
    }

    /// Whether recommendations became offers in the recording.
    pub fn has_offers(&self) -> bool {
        self.version >= OFFERS_SINCE
    }

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
