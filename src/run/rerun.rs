//! `tomcom review`: recordings in Rerun's viewer, from the stream beside their log, or made from the log.

use std::fs;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use super::replay::Replay;
use crate::base::time::SessionTime;
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::{LOG_NAME, LogReader, RecordingLock};
use crate::edge::rerun::{RerunWriter, StreamIdentity, StreamLane, StreamOutlets, WebViewer, uri};
use crate::edge::rrd::{self, RRD_NAME, RrdState};
use crate::edge::stream::{PORTS, is_free};
use crate::edge::terminal::asked_to_end;
use crate::edge::viewer::{self, Viewer};
use crate::mind::dirichlet::DirichletBelief;
use crate::scene::shown::slug;
use crate::scene::{DerivedData, SessionScene};
use crate::session::Stamped;

/// Where the server and the viewer for browsers are looked for, and the ports after.
const SERVER_PORT: u16 = 9878;
const WEB_PORT: u16 = 9090;

/// Why a recording could not be reviewed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RerunError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error("{}: the stream cannot be written: {reason}", path.display())]
    #[diagnostic(help("a place that can be written to, with --save=FILE"))]
    Unwritable { path: PathBuf, reason: io::Error },
    #[error("the viewer cannot be served on this machine: {0}")]
    #[diagnostic(help(
        "a free port from {WEB_PORT} and from {SERVER_PORT} on, up to {PORTS} further: end another tomcom review, or see who \
         listens there"
    ))]
    Web(io::Error),
    #[error("{}: the viewer cannot be started: {reason}", path.display())]
    #[diagnostic(help("--web serves one for a browser"))]
    Viewer { path: PathBuf, reason: io::Error },
}

impl From<FileError> for RerunError {
    fn from(error: FileError) -> RerunError {
        RerunError::File(Box::new(error))
    }
}

/// What `tomcom review` is asked for.
#[derive(Clone, Debug)]
pub struct ReviewRequest {
    pub recordings: Vec<PathBuf>,
    /// Only the file is written: beside the log, or here.
    pub save: Option<Option<PathBuf>>,
    /// The viewer is served for a browser, whether there is another one or not.
    pub web: bool,
    /// The moment to open at, by the trial's clock.
    pub at: Option<SessionTime>,
}

/// A file of a stream, and how it came about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SavedStream {
    pub path: PathBuf,
    /// It was made from the log just now.
    pub made: bool,
    /// Why the one that was there did not do.
    pub because: Option<&'static str>,
}

/// A recording that somebody still writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OngoingRecording {
    pub recording: PathBuf,
    /// Where viewers can look on, if they can.
    pub viewers: Option<String>,
}

/// Which of these recordings are of sessions that still run: what is shown of them ends now.
///
/// # Errors
/// One that cannot be read.
pub fn running(recordings: &[PathBuf]) -> FileResult<Vec<OngoingRecording>> {
    let mut running = Vec::new();
    for recording in recordings {
        if let Some(holder) = RecordingLock::holder(LogReader::open(recording)?.folder()) {
            running.push(OngoingRecording { recording: recording.clone(), viewers: holder.viewers });
        }
    }
    Ok(running)
}

/// What came of it.
pub enum ReviewOutcome {
    /// The file is there.
    Saved(SavedStream),
    /// The viewer was opened on the file.
    Opened(SavedStream),
    /// The viewer is served until this is dropped.
    Served { url: String, because: &'static str, _serving: Box<(RerunWriter, WebViewer)> },
}

/// Opens recordings in the viewer, several beside each other by the clocks of their trials.
///
/// # Errors
/// A recording that cannot be read, a file that cannot be written, or a viewer that cannot be opened.
pub fn review(asked: &ReviewRequest) -> Result<ReviewOutcome, RerunError> {
    let viewer = if asked.web { Viewer::None } else { Viewer::find() };
    match (&asked.save, viewer) {
        (Some(place), _) => Ok(ReviewOutcome::Saved(saved(&asked.recordings, place.as_deref())?)),
        (None, Viewer::Ready(viewer)) => {
            let file = saved(&asked.recordings, None)?;
            let opened = viewer::open(&viewer, &file.path, asked.at.map(|at| at.0));
            opened.map_err(|reason| RerunError::Viewer { path: viewer, reason })?;
            Ok(ReviewOutcome::Opened(file))
        }
        (None, other) => {
            let because = match other {
                Viewer::Other(_) => "the viewer that is installed is of another version",
                Viewer::NoScreen => "there is no screen for a window",
                _ if asked.web => "as asked for",
                _ => "there is no viewer in PATH",
            };
            serve(&asked.recordings, asked.at, because)
        }
    }
}

/// Waits until the program is asked to end.
///
/// # Errors
/// The system does not tell.
pub fn until_asked_to_end() -> io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(asked_to_end())
}

/// The file of the stream of a recording: that beside its log where it shows this log, else made from it.
///
/// # Errors
/// The recording cannot be read, or the file not be written.
pub fn save(recording: &Path) -> Result<PathBuf, RerunError> {
    Ok(saved(&[recording.to_path_buf()], None)?.path)
}

/// Streams recordings to a server, and serves the viewer for browsers.
fn serve(recordings: &[PathBuf], at: Option<SessionTime>, because: &'static str) -> Result<ReviewOutcome, RerunError> {
    let playing = playing(recordings)?;
    let (server, web, viewer) = ports().map_err(RerunError::Web)?;
    let outlets = StreamOutlets { file: None, server: Some((server, true)), at };
    let writer = write(playing, recordings, &outlets)?.map_err(RerunError::Web)?;
    let url = format!("http://{web}/?url={}", uri(server).replace('+', "%2B").replace(':', "%3A").replace('/', "%2F"));
    viewer::browse(&url);
    Ok(ReviewOutcome::Served { url, because, _serving: Box::new((writer, viewer)) })
}

/// The first port that is free for a stream, with that of the viewer's page, which is served already. They go in pairs: of
/// two programs that look at the same moment only one gets the page, and a server of Rerun does not say that its port was
/// taken meanwhile.
fn ports() -> io::Result<(SocketAddr, SocketAddr, WebViewer)> {
    let mut failed = io::Error::from(io::ErrorKind::AddrInUse);
    for nth in 0..=PORTS {
        let [server, web] = [SERVER_PORT, WEB_PORT].map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port + nth)));
        match WebViewer::serve(web.port()).and_then(|viewer| is_free(server).map(|()| viewer)) {
            Ok(viewer) => return Ok((server, web, viewer)),
            Err(reason) => failed = reason,
        }
    }
    Err(failed)
}

/// The file of the stream of these recordings: that beside the log where it shows this log, else made from it.
fn saved(recordings: &[PathBuf], place: Option<&Path>) -> Result<SavedStream, RerunError> {
    let (mut locked, mut because, mut logs) = (None, None, None);
    let path = match (place, recordings) {
        (Some(place), _) => place.to_path_buf(),
        (None, [recording]) => {
            let log = LogReader::open(recording)?;
            let (folder, parts) = (log.folder().to_path_buf(), log.logs());
            let path = folder.join(RRD_NAME);
            let state = rrd::state(&path, &parts).unwrap_or(RrdState::Unsealed);
            if state == RrdState::Whole {
                return Ok(SavedStream { path, made: false, because: None });
            }
            // Nobody else may be writing it: then, or where nothing can be written, it goes elsewhere.
            locked = RecordingLock::take(&folder).ok();
            if locked.is_some() {
                (because, logs) = (state.reason(), Some(parts));
                path
            } else {
                elsewhere(recordings)
            }
        }
        (None, several) => elsewhere(several),
    };
    let sealed = put(recordings, &path)?.and_then(|()| logs.map_or(Ok(()), |logs| rrd::seal(&path, &logs)));
    drop(locked);
    match sealed {
        Ok(()) => Ok(SavedStream { path, made: true, because }),
        Err(reason) => Err(RerunError::Unwritable { path, reason }),
    }
}

/// Makes the file of the stream of these recordings. What was there stays until all of the new one is: a log that turns out
/// to be damaged costs nothing.
fn put(recordings: &[PathBuf], path: &Path) -> Result<io::Result<()>, RerunError> {
    let mut begun = path.as_os_str().to_os_string();
    begun.push(".new");
    let begun = PathBuf::from(begun);
    let outlets = StreamOutlets { file: Some(begun.clone()), server: None, at: None };
    let written = playing(recordings).map_err(RerunError::from).and_then(|all| write(all, recordings, &outlets));
    match written {
        Ok(Ok(_)) => Ok(fs::rename(&begun, path)),
        failed => {
            // Left behind it does no harm.
            let _ = fs::remove_file(&begun);
            failed.map(|written| written.map(|_| ()))
        }
    }
}

/// A file for what cannot stand beside a log.
fn elsewhere(recordings: &[PathBuf]) -> PathBuf {
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    std::env::temp_dir().join(format!("tomcom-{}-{}.rrd", names.join("-and-"), std::process::id()))
}

fn name(recording: &Path) -> String {
    let folder = if recording.ends_with(LOG_NAME) { recording.parent().unwrap_or(recording) } else { recording };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
    folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Recordings on their way into a stream: one as it is; several below their names, each with its participant and condition.
fn playing(recordings: &[PathBuf]) -> FileResult<Vec<Playing>> {
    let one = |(nth, recording): (usize, &PathBuf)| {
        let playing = Playing::open(recording)?;
        if recordings.len() == 1 {
            return Ok(playing);
        }
        let name = name(recording);
        let spec = &playing.replay.log().header.session;
        let title = format!("{} {} ({name})", spec.participant.code, spec.trial.condition.name());
        Ok(Playing { lane: StreamLane { root: format!("{}_{}", nth + 1, slug(&name)), title }, ..playing })
    };
    recordings.iter().enumerate().map(one).collect()
}

/// Writes recordings to these outlets, one after the other; the outer error is theirs, the inner one of the outlets.
fn write(
    playing: Vec<Playing>,
    recordings: &[PathBuf],
    outlets: &StreamOutlets,
) -> Result<io::Result<RerunWriter>, RerunError> {
    let lanes: Vec<StreamLane> = playing.iter().map(|one| one.lane.clone()).collect();
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    let began: Vec<String> = playing.iter().map(Playing::began).collect();
    let id = format!("{} {} {}", names.join(" "), began.join(" "), rrd::mark());
    let mut writer = match RerunWriter::open(&StreamIdentity { id, name: names.join(" | ") }, outlets, &lanes) {
        Ok(writer) => writer,
        Err(error) => return Ok(Err(error)),
    };
    for one in playing {
        one.write(&mut writer)?;
    }
    writer.finish();
    Ok(Ok(writer))
}

/// A recording on its way into a stream.
struct Playing {
    replay: Replay,
    scene: SessionScene,
    lane: StreamLane,
}

impl Playing {
    fn open(recording: &Path) -> FileResult<Playing> {
        let replay = Replay::open(recording)?.without_causes();
        let scene = SessionScene::new(replay.session(), 0);
        Ok(Playing { replay, scene, lane: StreamLane::default() })
    }

    /// What tells it from other recordings of the same name.
    fn began(&self) -> String {
        let header = &self.replay.log().header;
        header.started.clone().unwrap_or_else(|| format!("seed {} trial {}", header.session.seed, header.trial))
    }

    /// Writes everything that the recording holds; the number of rows.
    fn write(mut self, writer: &mut RerunWriter) -> FileResult<u64> {
        writer.fixed(&self.lane, &self.scene.fixed());
        let mut rows = writer.moment(&self.lane, &self.scene.opening());
        let mut held: Option<(Stamped, Option<DirichletBelief>)> = None;
        loop {
            let next = self.replay.step()?;
            if let Some((stamped, belief)) = held.take() {
                // An estimate is shown when everything of its time has happened.
                let is_last = next.as_ref().is_none_or(|next| next.stamped.time > stamped.time);
                let judged = &self.replay.follower.judged;
                let derived = DerivedData { judged, belief: belief.as_ref().filter(|_| is_last) };
                let moments = self.scene.see(&stamped, derived);
                rows += moments.iter().map(|moment| writer.moment(&self.lane, moment)).sum::<u64>();
            }
            let Some(next) = next else { return Ok(rows) };
            let wants = self.scene.wants_belief(next.stamped.time);
            let belief = wants.then(|| self.replay.follower.filter.belief().clone());
            held = Some((next.stamped, belief));
        }
    }
}
