//! Command `tomcom review`: opens recordings in the Rerun viewer, from the stream file beside the log or rebuilt from
//! the log.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempPath;

use crate::run::terminal::asked_to_end;
use tomcom_core::base::text::printable;
use tomcom_core::base::time::SessionTime;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::raters::{CodableErrors, ErrorCauseCode, RaterCodes};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_devices::rerun::{FilmFrame, RerunWriter, ShownRecording, StreamIdentity, StreamOutlets, WebViewer};
use tomcom_devices::rrd::{self, RRD_NAME, RerunFileState};
use tomcom_devices::scene::{SceneInputs, SceneUpdate, SessionScene, TimedBars, facts, title};
use tomcom_devices::stream::PORTS;
use tomcom_devices::stream_head;
use tomcom_devices::viewer::{self, ViewerAvailability};
use tomcom_session::error_list::ListedError;
use tomcom_session::files::file_error::{FileError, FileResult, read_bytes};
use tomcom_session::files::overwrite;
use tomcom_session::files::replace_file::Replacement;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::false_beliefs::{FalseBeliefEnd, FalseBeliefsBefore};
use tomcom_session::history::{event_words, signal_words, wording};
use tomcom_session::log::video_file::{self, AttachedFilm};
use tomcom_session::log::{LOG_NAME, LogReader, RecordingLock, RecordingWriteError, consensus_file, rater_codes};
use tomcom_session::replay::{RecordingReplay, ReplayLandmark};
use tomcom_session::wizard_log::signal_verdicts;
use tomcom_session::{Session, TimestampedEvent, apply};

/// First network port that is tried for the web viewer.
const WEB_PORT: u16 = 9090;
/// Largest film that a stream has, in bytes.
const MOST_FILM: u64 = 1 << 30;
/// Time between two frames of a film that was not decoded, and the least one, in seconds.
const USUAL_FRAME_S: f64 = 1.0 / 30.0;
const LEAST_FRAME_S: f64 = 1.0 / 240.0;
/// Period of polling a stream file that another program is writing.
const LOOK: Duration = Duration::from_millis(50);
/// Largest number of characters that recordings' names take in the name of a temporary stream file.
const NAMED: usize = 50;

/// Error of showing recordings in the Rerun viewer.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RerunViewerError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    /// The stream file cannot be written.
    #[error("{}: the Rerun stream cannot be written: {reason}", path.display())]
    #[diagnostic(help("give a file that can be written to with --save=FILE"))]
    Unwritable {
        path: PathBuf,
        /// Why the operating system could not write the file.
        reason: io::Error,
    },
    /// The web viewer cannot be served on this computer.
    #[error("the viewer cannot be served on this machine: {0}")]
    #[diagnostic(help(
        "{PORTS} ports from {WEB_PORT} on were tried, and none is free: end another tomcom review, or see which program \
         uses these ports"
    ))]
    Web(io::Error),
    /// Another program is writing the stream file of this recording.
    #[error("{}: another program writes this recording and its Rerun stream", folder.display())]
    #[diagnostic(help("save the stream up to now with --save=FILE"))]
    InUse { folder: PathBuf },
    #[error("{}: the viewer cannot be started: {reason}", path.display())]
    #[diagnostic(help("--web serves a viewer for a browser"))]
    Viewer {
        path: PathBuf,
        /// Why the operating system could not start the viewer's program.
        reason: io::Error,
    },
}

/// Request of `tomcom review`: which recordings to show in Rerun, and how.
#[derive(Clone, Debug)]
pub struct RerunReviewRequest {
    pub recordings: Vec<PathBuf>,
    /// Whether to write the stream file only, and to which path: beside the log by default.
    pub save: Option<Option<PathBuf>>,
    /// Whether to serve the web viewer even if a native viewer is installed.
    pub web: bool,
    /// Time on the trial's clock that the viewer shows first.
    pub at: Option<SessionTime>,
}

/// A file with the Rerun stream of recordings, and whether the file had to be rebuilt.
#[derive(Debug)]
pub struct RerunStreamFile {
    pub path: PathBuf,
    /// Whether the file was just rebuilt from the log.
    pub made: bool,
    /// Why an existing stream file was not used.
    pub because: Option<&'static str>,
    /// Removes a file in the folder for temporary files when it is dropped.
    temporary: Option<TempPath>,
}

/// A recording that is still being written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OngoingRecording {
    pub recording: PathBuf,
    /// Network address at which viewers of the running session connect; `None` if the session has no stream.
    pub viewers: Option<String>,
}

/// The recordings among these whose sessions are still running; the review shows them up to the present.
///
/// # Errors
/// A recording cannot be read.
pub fn running(recordings: &[PathBuf]) -> FileResult<Vec<OngoingRecording>> {
    let mut running = Vec::new();
    for recording in recordings {
        if let Some(holder) = RecordingLock::holder(LogReader::open(recording)?.folder()) {
            running.push(OngoingRecording { recording: recording.clone(), viewers: holder.viewers });
        }
    }
    Ok(running)
}

/// The time on the trial's clock at the end of the longest of these recordings.
///
/// # Errors
/// A recording cannot be read.
pub fn length(recordings: &[PathBuf]) -> FileResult<SessionTime> {
    let mut longest = SessionTime::ZERO;
    for recording in recordings {
        let mut log = LogReader::open(recording)?;
        let mut session = log.session();
        while let Some(line) = log.next_line()? {
            apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
        }
        longest = longest.max(session.trial_clock(session.time));
    }
    Ok(longest)
}

/// Result of showing recordings in Rerun.
pub enum RerunReviewOutcome {
    /// The stream file was written, as requested, and no viewer was opened.
    Saved(RerunStreamFile),
    Opened(RerunStreamFile),
    /// The web viewer is served to a browser until this value is dropped.
    Served {
        file: RerunStreamFile,
        /// Why the web viewer is served instead of opening a native viewer.
        because: &'static str,
        viewer: WebViewer,
    },
}

/// Opens recordings in the Rerun viewer; several recordings are shown side by side, aligned by their trials' clocks. While a
/// stream is written, `tell` gets the number of events so far, and of all.
///
/// # Errors
/// A recording cannot be read, a file cannot be written, or the viewer cannot be opened.
pub fn review(asked: &RerunReviewRequest, tell: &dyn Fn(u64, u64)) -> Result<RerunReviewOutcome, RerunViewerError> {
    let viewer = if asked.web { ViewerAvailability::None } else { ViewerAvailability::find() };
    match (&asked.save, viewer) {
        (Some(place), _) => {
            let place = place.as_deref().map_or(StreamPlace::BesideLog, StreamPlace::File);
            Ok(RerunReviewOutcome::Saved(saved(&asked.recordings, place, tell)?))
        }
        (None, ViewerAvailability::Ready(viewer)) => {
            let mut file = saved(&asked.recordings, StreamPlace::Anywhere, tell)?;
            if let Some(temporary) = file.temporary.take() {
                file.path = keep(temporary, &asked.recordings)?;
            }
            let opened = viewer::open(&viewer, &file.path, asked.at.map(|at| at.0));
            opened.map_err(|reason| RerunViewerError::Viewer { path: viewer, reason })?;
            Ok(RerunReviewOutcome::Opened(file))
        }
        (None, other) => {
            let because = match other {
                ViewerAvailability::Other(_) => "the Rerun viewer that is installed is of another version",
                ViewerAvailability::NoScreen => "there is no screen for a window of the Rerun viewer",
                _ if asked.web => "as --web asks for",
                _ => "there is no Rerun viewer in PATH",
            };
            let file = saved(&asked.recordings, StreamPlace::Anywhere, tell)?;
            let viewer = serve(&file.path, asked.at).map_err(RerunViewerError::Web)?;
            viewer::browse(&viewer.url);
            Ok(RerunReviewOutcome::Served { file, because, viewer })
        }
    }
}

/// Waits for a termination signal.
///
/// # Errors
/// The operating system does not deliver signals.
pub fn until_asked_to_end() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(asked_to_end())
}

/// The stream file of a recording beside its log: rebuilt from the log unless it is up to date. Waits if another
/// program is writing the file.
///
/// # Errors
/// The recording cannot be read, or its stream file not be written.
pub fn save(recording: &Path) -> Result<PathBuf, RerunViewerError> {
    loop {
        match saved(&[recording.to_path_buf()], StreamPlace::BesideLog, &|_, _| ()) {
            Err(RerunViewerError::InUse { .. }) => std::thread::sleep(LOOK),
            saved => return Ok(saved?.path),
        }
    }
}

/// Where a stream file of recordings may be written.
#[derive(Clone, Copy)]
enum StreamPlace<'a> {
    File(&'a Path),
    /// The stream file may be written only beside the log, for a single recording that no program is writing.
    BesideLog,
    /// The stream file may be written beside the log or, if that is not possible, in the system's folder for temporary
    /// files.
    Anywhere,
}

/// Serves the web viewer with this stream file at the first free network port; it opens at this time.
fn serve(file: &Path, at: Option<SessionTime>) -> io::Result<WebViewer> {
    let mut failed = io::Error::from(io::ErrorKind::AddrInUse);
    for nth in 0..=PORTS {
        match WebViewer::serve(SocketAddr::from((Ipv4Addr::LOCALHOST, WEB_PORT + nth)), file, at) {
            Ok(viewer) => return Ok(viewer),
            Err(reason) => failed = reason,
        }
    }
    Err(failed)
}

/// The stream file of these recordings: the existing file if it is up to date, else a file rebuilt from the logs.
fn saved(
    recordings: &[PathBuf],
    place: StreamPlace,
    tell: &dyn Fn(u64, u64),
) -> Result<RerunStreamFile, RerunViewerError> {
    let (mut locked, mut because, mut logs, mut temporary) = (None, None, None, None);
    let path = match (place, recordings) {
        (StreamPlace::File(place), _) => place.to_path_buf(),
        // Films are large, and stand beside the log already.
        (StreamPlace::Anywhere, [recording]) if !films(recording)?.is_empty() => {
            temporary.insert(elsewhere(recordings)?).to_path_buf()
        }
        (_, [recording]) => {
            let log = LogReader::open(recording)?;
            let (folder, parts) = (log.folder().to_path_buf(), log.logs());
            let path = folder.join(RRD_NAME);
            let state = rrd::state(&path, &parts).unwrap_or(RerunFileState::Unsealed);
            if state == RerunFileState::Whole {
                return Ok(RerunStreamFile { path, made: false, because: None, temporary });
            }
            match (RecordingLock::take(&folder), place) {
                (Ok(lock), _) => {
                    (locked, because, logs) = (Some(lock), state.reason(), Some(parts));
                    path
                }
                (Err(RecordingWriteError::InUse { folder, .. }), StreamPlace::BesideLog) => {
                    return Err(RerunViewerError::InUse { folder });
                }
                (Err(RecordingWriteError::Unwritable { path, reason, .. }), StreamPlace::BesideLog) => {
                    return Err(RerunViewerError::Unwritable { path, reason });
                }
                _ => temporary.insert(elsewhere(recordings)?).to_path_buf(),
            }
        }
        (_, several) => temporary.insert(elsewhere(several)?).to_path_buf(),
    };
    // Beside the log, a stream that is damaged is replaced, too.
    if locked.is_none() {
        check_foreign(&path)?;
    }
    let with_films = locked.is_none();
    let sealed =
        put(recordings, &path, with_films, tell)?.and_then(|()| logs.map_or(Ok(()), |logs| rrd::seal(&path, &logs)));
    drop(locked);
    match sealed {
        Ok(()) => Ok(RerunStreamFile { path, made: true, because, temporary }),
        Err(reason) => Err(RerunViewerError::Unwritable { path, reason }),
    }
}

/// Checks that a stream file can be written to this path, whatever the file's name is.
///
/// # Errors
/// There is a file at the path that this program did not write.
fn check_foreign(path: &Path) -> Result<(), RerunViewerError> {
    let is_own = |_: &[u8]| stream_head::identity(path).is_ok_and(|found| found.is_some());
    overwrite::check(path, "a stream", is_own)
        .map_err(|reason| RerunViewerError::Unwritable { path: path.to_path_buf(), reason })
}

/// Builds the stream file of these recordings. An existing stream file is replaced only when the new one is complete,
/// so a damaged log does not destroy it.
fn put(
    recordings: &[PathBuf],
    path: &Path,
    with_films: bool,
    tell: &dyn Fn(u64, u64),
) -> Result<io::Result<()>, RerunViewerError> {
    let begun = match Replacement::begin(path) {
        Ok(begun) => begun,
        Err(reason) => return Ok(Err(reason)),
    };
    let outlets = StreamOutlets { file: Some(begun.new_path().to_path_buf()), server: None };
    let written = write(playing(recordings, with_films)?, recordings, &outlets, tell)?;
    Ok(written.and_then(|_| begun.finish()))
}

/// Creates an empty file for a stream in the system's folder for temporary files, which only the user of the program can
/// read. It is removed again if it is not kept.
fn elsewhere(recordings: &[PathBuf]) -> Result<TempPath, RerunViewerError> {
    let prefix = temporary_name(recordings);
    let made = tempfile::Builder::new().prefix(&prefix).suffix(".rrd").tempfile();
    let path = std::env::temp_dir().join(prefix);
    Ok(made.map_err(|reason| RerunViewerError::Unwritable { path, reason })?.into_temp_path())
}

/// Keeps a temporary stream file for a viewer that reads it when this program is over. The next one of the same recordings
/// replaces it.
fn keep(temporary: TempPath, recordings: &[PathBuf]) -> Result<PathBuf, RerunViewerError> {
    let mut hasher = DefaultHasher::new();
    for recording in recordings {
        recording.canonicalize().unwrap_or_else(|_| recording.clone()).hash(&mut hasher);
    }
    let path = std::env::temp_dir().join(format!("{}{:016x}.rrd", temporary_name(recordings), hasher.finish()));
    check_foreign(&path)?;
    match temporary.persist(&path) {
        Ok(()) => Ok(path),
        Err(failed) => Err(RerunViewerError::Unwritable { path, reason: failed.error }),
    }
}

/// Beginning of a temporary stream file's name.
fn temporary_name(recordings: &[PathBuf]) -> String {
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    // A file name has at most 255 bytes on most systems.
    format!("tomcom-{}-", names.join("-and-").chars().take(NAMED).collect::<String>())
}

fn name(recording: &Path) -> String {
    let folder = if recording.ends_with(LOG_NAME) { recording.parent().unwrap_or(recording) } else { recording };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Prepares recordings for one stream: a single recording at the root of the scene, several below their names.
fn playing(recordings: &[PathBuf], with_films: bool) -> FileResult<Vec<Playing>> {
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    let one = |(nth, recording): (usize, &PathBuf)| {
        let mut playing = Playing::open(recording)?;
        if with_films {
            playing.films =
                films(recording)?.into_iter().filter(|(path, _)| unplayable(recording, path).is_none()).collect();
        }
        // Paths of lanes are shown: a name as it is, numbered only where another recording has it, too.
        let sign = |sign: char| if sign.is_alphanumeric() || "-._".contains(sign) { sign } else { '_' };
        let root: String = names[nth].chars().map(sign).collect();
        let is_double = names.iter().filter(|other| **other == names[nth]).count() > 1;
        let root = match (recordings.len(), is_double) {
            (1, _) => String::new(),
            (_, true) => format!("{}-{root}", nth + 1),
            (_, false) => root,
        };
        let title = title(playing.replay.session(), &names[nth]);
        let films = playing.films.len();
        let lane = ShownRecording { root, films, ..ShownRecording::of(playing.replay.session(), title) };
        Ok(Playing { lane, ..playing })
    };
    recordings.iter().enumerate().map(one).collect()
}

/// Writes recordings to the outputs of a stream one after another; the outer error is about the recordings, the inner
/// error about the outputs.
fn write(
    playing: Vec<Playing>,
    recordings: &[PathBuf],
    outlets: &StreamOutlets,
    tell: &dyn Fn(u64, u64),
) -> Result<io::Result<RerunWriter>, RerunViewerError> {
    let lanes: Vec<ShownRecording> = playing.iter().map(|one| one.lane.clone()).collect();
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    let began: Vec<String> = playing.iter().map(Playing::began).collect();
    let id = format!("{} {} {}", names.join(" "), began.join(" "), rrd::mark());
    let titles: Vec<&str> = lanes.iter().map(|lane| lane.title.as_str()).collect();
    let told = |(lane, (one, began)): (&ShownRecording, (&Playing, &String))| {
        let recording = if lane.root.is_empty() { "session" } else { lane.root.as_str() };
        let mut facts = facts(one.replay.session());
        facts.push(("began", began.clone()));
        (recording.to_string(), facts)
    };
    let facts = lanes.iter().zip(playing.iter().zip(&began)).map(told).collect();
    let identity = StreamIdentity { id, name: titles.join(" | "), facts };
    let mut writer = match RerunWriter::open(&identity, outlets, &lanes) {
        Ok(writer) => writer,
        Err(error) => return Ok(Err(error)),
    };
    let events = playing.iter().map(Playing::events).collect::<FileResult<Vec<u64>>>()?;
    let (mut done, all) = (0, events.iter().sum::<u64>());
    for (one, events) in playing.into_iter().zip(events) {
        one.write(&mut writer, |event| tell(done + event, all))?;
        done += events;
        tell(done, all);
    }
    writer.finish();
    Ok(Ok(writer))
}

/// The films of a recording, with their paths.
fn films(recording: &Path) -> FileResult<Vec<(PathBuf, AttachedFilm)>> {
    let folder = LogReader::open(recording)?.folder().to_path_buf();
    let films = video_file::read(&folder)?.films;
    Ok(films.into_iter().map(|film| (film.path(&folder), film)).collect())
}

/// Why Rerun cannot show a film, in words.
fn unplayable(recording: &Path, film: &Path) -> Option<String> {
    let path = film.display();
    let copy = format!("a copy in H.264: tomcom video attach {} {path} --convert", recording.display());
    let end = film.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match film.metadata() {
        Err(reason) => Some(format!("{path}: {reason}")),
        Ok(data) if data.len() > MOST_FILM => Some(format!("{path}: too large for Rerun; {copy}")),
        Ok(_) if end != "mp4" && end != "m4v" => Some(format!("{path}: Rerun plays MP4; {copy}")),
        Ok(_) => None,
    }
}

/// Films of these recordings that Rerun does not show, and why, in words.
///
/// # Errors
/// A recording cannot be read.
pub fn unshown_films(recordings: &[PathBuf]) -> FileResult<Vec<String>> {
    let mut unshown = Vec::new();
    for recording in recordings {
        unshown.extend(films(recording)?.iter().filter_map(|(path, _)| unplayable(recording, path)));
    }
    Ok(unshown)
}

/// An error, a signal, a note or a false belief of a recording, as the viewer shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedLandmark {
    pub kind: ReplayLandmark,
    pub words: String,
    /// What the words tell, for programs: an object.
    pub fields: Value,
    /// On the trial's clock.
    pub from: SessionTime,
    /// On the trial's clock: of an error, the human's next press; `None` if it lasts to the end of the recording.
    pub until: Option<SessionTime>,
}

/// The landmarks of these kinds in a recording, by their beginning.
///
/// # Errors
/// The recording cannot be read.
pub fn landmarks(recording: &Path, kinds: &[ReplayLandmark]) -> FileResult<Vec<RecordedLandmark>> {
    let mut replay = RecordingReplay::open(recording)?;
    replay.run()?;
    let (follower, session) = (&replay.follower, replay.session());
    let kitchen = &session.kitchen;
    let mut found: Vec<RecordedLandmark> = Vec::new();
    let clock_s = |time: SessionTime| session.trial_clock_at(time).as_secs_f64();
    let mut add =
        |kind: ReplayLandmark, began: SessionTime, ended: Option<SessionTime>, words: String, fields: Value| {
            let (from, until) = (session.trial_clock_at(began), ended.map(|ended| session.trial_clock_at(ended)));
            found.push(RecordedLandmark { kind, words, fields, from, until });
        };
    if kinds.contains(&ReplayLandmark::Error) {
        let (folder, codable) = (replay.log().folder(), CodableErrors::from_presses(kitchen, &follower.judged));
        let codes = rater_codes::read_all(folder, &codable)?;
        let shared = consensus_file::read(folder, &codable)?.map(|consensus| {
            let none = RaterCodes::default();
            let own = consensus.raters.each_ref().map(|rater| codes.get(rater).unwrap_or(&none));
            (consensus.name(), consensus.current(own))
        });
        let codes: Vec<(String, RaterCodes)> = codes.into_iter().chain(shared).collect();
        let errors = follower.judged.iter().enumerate().filter(|(_, press)| press.verdict.error);
        let explained = ExplainedError::among(session, &follower.judged).into_iter().zip(ListedError::all(follower));
        for ((nth, press), (error, listed)) in errors.zip(explained) {
            let believed = follower.believed_wrong(press.time);
            let coded: Vec<(&String, &ErrorCauseCode)> =
                codes.iter().filter_map(|(rater, codes)| Some((rater, codes.0.get(&press.seq)?))).collect();
            let mut words =
                format!("error {}: {}", listed.error, error.told(believed.and_then(FalseBeliefsBefore::told)));
            words.extend(coded.iter().map(|&(rater, code)| format!("; {rater}: {}", wording::code(code))));
            let mut fields = json!(listed);
            fields["why"] = json!(error.why);
            fields["cause"] = json!(error.cause);
            let targets = press.cause.into_iter().flat_map(ErrorCause::targets);
            let aspects = targets.flat_map(|target| target.aspects(kitchen));
            fields["cause_aspects"] = aspects.map(|aspect| kitchen.aspects[aspect.index()].name.as_str()).collect();
            fields["cost_presses"] = json!(press.verdict.excess);
            fields["believed_wrong"] = json!(believed);
            let code = |code: &ErrorCauseCode| json!({ "cause": code.kind(), "aspect": code.aspect() });
            fields["codes"] = coded.iter().map(|&(rater, found)| (rater.clone(), code(found))).collect();
            add(ReplayLandmark::Error, press.time, follower.judged_until(nth), words, fields);
        }
    }
    if kinds.contains(&ReplayLandmark::Signal) {
        let verdicts = signal_verdicts(follower);
        for (nth, shown) in follower.signals.shown.iter().enumerate() {
            let words = format!("signal {}: {}", nth + 1, signal_words::told(follower, verdicts.as_deref(), nth));
            let fields = json!({
                "number": nth + 1,
                "event": shown.seq,
                "time_s": clock_s(shown.time),
                "by": shown.by,
                "signal": shown.signal,
                "location": shown.signal.target(),
                "looked_at_after_s": shown.seen.map(|seen| session.age(shown.time, seen).as_secs_f64()),
                "verdict": verdicts.as_ref().map(|verdicts| verdicts[nth].name()),
                "reason": shown.reason,
                "value": shown.worth,
            });
            add(ReplayLandmark::Signal, shown.time, shown.ended, words, fields);
        }
    }
    if kinds.contains(&ReplayLandmark::Marker) {
        let notes = session.timeline.iter().filter_map(|entry| Some((entry.time, event_words::note(&entry.what)?)));
        for (number, (time, note)) in (1_u64..).zip(notes) {
            let (words, fields) = (format!("note {number}: {}", printable(&note)), json!({ "number": number }));
            add(ReplayLandmark::Marker, time, Some(time), words, fields);
        }
    }
    if kinds.contains(&ReplayLandmark::FalseBelief) {
        // A replay numbers, and stops at, those that last.
        let mut numbers = 1..;
        for held in follower.false_beliefs.all() {
            let number = held.lasts(session).then(|| numbers.next()).flatten();
            let about = &kitchen.aspects[held.aspect.index()];
            let fields = json!({
                "number": number,
                "aspect": about.name,
                "believes": about.labels[held.thinks],
                "truth": about.labels[held.truth],
                "lasted_s": held.lasted_s(session),
                "end": held.end.map(FalseBeliefEnd::words),
            });
            let number = number.map_or_else(String::new, |number: u64| format!(" {number}"));
            let (kind, name) = (ReplayLandmark::FalseBelief, ReplayLandmark::FalseBelief.name());
            add(kind, held.began, held.ended, format!("{name}{number}: {}", held.whole(session)), fields);
        }
    }
    found.sort_by_key(|one| one.from);
    Ok(found)
}

/// When the frames of a film are seen, in a session that is over.
fn frames(film: &AttachedFilm, session: &Session) -> Vec<FilmFrame> {
    let step_s = film.frame_ms.map_or(USUAL_FRAME_S, |frame_ms| (frame_ms / 1e3).max(LEAST_FRAME_S));
    let last = session.trial_clock(session.time);
    let frame = |number: u64| {
        let film_s = number as f64 * step_s;
        let at = SessionTime::from_secs_f64(film.session_s(film_s));
        let trial = session.trial_clock_at(at).min(last);
        FilmFrame { film: SessionTime::from_secs_f64(film_s), trial, session: at }
    };
    // What the camera saw before the session began is not shown.
    let first = (film.film_s(SessionTime::ZERO).max(0.0) / step_s).ceil() as u64;
    let is_filmed = |frame: &FilmFrame| film.length_s.is_none_or(|length_s| frame.film.as_secs_f64() < length_s);
    (first..).map(frame).take_while(|frame| frame.session <= session.time && is_filmed(frame)).collect()
}

/// A recording that is being written to a stream.
struct Playing {
    replay: RecordingReplay,
    scene: SessionScene,
    lane: ShownRecording,
    /// Films that are shown, with their paths.
    films: Vec<(PathBuf, AttachedFilm)>,
}

impl Playing {
    fn open(recording: &Path) -> FileResult<Playing> {
        let replay = RecordingReplay::open(recording)?;
        let scene = SessionScene::new(replay.session(), 0);
        Ok(Playing { replay, scene, lane: ShownRecording::default(), films: Vec::new() })
    }

    /// Text that tells recordings of the same name apart: the time at which the recording began.
    fn began(&self) -> String {
        let header = &self.replay.log().header;
        header.started.clone().unwrap_or_else(|| format!("seed {} trial {}", header.session.seed, header.trial))
    }

    /// Number of events of the recording.
    fn events(&self) -> FileResult<u64> {
        Ok(self.replay.log().last_event()?.map_or(0, |last| last.seq + 1))
    }

    /// Writes the whole recording to the stream; `tell` gets the number of events so far.
    fn write(mut self, writer: &mut RerunWriter, tell: impl Fn(u64)) -> FileResult<()> {
        writer.fixed(&self.lane, &self.scene.fixed());
        let (opening, lane) = (self.scene.opening(), self.lane.clone());
        writer.moment(&lane, &opening);
        let films = std::mem::take(&mut self.films);
        let mut bars = TimedBars::default();
        let session = self.play(tell, |moment| {
            for moment in bars.take(&moment) {
                writer.moment(&lane, &moment);
            }
        })?;
        for moment in bars.finish() {
            writer.moment(&lane, &moment);
        }
        for (number, (path, film)) in films.iter().enumerate() {
            let content = read_bytes(path, MOST_FILM);
            let content = content.map_err(|reason| FileError::unreadable(path, reason, "the film in video.json"))?;
            writer.film(&lane, number, content, &frames(film, &session));
        }
        Ok(())
    }

    /// Passes on all updates of the scene, in the order of the events that make them.
    fn play(mut self, tell: impl Fn(u64), mut show: impl FnMut(SceneUpdate)) -> FileResult<Session> {
        let mut held: Option<(TimestampedEvent, Option<DirichletBelief>)> = None;
        loop {
            let next = self.replay.step()?;
            if let Some((stamped, belief)) = held.take() {
                // The belief estimate is shown once all events of the same time have been applied.
                let is_last = next.as_ref().is_none_or(|next| next.stamped.time > stamped.time);
                let follower = &self.replay.follower;
                let inputs = SceneInputs { follower, belief: belief.as_ref().filter(|_| is_last) };
                self.scene.see(&stamped, inputs).into_iter().for_each(&mut show);
            }
            let Some(next) = next else { return Ok(self.replay.follower.session) };
            tell(next.stamped.seq);
            let wants = self.scene.wants_belief(&next.stamped);
            let belief = wants.then(|| self.replay.follower.filter.belief().clone());
            held = Some((next.stamped, belief));
        }
    }
}
