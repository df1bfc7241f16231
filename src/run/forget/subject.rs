//! To whom the recording in a folder belongs, and whom a name in a table, report or training record means: the
//! participant whose data are to be deleted, or another one.

use std::fs::File;
use std::io::BufReader;
use std::path::{Component, Path, PathBuf};

use rustc_hash::FxHashMap;
use serde_json::Value;

use tomcom_session::files::file_error::read_regular;
use tomcom_session::header::FORMAT;
use tomcom_session::log::{LOG_NAME, SETTINGS_NAME, corrected_code, first_line, is_written_settings};
use tomcom_session::person_code::without_seed;

/// Why a file is kept that names a recording, if recordings of several people have this name.
pub(super) const AMBIGUOUS: &str = "it names a recording, and recordings of several people in different folders have this name; \
                         tomcom forget --in the folder with one of them, or delete it by hand";

/// A recording of which it is known whose it is.
pub(super) struct KnownRecording {
    folder: PathBuf,
    pub code: String,
    /// The code in the log; another one if the code was corrected.
    pub recorded_as: String,
    /// Time at which the recording began, as the identity of a Rerun stream states it; `None` without a readable header.
    began: Option<String>,
    /// Name of the plan; `None` without a plan or a readable header.
    pub plan: Option<String>,
}

/// Which participant the recording in a folder belongs to.
pub(super) enum RecordingOwner {
    Participant(KnownRecording),
    /// A recording whose participant cannot be determined, with the reason.
    Unknown(&'static str),
    NoRecording,
}

impl RecordingOwner {
    /// Determines the participant of the recording in a folder from the header of its log. If the header is damaged or
    /// the log is gone, the settings beside it tell the participant's code. A settings file alone counts as a recording
    /// only if this program wrote it: a program that is killed before it writes the log, or between the deletion of log
    /// and settings, leaves such a file behind.
    pub(super) fn read(folder: &Path) -> RecordingOwner {
        let log = folder.join(LOG_NAME);
        let settings = read_settings(folder);
        let known = |code, recorded_as, began, plan| {
            RecordingOwner::Participant(KnownRecording { folder: folder.to_path_buf(), code, recorded_as, began, plan })
        };
        if !is_file(&log) {
            return match settings {
                Some((code, true)) => known(code.clone(), code, None, None),
                _ => RecordingOwner::NoRecording,
            };
        }
        let line = File::open(log).and_then(|file| first_line(&mut BufReader::new(file)));
        let header: Option<Value> = line.ok().and_then(|line| serde_json::from_slice(&line).ok());
        if let Some(header) = header.filter(Value::is_object) {
            let session = &header["session"];
            if header["format"] != FORMAT {
                // A log of another program, unless the first line is an event, so that the header before it is lost.
                if header.get("seq").is_none() || header.get("t_ns").is_none() {
                    return RecordingOwner::NoRecording;
                }
            } else if let Some(code) = session["participant"]["code"].as_str() {
                let Ok(correction) = corrected_code(folder, code) else {
                    return RecordingOwner::Unknown(
                        "a recording that does not say whose it is: correction.toml is damaged; it is to be deleted by \
                         hand, if it is the participant's",
                    );
                };
                let recorded_as = code.to_string();
                let code = correction.map_or(recorded_as.clone(), |correction| correction.after);
                let simulated =
                    || Some(format!("seed {} trial {}", session["seed"].as_u64()?, header["trial"].as_u64()?));
                let began = header["started"].as_str().map(str::to_string).or_else(simulated);
                // A tutorial alone is of no plan's trials.
                let step = Some(&session["step"]).filter(|step| step["periods"] != 0);
                let plan = step.and_then(|step| step["plan"].as_str()).map(str::to_string);
                return known(code, recorded_as, began, plan);
            }
        }
        match settings {
            Some((code, _)) => known(code.clone(), code, None, None),
            None => RecordingOwner::Unknown(
                "a recording that does not say whose it is: events.jsonl has no readable header, and session.toml is \
                 missing or damaged; it is to be deleted by hand, if it is the participant's",
            ),
        }
    }
}

/// Whether this path is a regular file: the targets of symbolic links must not be touched, and opening a named pipe
/// would block.
fn is_file(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|data| data.is_file())
}

/// The participant's code in the settings file of a folder, and whether this program wrote that file (then it has all
/// settings and nothing else).
fn read_settings(folder: &Path) -> Option<(String, bool)> {
    let path = folder.join(SETTINGS_NAME);
    let text = is_file(&path).then(|| read_regular(&path).ok()).flatten()?;
    let settings: toml::Table = text.parse().ok()?;
    let code = settings.get("participant")?.get("code")?.as_str()?.to_string();
    Some((code, is_written_settings(&text)))
}

/// Which person a name or a row of a table is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum NamedPerson {
    /// The participant whose data are to be deleted.
    Subject,
    Other,
    /// Either the participant or somebody else: recordings of both have the name.
    Ambiguous,
}

/// The participant whose data are to be deleted, and all recordings that were found, by the names of their folders.
pub(super) struct ForgetSubject {
    code: String,
    recordings: FxHashMap<String, Vec<KnownRecording>>,
}

impl ForgetSubject {
    /// The participant with this code, before any recording has been found.
    pub(super) fn new(code: &str) -> ForgetSubject {
        ForgetSubject { code: code.to_string(), recordings: FxHashMap::default() }
    }

    /// Adds a recording, of the participant or of somebody else.
    pub(super) fn add(&mut self, recording: KnownRecording) {
        self.recordings.entry(file_name(&recording.folder)).or_default().push(recording);
    }

    /// The codes of all participants with a recording, as often as they have one.
    pub(super) fn codes(&self) -> impl Iterator<Item = &str> {
        self.recordings.values().flatten().map(|recording| recording.code.as_str())
    }

    /// Whether a name in a column of participants means the participant: it is the participant's code, with a random seed
    /// before it if several seeds were analysed together.
    pub(super) fn is_participant(&self, name: &str) -> bool {
        name == self.code
            || (without_seed(name) == Some(&self.code)
                && !self.recordings.values().flatten().any(|recording| recording.code == name))
    }

    /// Whether a row about this recording, with this name in its column of participants, means the participant: also
    /// tables that were made before the recording's code was corrected.
    pub(super) fn is_in_row(&self, name: &str, recording: Option<&str>) -> bool {
        let as_recorded = |path: &str| {
            let mut recordings = self.recordings.get(&file_name(Path::new(path))).into_iter().flatten();
            self.recording(path) == NamedPerson::Subject
                && recordings.any(|one| name == one.recorded_as || without_seed(name) == Some(&one.recorded_as))
        };
        self.is_participant(name) || recording.is_some_and(as_recorded)
    }

    /// To which person the recording with this name belongs. The name is that of the recording's folder, with parent
    /// folders before it if several folders share the name.
    pub(super) fn recording(&self, name: &str) -> NamedPerson {
        // What a path is relative to is not known, and folders before it cannot be compared.
        let path = Path::new(name);
        let is_relative = |part: &Component| matches!(part, Component::CurDir | Component::ParentDir);
        let path: PathBuf = path.components().skip_while(is_relative).collect();
        let named = self.recordings.get(&file_name(&path)).into_iter().flatten();
        let mut own = named.filter(|recording| recording.folder.ends_with(&path)).map(|one| one.code == self.code);
        match own.next() {
            None => NamedPerson::Other,
            Some(first) if own.any(|is_own| is_own != first) => NamedPerson::Ambiguous,
            Some(true) => NamedPerson::Subject,
            Some(false) => NamedPerson::Other,
        }
    }

    pub(super) fn is_streamed(&self, identity: &str) -> bool {
        let identity = format!(" {identity} ");
        let has = |words: &str| identity.contains(&format!(" {words} "));
        self.recordings.iter().any(|(name, named)| {
            let mut own = named.iter().filter(|recording| recording.code == self.code);
            has(name) && own.any(|recording| recording.began.as_deref().is_some_and(has))
        })
    }
}

/// The last part of a path, as text.
pub(super) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
