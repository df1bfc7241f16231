//! A live session: real time, a wizard at the console, every event recorded as it happens.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::mpsc::Receiver;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep_until};

use super::engine::Engine;
use super::figures::TrialFigures;
use super::options::OperateOptions;
use crate::base::time::SessionTime;
use crate::console::model::{Level, Recording};
use crate::console::{Command, Keys, Message, Model, update};
use crate::edge::clock::WallTime;
use crate::edge::gaze_json::{self, GazeLine};
use crate::edge::log::{LogWriter, WriteError};
use crate::edge::terminal::{Hands, Screen, asked_to_end, theme};
use crate::gaze::GazeSample;
use crate::kitchen::cost_to_go::CostToGo;
use crate::session::settings::GazeSource;
use crate::session::{Event, Header, Stamped};

/// At most 30 frames a second.
const FRAME: Duration = Duration::from_millis(33);
/// Clocks, bars and ages move on so often while the trial runs, and while it does not.
const RUNNING: Duration = Duration::from_millis(100);
const RESTING: Duration = Duration::from_millis(250);
/// The pointer is sampled as a tracker of 60 Hz.
const POINTER: Duration = Duration::from_nanos(16_666_667);
/// Gaze that waits is handed to the operating system so often.
const FLUSH: Duration = Duration::from_millis(50);

/// Why a live session could not be run, or not to its end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LiveError {
    #[error("the console cannot be opened: {0}")]
    #[diagnostic(help("run it in a terminal, not through a pipe"))]
    Terminal(io::Error),
    #[error("{0}")]
    #[diagnostic(help("a letter for every signal and button in the layout, each once"))]
    Keys(#[from] crate::console::keys::Clash),
    #[error("nothing can listen on port {port} of localhost for gaze: {reason}")]
    #[diagnostic(help("another port as gaze_port in the session file"))]
    Gaze { port: u16, reason: io::Error },
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] WriteError),
}

/// What came of a live session.
#[derive(Clone, Debug)]
pub struct LiveEnd {
    /// The folder of the recording.
    pub folder: PathBuf,
    pub figures: TrialFigures,
}

impl LiveEnd {
    /// What came of it, for people.
    pub fn describe(&self) -> String {
        let folder = self.folder.display();
        let (presses, served) = (self.figures.human_actions + self.figures.robot_actions, self.figures.served.len());
        let signals = self.figures.signals;
        format!(
            "{presses} presses, {signals} signals, {served} orders served\nrecorded in {folder}\n\
             look at it again: tomcom replay {folder}"
        )
    }
}

/// Runs a session at the console until the wizard quits.
///
/// # Errors
/// There is no terminal, the session cannot be recorded, or the gaze input cannot be opened.
pub fn operate(options: OperateOptions) -> Result<LiveEnd, LiveError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(LiveError::Terminal)?;
    runtime.block_on(Live::open(options)?.run())
}

struct Live {
    engine: Engine,
    model: Model,
    log: LogWriter,
    /// The log cannot be written any more.
    failed: Option<WriteError>,
    screen: Screen,
    began: Instant,
    /// How many judged presses the model knows.
    judged: usize,
    /// Something changed since the last frame.
    dirty: bool,
}

impl Live {
    fn open(options: OperateOptions) -> Result<Live, LiveError> {
        let files = options.files;
        let kitchen = Arc::new(files.kitchen.kitchen);
        let keys = Keys::live(&kitchen, &files.spec)?;
        let mut header = Header::new(files.spec.clone(), 0, files.kitchen.layout, files.kitchen.recipes);
        let wall = WallTime::now();
        header.started = Some(wall.rfc3339());
        let with_mouse = files.spec.participant.gaze == GazeSource::Mouse;
        let screen = Screen::take(with_mouse).map_err(LiveError::Terminal)?;
        let log = LogWriter::create_live(&options.out, &wall.date(), &header)?;
        let cost = CostToGo::new(kitchen.clone());
        let size = Screen::size().map_err(LiveError::Terminal)?;
        let mut model = Model::new(keys, theme(files.spec.console.ascii), size);
        model.recording = Recording::On(log.folder().display().to_string());
        let engine = Engine::new(kitchen, files.spec, 0, cost);
        Ok(Live { engine, model, log, failed: None, screen, began: Instant::now(), judged: 0, dirty: true })
    }

    async fn run(mut self) -> Result<LiveEnd, LiveError> {
        let participant = self.engine.session().spec.participant.clone();
        let mut gaze = match participant.gaze {
            GazeSource::Json => {
                let port = participant.gaze_port;
                Some(gaze_json::listen(port).await.map_err(|reason| LiveError::Gaze { port, reason })?)
            }
            _ => None,
        };
        let with_pointer = participant.gaze == GazeSource::Mouse;
        self.began = Instant::now();
        let mut hands = Hands::default();
        let end = asked_to_end();
        tokio::pin!(end);
        let mut pointer = interval(POINTER);
        pointer.set_missed_tick_behavior(MissedTickBehavior::Skip);
        let mut flush = interval(FLUSH);
        let mut next_frame = Instant::now();
        let mut next_move = Instant::now();
        while !self.screen.is_lost() {
            let due = self.engine.next_due().map(|due| self.began + Duration::from_nanos(due.0));
            tokio::select! {
                biased;
                _ = &mut end => break,
                message = hands.next() => match message {
                    Some(message) => if self.take(message) { break },
                    None => break,
                },
                () = sleep_until(due.unwrap_or(self.began)), if due.is_some() => {
                    let events = self.engine.fire();
                    self.record(&events);
                }
                Some(line) = receive(&mut gaze) => self.gaze(line),
                _ = pointer.tick(), if with_pointer => self.look(),
                _ = flush.tick() => self.flush(),
                () = sleep_until(next_frame.max(next_move)), if !self.dirty => self.dirty = true,
                () = sleep_until(next_frame), if self.dirty => {
                    next_frame = Instant::now() + FRAME;
                    next_move = Instant::now() + if self.engine.session().is_running() { RUNNING } else { RESTING };
                    self.draw().map_err(LiveError::Terminal)?;
                }
            }
        }
        self.close()
    }

    fn now(&self) -> SessionTime {
        SessionTime(self.began.elapsed().as_nanos() as u64)
    }

    /// Tells the model what time it is.
    fn tick(&mut self) {
        self.model.now = self.now();
        self.model.clock = self.model.now;
    }

    /// Takes a message of the terminal; whether the wizard has quit.
    fn take(&mut self, message: Message) -> bool {
        self.tick();
        self.dirty |= !matches!(message, Message::Pointer(..));
        match update(&mut self.model, self.engine.session(), message) {
            Some(Command::Input(event)) => self.input(event),
            Some(Command::Quit) => return true,
            Some(Command::Move(_)) | None => {}
        }
        false
    }

    fn input(&mut self, event: Event) {
        let is_gaze = matches!(event, Event::Gaze(_));
        let outcome = self.engine.input(self.now(), event);
        self.record(&outcome.events);
        if let Some(reason) = outcome.refused.filter(|_| !is_gaze) {
            update(&mut self.model, self.engine.session(), Message::Refused(reason));
        }
    }

    /// Writes events to the log; the session ends where that fails, since what is not recorded did not happen.
    fn record(&mut self, events: &[Stamped]) {
        self.dirty = true;
        for stamped in events {
            if let Event::Gaze(sample) = stamped.event {
                self.model.see(stamped.time, sample);
            }
            if self.failed.is_none()
                && let Err(error) = self.log.append(stamped)
            {
                self.fail(error);
            }
        }
        let judged = self.engine.judged();
        let new = judged[self.judged..].iter().filter(|press| press.verdict.error).map(|press| press.time);
        self.model.errors.extend(new);
        self.judged = judged.len();
    }

    fn flush(&mut self) {
        if self.failed.is_none()
            && let Err(error) = self.log.flush()
        {
            self.fail(error);
        }
    }

    /// The log cannot be written: alarm, stop the robot, end the session. The console stays until the wizard leaves.
    fn fail(&mut self, error: WriteError) {
        self.model.recording = Recording::Lost(error.reason.to_string());
        self.model.say(Level::Alarm, "the recording cannot be written: the session is over");
        self.failed = Some(error);
        self.dirty = true;
        for event in [Event::RobotStopped, Event::SessionEnded] {
            // Nothing of it can be recorded; a robot that is stopped already stays so.
            let _ = self.engine.input(self.now(), event);
        }
    }

    fn gaze(&mut self, line: GazeLine) {
        match line {
            GazeLine::Sample(sample) => self.input(Event::Gaze(sample)),
            GazeLine::Malformed => self.model.malformed += 1,
        }
    }

    /// The pointer as a gaze sample; nobody has moved it yet: no sample.
    fn look(&mut self) {
        if let Some([x, y]) = self.model.pointer {
            self.input(Event::Gaze(GazeSample { x, y, confidence: 1.0, device_ns: None }));
        }
    }

    fn draw(&mut self) -> io::Result<()> {
        self.tick();
        // A terminal that is still busy with the last frame gets this one later.
        self.dirty = !self.screen.is_ready();
        self.screen.draw(self.engine.session(), &self.model)
    }

    fn close(mut self) -> Result<LiveEnd, LiveError> {
        if self.failed.is_none() {
            self.input(Event::SessionEnded);
            self.flush();
        }
        let folder = self.log.folder().to_path_buf();
        drop(self.screen);
        match self.failed {
            Some(error) => Err(error.into()),
            None => Ok(LiveEnd { folder, figures: TrialFigures::of(&self.engine.into_follower()) }),
        }
    }
}

/// The next line of the gaze input; never, if there is none.
async fn receive(gaze: &mut Option<Receiver<GazeLine>>) -> Option<GazeLine> {
    match gaze {
        Some(lines) => lines.recv().await,
        None => std::future::pending().await,
    }
}
