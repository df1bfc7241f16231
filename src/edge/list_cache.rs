//! Figures of closed recordings, kept from one list to the next: to count errors a recording must be read and its presses judged.
//!
//! They stand in the user's folder for caches (`$XDG_CACHE_HOME/tomcom` or `~/.cache/tomcom`), not beside the logs, and the file can be deleted at any
//! time. A recording is found by a digest of the program's version and of the log's length, time of change and last bytes; a changed log
//! has another one. There is neither code nor name in the file. What has free text, the reason of an abort or an exclusion, is not kept.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::file_error::open_regular;
use super::log::LOG_NAME;
use super::replace_file;
use crate::session::settings::Condition;
use crate::session::study_arm::StudyArm;
use crate::session::{Event, TimestampedEvent};

/// Number of bytes at the end of a log that its digest covers.
const TAIL: u64 = 4096;
/// Number of recordings that are kept, about 150 bytes each.
const MOST: usize = 50_000;
/// No header is longer, in bytes.
const MAX_HEADER: u64 = 1 << 24;

/// What is kept of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KeptFigures {
    /// The arm by what was done.
    pub arm: StudyArm,
    /// The trial's length by its own clock, in seconds.
    pub trial_s: f64,
    /// The human's presses that were errors.
    pub errors: u64,
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
struct KeptLine {
    log: String,
    #[serde(flatten)]
    figures: KeptFigures,
}

/// What a closed log tells without being read: its digest, and what a list needs of its header.
#[derive(Clone, Debug, PartialEq)]
pub struct LogGlance {
    /// Digest of the log.
    pub digest: String,
    /// The participant's code.
    pub code: String,
    /// Who sent signals.
    pub condition: Condition,
    /// When the recording began (UTC, RFC 3339).
    pub date: Option<String>,
}

/// The part of a header that a glance takes.
#[derive(Deserialize)]
struct HeaderGlance {
    #[serde(default)]
    started: Option<String>,
    #[serde(default)]
    continues: Option<serde::de::IgnoredAny>,
    session: SettingsGlance,
}

#[derive(Deserialize)]
struct SettingsGlance {
    participant: ParticipantGlance,
    trial: TrialGlance,
}

#[derive(Deserialize)]
struct ParticipantGlance {
    code: String,
}

#[derive(Deserialize)]
struct TrialGlance {
    condition: Condition,
}

impl LogGlance {
    /// A glance at a recording; `None` if it is not closed, has several parts, or cannot be read: it is then read in full, which tells why.
    pub fn read(recording: &Path) -> Option<LogGlance> {
        let log = recording.join(LOG_NAME);
        let mut file = open_regular(&log).ok()?;
        let tail = Tail::read(&mut file).ok()?;
        let last: TimestampedEvent = serde_json::from_slice(tail.last_line()?).ok()?;
        file.seek(SeekFrom::Start(0)).ok()?;
        let mut line = Vec::new();
        BufReader::new(file).take(MAX_HEADER).read_until(b'\n', &mut line).ok()?;
        let header: HeaderGlance = serde_json::from_slice(&line).ok()?;
        if last.event != Event::SessionEnded || header.continues.is_some() {
            return None;
        }
        let SettingsGlance { participant, trial } = header.session;
        Some(LogGlance {
            digest: tail.digest(),
            code: participant.code,
            condition: trial.condition,
            date: header.started,
        })
    }
}

/// The end of a log.
struct Tail {
    length: u64,
    changed_ns: u128,
    bytes: Vec<u8>,
}

impl Tail {
    fn read(file: &mut File) -> io::Result<Tail> {
        let data = file.metadata()?;
        let changed_ns = data.modified()?.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos());
        let (length, mut bytes) = (data.len(), Vec::new());
        file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
        file.take(TAIL).read_to_end(&mut bytes)?;
        Ok(Tail { length, changed_ns, bytes })
    }

    /// The last line, if it is whole.
    fn last_line(&self) -> Option<&[u8]> {
        self.bytes.strip_suffix(b"\n")?.rsplit(|&byte| byte == b'\n').next()
    }

    fn digest(&self) -> String {
        let mut digest = Sha256::new();
        digest.update(format!("{} {} {} ", env!("CARGO_PKG_VERSION"), self.length, self.changed_ns));
        digest.update(&self.bytes);
        digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The kept figures, by the digests of the logs.
#[derive(Debug, Default)]
pub struct ListCache {
    path: Option<PathBuf>,
    kept: BTreeMap<String, KeptFigures>,
}

impl ListCache {
    /// The cache of this user; empty if there is none.
    pub fn open() -> ListCache {
        let set = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let folder = set("XDG_CACHE_HOME").or_else(|| set("HOME").map(|home| home.join(".cache")));
        folder.map_or_else(ListCache::default, |folder| ListCache::in_folder(&folder.join("tomcom")))
    }

    /// The cache in this folder. Lines that cannot be read are none of it.
    pub fn in_folder(folder: &Path) -> ListCache {
        let path = folder.join("lists.jsonl");
        let text = open_regular(&path).and_then(io::read_to_string).unwrap_or_default();
        let lines = text.lines().filter_map(|line| serde_json::from_str::<KeptLine>(line).ok());
        let kept = lines.map(|line| (line.log, line.figures)).collect();
        ListCache { path: Some(path), kept }
    }

    /// The figures of the log with this digest, if they are kept.
    pub fn figures(&self, digest: &str) -> Option<KeptFigures> {
        self.kept.get(digest).copied()
    }

    /// Keeps new figures, too. If there are too many, only the new ones stay. Where the file cannot be written, the next list takes longer, and
    /// nothing else.
    pub fn keep(mut self, new: impl IntoIterator<Item = (String, KeptFigures)>) {
        let new: Vec<_> = new.into_iter().collect();
        let Some(path) = self.path.filter(|_| !new.is_empty()) else { return };
        if self.kept.len() + new.len() > MOST {
            self.kept.clear();
        }
        self.kept.extend(new);
        let line = |(log, figures): (String, KeptFigures)| {
            // Names and finite numbers serialise.
            serde_json::to_string(&KeptLine { log, figures }).unwrap_or_default() + "\n"
        };
        let text: String = self.kept.into_iter().map(line).collect();
        let folder = path.parent().unwrap_or(Path::new("."));
        let _ = fs::create_dir_all(folder).and_then(|()| replace_file::replace(&path, text.as_bytes()));
    }
}
