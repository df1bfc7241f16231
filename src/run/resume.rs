//! Continues a recording that was cut off: the session is run again up to the cut, and continues in a new part of the
//! recording, in a folder beside it.

use std::path::{Path, PathBuf};

use tomcom_core::base::time::SessionTime;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::file_error::FileError;
use tomcom_session::header::PreviousPart;
use tomcom_session::log::{LOG_NAME, LogReader, RecordingLock, RecordingWriteError, check_continued};
use tomcom_session::verify::RepeatedRecording;
use tomcom_session::{Event, LogHeader, TimestampedEvent};

/// Why a recording cannot be continued.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ResumeError {
    /// A file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    /// The new part of the recording cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    /// The session of this recording ended properly.
    #[error("{}: the session of this recording was brought to its end, so it cannot be continued", .0.display())]
    #[diagnostic(help("continue a recording that was cut; a new session: tomcom operate"))]
    Ended(PathBuf),
    /// The header of a part names the previous part as text, and this folder's name is no text.
    #[error("{}: the name of this recording's folder is not UTF-8, so a new part cannot name it", .0.display())]
    #[diagnostic(help("rename the folder; letters, digits and - are safe everywhere"))]
    Name(PathBuf),
    /// The recording is of a simulated trial, which cannot be continued.
    #[error("{}: this recording is simulated, and only a person's session can be continued", .0.display())]
    #[diagnostic(help("simulate it again with the same seed: tomcom simulate"))]
    Simulated(PathBuf),
    /// Running the session again gives another event than the recorded one.
    #[error("{}: event {seq} does not come out the same when the recording is run again, so the session's state at \
             the cut is not known", log.display())]
    #[diagnostic(help(
        "continue it with the version of tomcom that wrote it; tomcom replay RECORDING --verify shows the difference"
    ))]
    Differs {
        /// Path of the recording's log.
        log: PathBuf,
        /// Sequence number of the event that differs.
        seq: u64,
    },
}

impl From<FileError> for ResumeError {
    fn from(error: FileError) -> ResumeError {
        ResumeError::File(Box::new(error))
    }
}

/// A session that continues a recording after its cut.
#[derive(Debug)]
pub struct ResumedSession {
    /// The engine, in the session's state at the cut.
    pub engine: SessionEngine,
    /// First events of the new part: events lost by the cut, and the pause of a running trial.
    pub first: Vec<TimestampedEvent>,
    /// Header of the new part.
    pub header: LogHeader,
    /// Session time at which the continued session goes on.
    pub time: SessionTime,
    /// Folder of the previous part of the recording.
    pub folder: PathBuf,
    /// Lock that keeps other programs from the previous part.
    pub lock: RecordingLock,
}

/// Runs the session of a cut recording again up to the cut. A running trial, or a freeze probe in it, is paused at the
/// cut until the participant is back.
///
/// # Errors
/// The recording cannot be read, is being written, was not cut off, or cannot be verified.
pub fn resume(recording: &Path) -> Result<ResumedSession, ResumeError> {
    // The path is made absolute, since the new part is created beside the recording and refers to it by name.
    let there = recording.canonicalize();
    let there = there.map_err(|reason| FileError::unreadable(recording, reason, "the folder of a cut recording"))?;
    let folder = if there.is_dir() { there } else { there.parent().unwrap_or(Path::new("/")).to_path_buf() };
    let Some(name) = folder.file_name().unwrap_or_default().to_str() else { return Err(ResumeError::Name(folder)) };
    let log = LogReader::open(&folder.join(LOG_NAME))?;
    if log.header.started.is_none() {
        return Err(ResumeError::Simulated(folder));
    }
    log.header.session.require_built_live().map_err(|missing| FileError::not_built(&folder, missing))?;
    let lock = RecordingLock::take(&folder)?;
    check_continued(&folder)?;
    let RepeatedRecording { log, mut again, difference, .. } = RepeatedRecording::from_log(log)?;
    if let Some(difference) = difference {
        return Err(ResumeError::Differs { log: difference.log.0, seq: difference.seq });
    }
    if !log.is_cut() {
        return Err(ResumeError::Ended(folder));
    }
    let time = again.engine.session().time;
    let mut first = Vec::from(again.produced);
    if again.engine.session().can_be_paused() {
        first.extend(again.engine.input(time, Event::TrialPaused).events);
    }
    let continues = PreviousPart { recording: name.to_string(), events: log.events(), t_ns: time };
    let old = log.header;
    let mut header = LogHeader::new(old.session, old.trial, old.layout, old.recipes);
    header.continues = Some(continues);
    header.keys = old.keys;
    // All parts of a recording have the same version of the format.
    header.version = old.version;
    Ok(ResumedSession { engine: again.engine, first, header, time, folder, lock })
}
