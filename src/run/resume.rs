//! Continues a recording that was cut off or ended early: the session is run again up to there, and continues in a new
//! part of the recording, in a folder beside it, which takes the place of the session's end.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::LiveError;
use super::options::SessionStart;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::file_error::FileError;
use tomcom_session::header::PreviousPart;
use tomcom_session::log::{LOG_NAME, LogReader, RecordingLock, RecordingWriteError, check_continued};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::verify::RepeatedRecording;
use tomcom_session::watcher::SenderComparisonSettings;
use tomcom_session::{Event, LogHeader, SessionSpec, TimestampedEvent};

/// Why a recording cannot be continued.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ResumeError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    #[error("{}: everything in this recording was done, so it cannot be continued", .0.display())]
    #[diagnostic(help(
        "continue a recording that was cut or ended early, as tomcom list says; a new session: tomcom operate"
    ))]
    Ended(PathBuf),
    /// The header of a part names the previous part as text, and this folder's name is no text.
    #[error("{}: the name of this recording's folder is not UTF-8, so a new part cannot name it", .0.display())]
    #[diagnostic(help("rename the folder; letters, digits and - are safe everywhere"))]
    Name(PathBuf),
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
        log: PathBuf,
        /// Sequence number of the event that differs.
        seq: u64,
    },
}

/// Runs the session of a cut recording, or of one that ended early, again up to there. A running trial, or a freeze
/// probe in it, is paused until the participant is back.
///
/// # Errors
/// The recording cannot be read, is being written, has everything in it, or cannot be verified.
pub fn resume(recording: &Path) -> Result<PreparedSession, ResumeError> {
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
    let RepeatedRecording { log, mut again, difference, .. } = RepeatedRecording::from_log(log.without_end())?;
    if let Some(difference) = difference {
        return Err(ResumeError::Differs { log: difference.log.0, seq: difference.seq });
    }
    if !log.is_cut() && again.engine.session().is_step_done() {
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
    let begins = PreparedSession::begins(again.engine, header, RecordingPlace::After(folder, lock));
    Ok(PreparedSession { first, time, ..begins })
}

/// A session that is prepared to be run and recorded.
pub struct PreparedSession {
    pub engine: SessionEngine,
    pub header: LogHeader,
    /// First events of a new part, which exist before it runs: those lost by the cut, and the pause of a running trial.
    pub first: Vec<TimestampedEvent>,
    /// The participant's consent, if it was asked for just before the session.
    pub consent: Option<ProtocolEvent>,
    /// Session time at which the session begins.
    pub time: SessionTime,
    /// Comparison of wizard and assistants, if the console shows it.
    pub compare: Option<SenderComparisonSettings>,
    pub place: RecordingPlace,
    /// In a plan: number of participants who have done everything, and of all of them.
    pub participants_done: Option<(usize, usize)>,
    /// In a plan: whether nothing of the participant's series is left after this recording.
    pub is_last: bool,
}

/// In which folder the recording's folder is created.
pub enum RecordingPlace {
    In(PathBuf),
    /// Beside the previous part, whose lock keeps other programs from it.
    After(PathBuf, RecordingLock),
}

impl PreparedSession {
    /// Prepares a session; nothing is recorded yet.
    ///
    /// # Errors
    /// The recording that shall be continued cannot be continued.
    pub fn new(
        beginning: SessionStart,
        compare: Option<SenderComparisonSettings>,
    ) -> Result<PreparedSession, LiveError> {
        let begins = match beginning {
            SessionStart::New { files, trial, out } => {
                let kitchen = Arc::new(files.kitchen.kitchen);
                let spec = files.spec;
                let mut header = LogHeader::new(spec.clone(), trial, files.kitchen.layout, files.kitchen.recipes);
                header.keys = files.keys;
                let engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen));
                PreparedSession::begins(engine, header, RecordingPlace::In(out))
            }
            SessionStart::Again { header, kitchen, out } => {
                let engine = SessionEngine::for_header(kitchen.clone(), &header, CostToGo::new(kitchen));
                PreparedSession::begins(engine, *header, RecordingPlace::In(out))
            }
            SessionStart::Continued(recording) => resume(&recording)?,
        };
        Ok(PreparedSession { compare, ..begins })
    }

    /// A session from its first moment, with nothing beside it.
    fn begins(engine: SessionEngine, header: LogHeader, place: RecordingPlace) -> PreparedSession {
        PreparedSession {
            engine: engine.without_causes(),
            header,
            first: Vec::new(),
            consent: None,
            time: SessionTime::ZERO,
            compare: None,
            place,
            participants_done: None,
            is_last: false,
        }
    }

    pub fn kitchen(&self) -> &Kitchen {
        &self.engine.session().kitchen
    }

    pub fn spec(&self) -> &SessionSpec {
        &self.engine.session().spec
    }
}
