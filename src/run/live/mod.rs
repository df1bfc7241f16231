//! A live session: real time, a wizard at the console, every event recorded as it happens.

mod calibration;
#[cfg(feature = "display")]
mod display;
#[cfg(not(feature = "display"))]
#[path = "without_display.rs"]
mod display;
mod gaze;
mod inputs;
mod recording;
mod showing;
#[cfg(feature = "rerun")]
mod viewing;
#[cfg(not(feature = "rerun"))]
#[path = "without_rerun.rs"]
mod viewing;

use std::io;
use std::net::IpAddr;
use std::time::Duration;

use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until};

use self::display::ParticipantDisplay;
use super::unfinished_recording::{PreparedSession, RecordingPlace};
use super::watch_desk::ComparisonDesk;
use crate::analysis::trial_summary::TrialSummary;
use crate::analysis::watcher::ComparisonFollower;
use crate::console::compared::ComparisonView;
use crate::console::key_action::KeyError;
use crate::console::model::RecordingStatus;
use crate::console::{ConsoleModel, KeyBindings};
use crate::edge::clock::{SessionClock, WallTime};
use crate::edge::doctor::free_bytes;
use crate::edge::file_error::FileError;
use crate::edge::key_file::key_map;
use crate::edge::log::{LogWriter, RecordingLock, WriteError};
use crate::edge::terminal::{TerminalScreen, theme};
use crate::gaze::tags::TagError;
use crate::run::advisor_desk::{AdvisorDesk, next_advice};
use crate::run::desk::OperatorDesk;
use crate::run::engine::Engine;
use crate::run::leaving::{LeavingReason, LiveOutcome};
use crate::run::options::SessionStart;
use crate::run::resume::ResumeError;
use crate::run::standing::ExclusionStatus;
use crate::session::protocol::ProtocolEvent;
use crate::session::screen::VisibleScreen as OnScreen;
use crate::session::settings::GazeSource;
use crate::session::{Event, Header, Session};

/// At most 30 frames a second.
const FRAME: Duration = Duration::from_millis(33);
/// Clocks, bars and ages move on so often while the trial runs, and while it does not.
const RUNNING: Duration = Duration::from_millis(100);
const RESTING: Duration = Duration::from_millis(250);
/// The pointer is sampled as a tracker of 60 Hz.
const POINTER: Duration = Duration::from_nanos(16_666_667);
/// Gaze that waits is handed to the operating system so often.
const FLUSH: Duration = Duration::from_millis(50);
/// So often somebody looks whether the recording is still where it should be, and whether the clock jumped.
const WATCH: Duration = Duration::from_millis(250);

/// Why a live session could not be run, or not to its end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LiveError {
    #[error("the console cannot be opened: {0}")]
    #[diagnostic(help("run it in a terminal, not through a pipe"))]
    Terminal(io::Error),
    #[error(transparent)]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error("nothing can listen on port {port} of localhost for gaze: {reason}")]
    #[diagnostic(help("another port as gaze_port in the session file"))]
    Gaze { port: u16, reason: io::Error },
    #[error("nothing can listen on {address}, port {port}, for the participant's display: {reason}")]
    #[diagnostic(help("another port in the session file (port under [display]), or an address of this computer"))]
    Display { address: IpAddr, port: u16, reason: io::Error },
    #[error("the eye tracker has no surface to look for: found {}", .0.found)]
    #[diagnostic(help("{}; or a surface of your own, with its corners in [tracker]", .0.remedy))]
    Tags(TagError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] WriteError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Resume(#[from] ResumeError),
    #[error("found {0}")]
    #[diagnostic(help(
        "the plan as it was, or another folder with --out for another plan; tomcom plan SESSION shows it"
    ))]
    Plan(String),
}

impl From<FileError> for LiveError {
    fn from(error: FileError) -> LiveError {
        LiveError::File(Box::new(error))
    }
}

/// A recording that is run at the desk.
struct Live {
    engine: Engine,
    /// The assistant, if this session asks it.
    advisor: Option<AdvisorDesk>,
    /// Who compares wizard and assistants, if somebody does.
    watch: Option<ComparisonDesk>,
    /// The participant's display, if there is one.
    display: Option<ParticipantDisplay>,
    model: ConsoleModel,
    /// Of this recording.
    header: Header,
    log: LogWriter,
    /// What Rerun's viewers see.
    viewing: Option<viewing::StreamedSession>,
    /// The part that is continued is not to be written by anybody else.
    _before: Option<RecordingLock>,
    /// The log cannot be written any more.
    failed: Option<WriteError>,
    clock: SessionClock,
    gaze: gaze::GazeInput,
    /// The signal that no frame shows yet, by its number.
    undrawn: Option<u64>,
    /// What the wizard sees, as it was recorded last.
    seen: Option<OnScreen>,
    /// How many judged presses the model knows.
    judged: usize,
    /// Something changed since the last frame.
    dirty: bool,
}

/// Runs a session at the desk until the wizard leaves it; everything that happens is recorded.
///
/// # Errors
/// The session cannot be recorded, or the terminal is gone.
pub(in crate::run) async fn run(begun: PreparedSession, desk: &mut OperatorDesk) -> Result<LiveOutcome, LiveError> {
    Live::open(begun, desk)?.run(desk).await
}

impl Live {
    fn open(begun: PreparedSession, desk: &OperatorDesk) -> Result<Live, LiveError> {
        let PreparedSession { engine, mut header, first, consent, time, compare, place } = begun;
        let (kitchen, spec) = (engine.session().kitchen.clone(), engine.session().spec.clone());
        let keys = KeyBindings::live(&kitchen, &spec, &key_map(header.keys.as_ref())?)?;
        let keys = if compare.is_some() { keys.with_comparison() } else { keys };
        let wall = WallTime::now();
        header.started = Some(wall.rfc3339());
        let is_new = matches!(place, RecordingPlace::In(_));
        let (log, before) = match place {
            RecordingPlace::In(root) => (LogWriter::create_live(&root, &wall.date(), &header)?, None),
            RecordingPlace::After(folder, lock) => (LogWriter::create_part(&folder, &header)?, Some(lock)),
        };
        let size = TerminalScreen::size().map_err(LiveError::Terminal)?;
        let mut model = ConsoleModel::new(keys, theme(&spec.console, desk.screen.ground), size);
        model.recording = RecordingStatus::On(log.folder().display().to_string());
        model.comparison = compare.as_ref().map(|_| ComparisonView::default());
        let watch = compare
            .as_ref()
            .map(|request| ComparisonFollower::new(Session::new(kitchen.clone(), spec.clone(), header.trial), request));
        let watch = watch.map(|watcher| watcher.without_causes().on_thread());
        let (display, health) = ParticipantDisplay::at(desk);
        model.display = health;
        let clock = SessionClock::start(time);
        let advisor = spec.asks_assistant().then(|| engine.advisor().on_thread());
        let mut live = Live {
            engine,
            advisor,
            watch,
            display,
            model,
            header,
            log,
            viewing: None,
            _before: before,
            failed: None,
            clock,
            gaze: gaze::GazeInput::default(),
            undrawn: None,
            seen: None,
            judged: 0,
            dirty: true,
        };
        live.model.free_bytes = free_bytes(live.log.folder()).ok();
        live.begin_viewing(is_new, first.last().map_or(0, |last| last.seq + 1));
        live.record(&first);
        live.tick();
        if let Some(request) = compare {
            live.input(Event::Unblinded { concepts: request.concepts(&spec) });
        }
        live.carry_calibration(desk.tracker.calibrated());
        live.build_display();
        live.begin_protocol(consent);
        Ok(live)
    }

    async fn run(mut self, desk: &mut OperatorDesk) -> Result<LiveOutcome, LiveError> {
        let participant = &self.engine.session().spec.participant;
        // With a display, the pointer is on it.
        let with_pointer = participant.gaze == GazeSource::Mouse && self.display.is_none();
        let mut pointer = interval(POINTER);
        pointer.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let mut flush = interval(FLUSH);
        let mut watch = interval(WATCH);
        let mut leaving = LeavingReason::Quit;
        self.greet(&desk.tracker);
        let mut next_frame = Instant::now();
        let mut next_move = Instant::now();
        while !desk.screen.is_lost() {
            self.tick();
            let due = self.engine.next_due().map(|due| Instant::from_std(self.clock.instant_of(due)));
            let (target, recorded) = (self.next_target(), self.next_recorded());
            tokio::select! {
                biased;
                message = desk.seat.next() => match message {
                    Some(message) => if let Some(how) = self.take(message) {
                        leaving = how;
                        break;
                    },
                    None => break,
                },
                () = sleep_until(due.unwrap_or_else(Instant::now)), if due.is_some() => {
                    // Most cycles of the arm tell nothing.
                    let events = self.engine.fire();
                    if !events.is_empty() {
                        self.record(&events);
                    }
                }
                () = sleep_until(target.unwrap_or_else(Instant::now)), if target.is_some() => self.show_target(),
                Some(input) = desk.wall.next() => self.hear(input),
                Some(advice) = next_advice(&mut self.advisor) => self.advise(advice),
                _ = pointer.tick(), if with_pointer => self.look(),
                _ = flush.tick() => {
                    self.flush();
                    self.view_motion();
                }
                _ = watch.tick() => self.watch(),
                () = sleep_until(next_frame.max(next_move)), if !self.dirty => self.dirty = true,
                () = sleep_until(next_frame), if self.dirty => {
                    next_frame = Instant::now() + FRAME;
                    next_move = Instant::now() + if self.engine.session().is_running() { RUNNING } else { RESTING };
                    self.draw(&mut desk.screen).map_err(LiveError::Terminal)?;
                }
                // Last: a tracker that sends more than can be read delays itself, and neither robot, log nor screen.
                () = sleep_until(recorded.unwrap_or_else(Instant::now)), if recorded.is_some() => self.take_recorded(),
                Some(news) = desk.tracker.next() => self.take_all(news, &mut desk.tracker),
            }
        }
        desk.tracker.keep(self.engine.session().calibrated.clone());
        let end = self.close(leaving);
        desk.tracker.settle().await;
        end
    }

    /// Begins the first phase of a plan; without consent nothing is recorded, so that comes first.
    fn begin_protocol(&mut self, consent: bool) {
        if consent {
            self.input(Event::Protocol(ProtocolEvent::ConsentGiven));
        }
        let session = self.engine.session();
        let first = session.next_phase().filter(|_| session.protocol.as_ref().is_some_and(|it| it.number == 0));
        if let Some(phase) = first {
            self.input(Event::Protocol(ProtocolEvent::PhaseStarted { phase, number: 1 }));
        }
    }

    /// The same trial in another recording beside this one.
    fn beginning_again(&self) -> SessionStart {
        let folder = self.log.folder();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let out = folder.parent().unwrap_or(std::path::Path::new(".")).to_path_buf();
        let header = Header { redoes: Some(name), started: None, continues: None, ..self.header.clone() };
        SessionStart::Again { header: Box::new(header), kitchen: self.engine.session().kitchen.clone(), out }
    }

    fn close(mut self, leaving: LeavingReason) -> Result<LiveOutcome, LiveError> {
        if self.failed.is_none() {
            // What was left in the middle of a plan is not over: it can be continued.
            if leaving != LeavingReason::Quit || self.engine.session().is_step_done() {
                self.input(Event::SessionEnded);
            }
            self.flush();
        }
        if let Some(viewing) = self.viewing.take() {
            viewing.close(&self.log);
        }
        let folder = self.log.folder().to_path_buf();
        match self.failed {
            Some(error) => Err(error.into()),
            None => {
                let again = (leaving == LeavingReason::Redo).then(|| self.beginning_again());
                let standing = ExclusionStatus::at_console(self.engine.session());
                let figures = TrialSummary::from_follower(&self.engine.into_follower());
                Ok(LiveOutcome { folder, leaving, figures, standing, again })
            }
        }
    }
}
