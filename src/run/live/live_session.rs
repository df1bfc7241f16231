//! A live session: its parts, beginning and end.

use std::time::{Duration, Instant};

use super::capture_orders::CaptureRequestSender;
use super::display::ParticipantDisplay;
use super::filming::Filming;
use super::gaze_events::GazeInput;
use super::lsl_streaming::LslStreaming;
use super::viewing::StreamedSession;
use crate::console::console_model::{NoticeLevel, RecordingStatus, SenderComparisonView};
use crate::console::preflight::ObserverStatus;
use crate::console::{ConsoleModel, KeyBindings};
use crate::run::assistant_link::{AssistantLink, AssistantNews, next_news};
use crate::run::clock::SessionClock;
use crate::run::comparison_thread::ComparisonThreadHandle;
use crate::run::doctor::free_bytes;
use crate::run::error::{LiveError, TerminalError};
use crate::run::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use crate::run::key_file::key_map;
use crate::run::leaving::{LeavingReason, LiveOutcome, TutorialProgress};
use crate::run::operator_station::{ArmOrders, GazeTracker, OperatorStation};
use crate::run::options::SessionStart;
use crate::run::participant_link::{ParticipantLink, next_line};
use crate::run::resume::{PreparedSession, RecordingPlace};
use crate::run::terminal::{TerminalScreen, theme};
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_devices::external::LocalMinds;
use tomcom_session::engine::SessionEngine;
use tomcom_session::event::WizardScreenContent;
use tomcom_session::files::WallTime;
use tomcom_session::log::{LogWriter, RecordingLock, RecordingWriteError};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::{TrackerEvent, TrackerRecording};
use tomcom_session::watcher::SenderComparisonFollower;
use tomcom_session::{Event, LogHeader, Session};
use tomcom_study::analysis::recording_summary::ExclusionStatus;
use tomcom_study::analysis::trial_summary::TrialSummary;

/// Period of redrawing clocks and ages on the console while the trial is running.
const RUNNING: Duration = Duration::from_millis(100);
/// The same while it is not: what is recorded or pressed is drawn at once, and only rates and ages change without.
const RESTING: Duration = Duration::from_secs(1);

/// A running session with its recording and devices.
pub(super) struct Live {
    pub(super) engine: SessionEngine,
    /// Connection to whoever advises, if the session requests advice.
    pub(super) advisor: Option<AssistantLink>,
    /// Connection to a program in the participant's place.
    pub(super) participant: Option<ParticipantLink>,
    /// The comparison of wizard and assistants, if the console shows it.
    pub(super) comparison: Option<ComparisonThreadHandle>,
    pub(super) display: Option<ParticipantDisplay>,
    arm: Option<ArmOrders>,
    /// What tells the state of the observers' page, if there is one.
    pub(super) observers: Option<Box<dyn Fn() -> ObserverStatus>>,
    /// Session time at which the page that takes part was last heard of, while it is lost.
    pub(super) page_lost: Option<SessionTime>,
    pub(super) model: ConsoleModel,
    header: LogHeader,
    pub(super) log: LogWriter,
    pub(super) viewing: Option<StreamedSession>,
    pub(super) lsl: Option<LslStreaming>,
    /// Lock on the previous part of a continued recording, so that no other program writes to it.
    _before: Option<RecordingLock>,
    pub(super) failed: Option<RecordingWriteError>,
    pub(super) clock: SessionClock,
    pub(super) gaze: GazeInput,
    pub(super) capture: CaptureRequestSender,
    pub(super) filming: Filming,
    /// Sequence number of a signal that no frame on the wizard's screen has shown yet.
    pub(super) undrawn: Option<u64>,
    /// Last recorded content of the wizard's screen.
    pub(super) seen: Option<WizardScreenContent>,
    pub(super) judged: usize,
    /// Whether gaze and the participant's page were there when the recording was last watched.
    pub(super) watched: (bool, bool),
    /// Whether the console's screen has to be redrawn.
    pub(super) dirty: bool,
}

/// Runs and records a session at the station until the wizard leaves it.
///
/// # Errors
/// The session cannot be recorded, or the terminal was closed.
pub(in crate::run) async fn run(
    begun: PreparedSession,
    station: &mut OperatorStation,
) -> Result<LiveOutcome, LiveError> {
    let mut live = Live::open(begun, station)?;
    live.record_tracker_state(&station.tracker);
    let left = event_loop::run(&mut live, station).await;
    // If the wizard did not leave by a key, the program was told to end, or the console failed. The recording is closed
    // and the robot stops in any case.
    let leaving = left.as_ref().ok().copied().flatten().unwrap_or(LeavingReason::Quit);
    let told = if leaving == LeavingReason::Quit { Ok(()) } else { live.tell_next(station) };
    station.tracker.calibrated = live.engine.session().calibrated.clone();
    let films = live.filming.leave();
    let folder = live.log.folder().to_path_buf();
    let end = live.close(leaving);
    if let Some(films) = films {
        station.films.close(films, folder);
    }
    station.tracker.finish_requests().await;
    left.and(told).and(end)
}

impl ConsoleShell for Live {
    type Outcome = LeavingReason;
    type Error = LiveError;

    fn deadlines(&mut self) -> ShellDeadlines {
        self.tick();
        let session = self.engine.session();
        let at = |time| self.clock.instant_of(time).into();
        let resting = if session.is_running() { RUNNING } else { RESTING };
        ShellDeadlines {
            engine: self.engine.next_due().into_iter().chain(self.participant_due()).min().map(at),
            target: self.target_due().map(at),
            file_gaze: self.gaze.file_due(session).map(at),
            frame_after: if self.dirty { FRAME } else { resting },
        }
    }

    fn samples_pointer(&self) -> bool {
        // In sessions with a participant's display, the mouse pointer on the display stands for gaze, not the
        // console's.
        self.engine.session().spec.participant.gaze == GazeSource::Mouse && self.display.is_none()
    }

    async fn advice(&mut self) -> Option<AssistantNews> {
        tokio::select! {
            news = next_news(&mut self.advisor) => news,
            news = next_line(&mut self.participant) => news.map(AssistantNews::Participant),
        }
    }

    fn take(&mut self, event: LoopEvent) -> Result<Option<LeavingReason>, LiveError> {
        match event {
            LoopEvent::Terminal(message) => return Ok(self.take_message(message)),
            LoopEvent::Suspend => self.pause_for_stop(),
            LoopEvent::EngineDue => self.fire(),
            LoopEvent::TargetDue => self.show_target(),
            LoopEvent::Page(input) => self.take_page_input(input),
            LoopEvent::Arm(news) => self.take_arm_news(news),
            LoopEvent::ButtonBox(message) => self.take_button_box(message),
            LoopEvent::Advice(news) => self.take_assistant_news(news),
            LoopEvent::Remark(remark) => self.take_remark(remark),
            LoopEvent::PointerTick => self.sample_pointer(),
            LoopEvent::FileTick => self.flush(),
            LoopEvent::WatchTick => self.watch(),
            LoopEvent::FileGazeDue => self.take_file_gaze(),
            LoopEvent::Gaze(news) => news.into_iter().for_each(|one| self.take_gaze(one)),
            LoopEvent::EndRequest | LoopEvent::Continued | LoopEvent::FrameDue => {}
        }
        Ok(None)
    }

    fn prepare(&mut self) {
        self.prepare_frame();
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Console(self.engine.session(), &self.model)
    }

    fn drawn(&mut self) {
        self.tell_drawn();
    }
}

impl Live {
    fn open(begun: PreparedSession, station: &mut OperatorStation) -> Result<Live, LiveError> {
        let PreparedSession { engine, mut header, first, consent, time, compare, place, participants_done, is_last } =
            begun;
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
        let size = TerminalScreen::size().map_err(TerminalError)?;
        let mut model = ConsoleModel::new(keys, theme(&spec.console, station.screen.ground), size);
        model.recording = RecordingStatus::On(log.folder().display().to_string());
        model.comparison = compare.as_ref().map(|_| SenderComparisonView::default());
        model.participants_done = participants_done;
        model.is_last_recording = is_last;
        let comparison = compare.as_ref().map(|request| {
            let session = Session::new(kitchen.clone(), spec.clone(), header.trial);
            let follower = SenderComparisonFollower::new(session, CostToGo::new(kitchen.clone()), request);
            ComparisonThreadHandle::start(follower.without_causes())
        });
        let (display, health) = ParticipantDisplay::at(station);
        model.display = health;
        model.gaze_pairing = station.tracker.pairing.clone();
        model.recorded_gaze = station.tracker.file.as_ref().map(|file| file.summary.clone());
        let clock = SessionClock::start(time);
        let (advisor, mut told) = AssistantLink::start(&engine, &LocalMinds);
        let (participant, faults) = ParticipantLink::start(engine.session(), &LocalMinds);
        told.extend(faults);
        let mut live = Live {
            engine,
            advisor,
            participant,
            comparison,
            display,
            arm: station.arm.orders(),
            observers: station.observers.status(),
            page_lost: None,
            model,
            header,
            log,
            viewing: None,
            lsl: None,
            _before: before,
            failed: None,
            clock,
            gaze: GazeInput::default(),
            capture: CaptureRequestSender::default(),
            filming: Filming::default(),
            undrawn: None,
            seen: None,
            judged: 0,
            watched: (false, false),
            dirty: true,
        };
        live.model.free_bytes = free_bytes(live.log.folder()).ok();
        live.begin_viewing(is_new, first.last().map_or(0, |last| last.seq + 1));
        live.begin_lsl(station);
        live.begin_filming();
        if let Some(arm) = &live.arm {
            arm.begin();
        }
        live.record(&first);
        live.tick();
        if let Some(request) = compare {
            live.input(Event::Unblinded { concepts: request.concepts(&spec) });
        }
        told.into_iter().for_each(|event| live.input(event));
        live.carry_calibration(station.tracker.calibrated.as_ref());
        live.build_display();
        if let Some(link) = station.button_box.link.clone() {
            live.take_button_box(link);
        }
        live.begin_protocol(consent);
        Ok(live)
    }

    /// Passes an event to a real arm, where the event is about it.
    pub(super) fn tell_arm(&self, event: &Event) {
        if let Some(arm) = &self.arm {
            arm.tell(event);
        }
    }

    /// Repeats the order for a real arm.
    pub(super) fn order_arm(&self) {
        if let Some((arm, order)) = self.arm.as_ref().zip(self.engine.arm_order()) {
            arm.order(order);
        }
    }

    /// Pauses the trial before the program is stopped, since nothing happens and nothing is recorded then.
    fn pause_for_stop(&mut self) {
        if self.engine.session().can_be_paused() {
            self.input(Event::TrialPaused);
            self.model.say(NoticeLevel::Refused, "the trial is paused, since the program was stopped by a signal");
        }
        self.flush_log();
    }

    /// Opens the stream to Rerun if the session has one; if opening fails, the session continues without the stream.
    fn begin_viewing(&mut self, is_new: bool, next: u64) {
        match StreamedSession::open(self.engine.session(), &self.header, &mut self.log, next, is_new) {
            Ok(viewing) => self.viewing = viewing,
            Err(reason) => self.model.say(NoticeLevel::Alarm, format!("the session goes on without Rerun: {reason}")),
        }
        self.model.viewers = self.viewing.as_ref().map(StreamedSession::status);
    }

    /// Opens the session's LSL streams, if it has any; if opening fails, the session continues without LSL streams.
    fn begin_lsl(&mut self, station: &mut OperatorStation) {
        match LslStreaming::open(station, self.engine.session(), &self.name(), &self.clock) {
            Ok(lsl) => self.lsl = lsl,
            Err(reason) => self.model.say(NoticeLevel::Alarm, format!("the session goes on without LSL: {reason}")),
        }
        self.model.lsl = self.lsl.as_ref().map(LslStreaming::status);
    }

    /// Prepares the films of the trial, and films a trial that goes on after a cut.
    fn begin_filming(&mut self) {
        let (filming, lost) = Filming::at(self.engine.session(), self.log.folder());
        self.filming = filming;
        self.model.films = self.filming.status();
        self.record_films(lost);
    }

    /// Records the tracker's state at the beginning of a recording.
    fn record_tracker_state(&mut self, tracker: &GazeTracker) {
        self.gaze = GazeInput::at(tracker, self.engine.session());
        tracker.known().for_each(|news| self.take_gaze(news));
        self.capture = CaptureRequestSender::begin(tracker, self.name(), self.engine.session(), Instant::now());
    }

    /// Begins the first phase of a study plan's recording; the participant's consent is its first event.
    fn begin_protocol(&mut self, consent: Option<ProtocolEvent>) {
        if let Some(consent) = consent {
            self.input(Event::Protocol(consent));
        }
        let session = self.engine.session();
        let first = session.next_phase().filter(|_| session.protocol.as_ref().is_some_and(|it| it.number == 0));
        if let Some(phase) = first {
            self.input(Event::Protocol(ProtocolEvent::PhaseStarted { phase, number: 1 }));
        }
    }

    /// Says that the next recording is being prepared, which can take a second: keys are not taken meanwhile.
    fn tell_next(&mut self, station: &mut OperatorStation) -> Result<(), LiveError> {
        if !self.model.is_last_recording {
            self.model.say(NoticeLevel::Done, "the next recording is being prepared: wait for its first screen");
            station.draw(&self.view())?;
        }
        Ok(())
    }

    fn name(&self) -> String {
        self.log.folder().file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Start of a repetition of this trial in a new recording beside this session's.
    fn beginning_again(&self) -> SessionStart {
        let out = self.log.folder().parent().unwrap_or(std::path::Path::new(".")).to_path_buf();
        let header = LogHeader { redoes: Some(self.name()), started: None, continues: None, ..self.header.clone() };
        SessionStart::Again { header: Box::new(header), kitchen: self.engine.session().kitchen.clone(), out }
    }

    fn close(mut self, leaving: LeavingReason) -> Result<LiveOutcome, LiveError> {
        if self.failed.is_none() {
            let session = self.engine.session();
            if !session.is_step_done() && self.capture.is_on && session.tracker.is_recording() {
                // A trial that is continued later needs a new recording of the tracker's program.
                self.input(Event::Tracker(TrackerEvent::Recording { state: TrackerRecording::Ended }));
            }
            self.input(Event::SessionEnded);
            self.flush_log();
            self.check_log(true);
        }
        self.capture.leave(Instant::now());
        if let Some(viewing) = self.viewing.take() {
            viewing.close(&self.log);
        }
        let is_empty = self.failed.is_none() && self.header.continues.is_none() && self.engine.session().is_empty();
        let folder = self.log.folder().to_path_buf();
        if is_empty {
            self.log.discard();
        }
        match self.failed {
            Some(error) => Err(error.into()),
            None => {
                let again = (leaving == LeavingReason::Redo).then(|| self.beginning_again());
                let standing = ExclusionStatus::at_console(self.engine.session());
                let tutorial = TutorialProgress::from_session(self.engine.session());
                let figures = TrialSummary::from_follower(&self.engine.into_follower());
                Ok(LiveOutcome {
                    folder: Some(folder).filter(|_| !is_empty),
                    leaving,
                    figures,
                    tutorial,
                    standing,
                    again,
                })
            }
        }
    }
}
