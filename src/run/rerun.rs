//! `tomcom review`: recordings in Rerun's viewer, from the stream beside their log, or made from the log.

use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use super::replay::Replay;
use crate::base::time::SessionTime;
use crate::edge::files::{FileError, FileResult};
use crate::edge::log::{LOG_NAME, Lock, LogReader};
use crate::edge::rerun::{Identity, Lane, Outlets, WebViewer, Writer, uri};
use crate::edge::rrd::{self, RRD_NAME, RrdState};
use crate::edge::stream::free_port;
use crate::edge::terminal::asked_to_end;
use crate::edge::viewer::{self, Viewer};
use crate::mind::dirichlet::DirichletBelief;
use crate::scene::shown::slug;
use crate::scene::{Derived, Scene};
use crate::session::{Event, Stamped};

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
    #[diagnostic(help("a native viewer: {}", viewer::REMEDY))]
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
pub struct Review {
    pub recordings: Vec<PathBuf>,
    /// Only the file is written: beside the log, or here.
    pub save: Option<Option<PathBuf>>,
    /// The viewer is served for a browser, whether there is another one or not.
    pub web: bool,
    /// The moment to open at, in seconds: of one recording since it began, of several since their trials' starts.
    pub at_s: Option<f64>,
}

/// What came of it.
pub enum Reviewed {
    /// The file is there; made anew, or as it was.
    Saved { path: PathBuf, made: bool },
    /// The viewer was opened on the file.
    Opened { path: PathBuf },
    /// The viewer is served until this is dropped.
    Served { url: String, because: &'static str, _serving: Box<(Writer, WebViewer)> },
}

/// Opens recordings in the viewer, several beside each other with their trials' starts at the same time.
///
/// # Errors
/// A recording that cannot be read, a file that cannot be written, or a viewer that cannot be opened.
pub fn review(asked: &Review) -> Result<Reviewed, RerunError> {
    let viewer = if asked.web { Viewer::None } else { Viewer::find() };
    match (&asked.save, viewer) {
        (Some(place), _) => {
            let (path, made) = saved(&asked.recordings, place.as_deref())?;
            Ok(Reviewed::Saved { path, made })
        }
        (None, Viewer::Ready(viewer)) => {
            let (path, _) = saved(&asked.recordings, None)?;
            let at = asked.at_s.map(|at_s| SessionTime::from_secs_f64(at_s).0);
            let opened = viewer::open(&viewer, &path, at);
            opened.map_err(|reason| RerunError::Viewer { path: viewer, reason })?;
            Ok(Reviewed::Opened { path })
        }
        (None, other) => {
            let because = match other {
                Viewer::Other(_) => "the viewer that is installed is of another version",
                Viewer::NoScreen => "there is no screen for a window",
                _ if asked.web => "as asked for",
                _ => "there is no viewer in PATH",
            };
            serve(&asked.recordings, because)
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

/// The file of the stream of a recording: that beside its log where it is whole, else made from the log.
///
/// # Errors
/// The recording cannot be read, or the file not be written.
pub fn save(recording: &Path) -> Result<PathBuf, RerunError> {
    Ok(saved(&[recording.to_path_buf()], None)?.0)
}

/// Streams recordings to a server, and serves the viewer for browsers.
fn serve(recordings: &[PathBuf], because: &'static str) -> Result<Reviewed, RerunError> {
    let local = |port: u16| free_port(SocketAddr::from((Ipv4Addr::LOCALHOST, port))).map_err(RerunError::Web);
    let playing = playing(recordings)?;
    let (server, web) = (local(SERVER_PORT)?, local(WEB_PORT)?);
    let outlets = Outlets { file: None, server: Some((server, true)) };
    let writer = write(playing, recordings, &outlets)?.map_err(RerunError::Web)?;
    let viewer = WebViewer::serve(web.port()).map_err(RerunError::Web)?;
    let url = format!("http://{web}/?url={}", uri(server).replace('+', "%2B").replace(':', "%3A").replace('/', "%2F"));
    viewer::browse(&url);
    Ok(Reviewed::Served { url, because, _serving: Box::new((writer, viewer)) })
}

/// The file of the stream of these recordings: that beside the log where it is whole, else made from the log.
fn saved(recordings: &[PathBuf], place: Option<&Path>) -> Result<(PathBuf, bool), RerunError> {
    let mut locked = None;
    let path = match (place, recordings) {
        (Some(place), _) => place.to_path_buf(),
        (None, [recording]) => {
            let folder = LogReader::open(recording)?.folder().to_path_buf();
            let path = folder.join(RRD_NAME);
            if matches!(rrd::state(&path), Ok(RrdState::Whole)) {
                return Ok((path, false));
            }
            // Nobody else may be writing it: then, or where nothing can be written, it goes elsewhere.
            locked = Lock::take(&folder).ok();
            if locked.is_some() { path } else { elsewhere(recordings) }
        }
        (None, several) => elsewhere(several),
    };
    let outlets = Outlets { file: Some(path.clone()), server: None };
    let written = write(playing(recordings)?, recordings, &outlets)?;
    drop(locked);
    match written {
        Ok(_) => Ok((path, true)),
        Err(reason) => Err(RerunError::Unwritable { path, reason }),
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

/// Recordings on their way into a stream: one as it is; several below their names, by the time since their trials' starts.
fn playing(recordings: &[PathBuf]) -> FileResult<Vec<Playing>> {
    let one = |(nth, recording): (usize, &PathBuf)| {
        let root = format!("{}_{}", nth + 1, slug(&name(recording)));
        match recordings.len() {
            1 => Playing::open(recording, Lane::default()),
            _ => Playing::open(recording, Lane { root, origin: trial_start(recording)? }),
        }
    };
    recordings.iter().enumerate().map(one).collect()
}

fn trial_start(recording: &Path) -> FileResult<SessionTime> {
    let mut log = LogReader::open(recording)?;
    while let Some(line) = log.next_line()? {
        if line.stamped.event == Event::TrialStarted {
            return Ok(line.stamped.time);
        }
    }
    Ok(SessionTime::ZERO)
}

/// Writes recordings to these outlets, one after the other; the outer error is theirs, the inner one of the outlets.
fn write(playing: Vec<Playing>, recordings: &[PathBuf], outlets: &Outlets) -> Result<io::Result<Writer>, RerunError> {
    let lanes: Vec<Lane> = playing.iter().map(|one| one.lane.clone()).collect();
    let names: Vec<String> = recordings.iter().map(|recording| name(recording)).collect();
    let began: Vec<String> = playing.iter().map(Playing::began).collect();
    let id = format!("{} {} {}", names.join(" "), began.join(" "), rrd::mark());
    let writer = match Writer::open(&Identity { id, name: names.join(" | ") }, outlets, &lanes) {
        Ok(writer) => writer,
        Err(error) => return Ok(Err(error)),
    };
    for one in playing {
        one.write(&writer)?;
    }
    writer.finish();
    Ok(Ok(writer))
}

/// A recording on its way into a stream.
struct Playing {
    replay: Replay,
    scene: Scene,
    lane: Lane,
}

impl Playing {
    fn open(recording: &Path, lane: Lane) -> FileResult<Playing> {
        let replay = Replay::open(recording)?.without_causes();
        let scene = Scene::new(replay.session(), 0);
        Ok(Playing { replay, scene, lane })
    }

    /// What tells it from other recordings of the same name.
    fn began(&self) -> String {
        let header = &self.replay.log().header;
        header.started.clone().unwrap_or_else(|| format!("seed {} trial {}", header.session.seed, header.trial))
    }

    /// Writes everything that the recording holds; the number of rows.
    fn write(mut self, writer: &Writer) -> FileResult<u64> {
        writer.fixed(&self.lane, &self.scene.fixed());
        let mut rows = writer.moment(&self.lane, &self.scene.opening());
        let mut held: Option<(Stamped, Option<DirichletBelief>)> = None;
        loop {
            let line = self.replay.step()?;
            if let Some((stamped, belief)) = held.take() {
                // An estimate is shown when everything of its time has happened.
                let is_last = line.as_ref().is_none_or(|next| next.stamped.time > stamped.time);
                let judged = &self.replay.follower.judged;
                let derived = Derived { judged, belief: belief.as_ref().filter(|_| is_last) };
                let moments = self.scene.see(&stamped, derived);
                rows += moments.iter().map(|moment| writer.moment(&self.lane, moment)).sum::<u64>();
            }
            let Some(line) = line else { return Ok(rows) };
            let wants = self.scene.wants_belief(line.stamped.time);
            let belief = wants.then(|| self.replay.follower.filter.belief().clone());
            held = Some((line.stamped, belief));
        }
    }
}
