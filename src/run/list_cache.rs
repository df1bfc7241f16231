//! Numbers about whole recordings, kept from one list of recordings to the next: to count errors, a recording must be
//! read and its presses judged.
//!
//! The numbers are in the user's folder for caches (`$XDG_CACHE_HOME/tomcom` or `~/.cache/tomcom`), not beside the
//! logs, and the cache file can be deleted at any time. A recording is found by a digest of the program's version and
//! of the log's length, time of change and last bytes; a changed log has another digest. The file contains neither
//! codes nor names. Recordings with free text (the reason of an abort or an exclusion) are not kept.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use tomcom_session::files::file_error::{open_regular, read_regular};
use tomcom_session::files::replace_file;
use tomcom_session::log::{LOG_NAME, corrected_code};
use tomcom_session::settings::Condition;
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{Event, TimestampedEvent};
use tomcom_study::analysis::recording_summary::{ListedPlace, RecordingKind, RecordingState};

/// Number of bytes at the end of a log that its digest covers.
const TAIL: u64 = 4096;
/// Largest number of recordings in the cache, about 150 bytes each.
const MOST: usize = 50_000;
/// Largest length of a log's header that is read, in bytes; no header is longer.
const MAX_HEADER: u64 = 1 << 24;

/// Numbers about a whole recording that the cache keeps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CachedRecordingNumbers {
    pub arm: StudyArm,
    /// Duration of the trial by its own clock, in seconds.
    pub trial_s: f64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    pub kind: RecordingKind,
    /// By the log alone: rulings beside it change.
    pub state: RecordingState,
}

/// A line of the cache file: the digest of a log, and the numbers about its recording.
#[derive(Serialize, Deserialize)]
struct KeptLine {
    log: String,
    #[serde(flatten)]
    figures: CachedRecordingNumbers,
}

/// Digest of a closed log, and the values of its header that a list of recordings shows; no events are read.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLogHeader {
    pub digest: String,
    pub code: String,
    /// Condition of the trial: who could send signals.
    pub condition: Condition,
    /// Wall clock time at which the recording began (UTC, RFC 3339).
    pub date: Option<String>,
    /// Place in a study plan.
    pub place: Option<ListedPlace>,
}

/// The part of a log's header that a list of recordings needs.
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
    #[serde(default)]
    step: Option<ListedPlace>,
}

#[derive(Deserialize)]
struct ParticipantGlance {
    code: String,
}

#[derive(Deserialize)]
struct TrialGlance {
    condition: Condition,
}

impl ClosedLogHeader {
    /// Reads what a list needs of a recording without reading its events; `None` if the recording is not closed, has
    /// several parts, or cannot be read: then it is read in full, which shows what is wrong.
    pub fn read(recording: &Path) -> Option<ClosedLogHeader> {
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
        let SettingsGlance { participant, trial, step } = header.session;
        let correction = corrected_code(recording, &participant.code).ok()?;
        Some(ClosedLogHeader {
            digest: tail.digest(),
            code: correction.map_or(participant.code, |correction| correction.after),
            condition: trial.condition,
            date: header.started,
            place: step,
        })
    }
}

/// The last bytes of a log.
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

    /// The last line of the log; `None` if the line is not complete.
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

/// The cache of numbers about recordings, by the digests of the recordings' logs.
#[derive(Debug, Default)]
pub struct ListCache {
    path: Option<PathBuf>,
    kept: BTreeMap<String, CachedRecordingNumbers>,
}

impl ListCache {
    /// The cache of this user; empty if the user has no cache file.
    pub fn open() -> ListCache {
        let set = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let folder = set("XDG_CACHE_HOME").or_else(|| set("HOME").map(|home| home.join(".cache")));
        folder.map_or_else(ListCache::default, |folder| ListCache::in_folder(&folder.join("tomcom")))
    }

    /// The cache in this folder. Lines of the cache file that cannot be read are skipped.
    pub fn in_folder(folder: &Path) -> ListCache {
        let path = folder.join("lists.jsonl");
        let text = read_regular(&path).unwrap_or_default();
        let lines = text.lines().filter_map(|line| serde_json::from_str::<KeptLine>(line).ok());
        let kept = lines.map(|line| (line.log, line.figures)).collect();
        ListCache { path: Some(path), kept }
    }

    /// The cached numbers of the recording whose log has this digest; `None` if the cache does not have them.
    pub fn figures(&self, digest: &str) -> Option<CachedRecordingNumbers> {
        self.kept.get(digest).copied()
    }

    /// Adds new numbers to the cache. If there are too many, only the new ones stay. If the cache file cannot be
    /// written, the only consequence is that the next list takes longer.
    pub fn keep(mut self, new: impl IntoIterator<Item = (String, CachedRecordingNumbers)>) {
        let new: Vec<_> = new.into_iter().collect();
        let Some(path) = self.path.filter(|_| !new.is_empty()) else { return };
        if self.kept.len() + new.len() > MOST {
            self.kept.clear();
        }
        self.kept.extend(new);
        let line = |(log, figures): (String, CachedRecordingNumbers)| {
            // Writing JSON cannot fail here, since the line contains only names and finite numbers.
            serde_json::to_string(&KeptLine { log, figures }).unwrap_or_default() + "\n"
        };
        let text: String = self.kept.into_iter().map(line).collect();
        let folder = path.parent().unwrap_or(Path::new("."));
        let _ = fs::create_dir_all(folder).and_then(|()| replace_file::replace(&path, text.as_bytes()));
    }
}
