//! The event loop of every console: live session, review, training, and the questions before a recording.
//!
//! The loop waits for the next event, passes the event to the shell as a [`LoopEvent`], and draws. A shell is one kind
//! of console: it says when it has to act next (deadlines), handles events, and provides what is drawn.

use std::time::Duration;

use tokio::time::{Instant, Interval, MissedTickBehavior, interval, sleep_until};

use super::assistant_link::AssistantNews;
use super::error::TerminalError;
use super::operator_station::{ArmNews, OperatorStation, PageInput, Remark};
use crate::console::lists::{RecordingPicker, StartPrompt};
use crate::console::view::theme::Theme;
use crate::console::{ConsoleMessage, ConsoleModel};
use crate::run::terminal::TerminalScreen;
use tomcom_devices::button_box::ButtonBoxMessage;
use tomcom_devices::gaze_input::TrackerMessage;
use tomcom_session::Session;

/// Least time between two frames of the console (30 frames per second).
pub(super) const FRAME: Duration = Duration::from_millis(33);
/// Sampling period of the mouse pointer when its position stands for gaze (60 Hz).
const POINTER: Duration = Duration::from_nanos(16_666_667);
/// Period of [`LoopEvent::FileTick`], at which files are read and flushed.
const FILES: Duration = Duration::from_millis(50);
/// Period of [`LoopEvent::WatchTick`], at which recording and devices are checked.
const WATCH: Duration = Duration::from_millis(250);

/// An event of the console's event loop. Of several pending events, the event whose variant comes first is handled
/// first.
pub(super) enum LoopEvent {
    /// The program has to end: a termination signal arrived, or the terminal was closed.
    EndRequest,
    /// The shell stops the program (kill -TSTP): the terminal is about to be given back.
    Suspend,
    /// The program was continued after it had been stopped: another one may have used the terminal.
    Continued,
    /// An input from the terminal: key, mouse, pasted text, new size or focus.
    Terminal(ConsoleMessage),
    EngineDue,
    TargetDue,
    Page(PageInput),
    Arm(ArmNews),
    ButtonBox(ButtonBoxMessage),
    Advice(AssistantNews),
    /// An observer's remark. A shell that records nothing drops it, which tells the observer so.
    Remark(Remark),
    PointerTick,
    /// Files that other programs or this one extend are due to be read or flushed.
    FileTick,
    /// The state of recording and devices is due to be checked.
    WatchTick,
    FrameDue,
    FileGazeDue,
    /// Messages of the eye tracker, in order of arrival. This variant is last, so that a tracker that sends too much
    /// delays only itself.
    Gaze(Vec<TrackerMessage>),
}

/// Times at which a console's shell has to act next; `None` for no deadline.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShellDeadlines {
    pub engine: Option<Instant>,
    pub target: Option<Instant>,
    pub file_gaze: Option<Instant>,
    /// Longest time from the last drawn frame to the next.
    pub frame_after: Duration,
}

impl Default for ShellDeadlines {
    /// No deadlines except for frames, which are drawn at the highest rate.
    fn default() -> ShellDeadlines {
        ShellDeadlines { engine: None, target: None, file_gaze: None, frame_after: FRAME }
    }
}

/// Content that a console's shell wants to be shown.
pub(super) enum ShellView<'a> {
    Console(&'a Session, &'a ConsoleModel),
    /// A question to the wizard before a recording, with a notice below it.
    Question(&'a StartPrompt, Option<&'static str>, Theme),
    /// A list of recordings to choose from.
    Recordings(&'a RecordingPicker, Theme),
}

/// One kind of console in the event loop: live session, review, training, question, or list of recordings.
pub(super) trait ConsoleShell {
    /// Result of the shell when the wizard leaves it.
    type Outcome;
    type Error: From<TerminalError>;

    /// Deadlines of the shell; the event loop calls this before each wait.
    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines::default()
    }

    /// Whether the position of the mouse pointer serves as gaze.
    fn samples_pointer(&self) -> bool {
        false
    }

    /// Waits for whoever advises; waits forever without an assistant.
    async fn advice(&mut self) -> Option<AssistantNews> {
        std::future::pending().await
    }

    /// Handles an event of the loop; returns the shell's result if the event leaves the shell.
    fn take(&mut self, event: LoopEvent) -> Result<Option<Self::Outcome>, Self::Error>;

    /// Advances the shell to the present time before a frame; returns whether a frame is needed.
    fn advance(&mut self) -> bool {
        true
    }

    /// Prepares the frame that is drawn next.
    fn prepare(&mut self) {}

    /// The content that the shell wants to be shown.
    fn view(&self) -> ShellView<'_>;

    fn drawn(&mut self) {}
}

/// Runs a shell in the event loop until the wizard leaves it; `None` if the program has to end or the terminal was
/// closed.
pub(super) async fn run<S: ConsoleShell>(
    shell: &mut S,
    station: &mut OperatorStation,
) -> Result<Option<S::Outcome>, S::Error> {
    let mut ticks = LoopTicks::start();
    station.observers.refuse_waiting();
    for message in station.input.forget_keys() {
        shell.take(LoopEvent::Terminal(message))?;
    }
    while !station.screen.is_lost() {
        match next_event(shell, station, &mut ticks).await {
            LoopEvent::EndRequest => return Ok(None),
            event @ (LoopEvent::Suspend | LoopEvent::Continued) => {
                let stops = matches!(event, LoopEvent::Suspend);
                shell.take(event)?;
                station.set_up_again(stops).await?;
                // The terminal can have another size by now; a frame is drawn in any case.
                let (columns, rows) = TerminalScreen::size().map_err(TerminalError)?;
                shell.take(LoopEvent::Terminal(ConsoleMessage::Resized(columns, rows)))?;
                ticks.frame = None;
            }
            LoopEvent::FrameDue => {
                ticks.frame = Some(Instant::now());
                draw(shell, station)?;
            }
            event => {
                if let Some(outcome) = shell.take(event)? {
                    return Ok(Some(outcome));
                }
            }
        }
    }
    Ok(None)
}

/// Runs a future in a tokio runtime, which termination signals and sockets need.
pub(super) fn in_runtime<T, E: From<TerminalError>>(work: impl Future<Output = Result<T, E>>) -> Result<T, E> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(TerminalError)?;
    runtime.block_on(work)
}

/// Deadlines of the event loop's periodic events.
struct LoopTicks {
    pointer: Interval,
    files: Interval,
    watch: Interval,
    /// Time at which the last frame was drawn.
    frame: Option<Instant>,
}

impl LoopTicks {
    fn start() -> LoopTicks {
        let every = |period: Duration| {
            let mut ticks = interval(period);
            ticks.set_missed_tick_behavior(MissedTickBehavior::Skip);
            ticks
        };
        LoopTicks { pointer: every(POINTER), files: every(FILES), watch: every(WATCH), frame: None }
    }
}

async fn next_event<S: ConsoleShell>(shell: &mut S, station: &mut OperatorStation, ticks: &mut LoopTicks) -> LoopEvent {
    let (due, with_pointer) = (shell.deadlines(), shell.samples_pointer());
    let frame = ticks.frame.map_or_else(Instant::now, |last| last + due.frame_after);
    tokio::select! {
        biased;
        event = station.input.next() => event,
        () = or_never(due.engine.map(sleep_until)) => LoopEvent::EngineDue,
        () = or_never(due.target.map(sleep_until)) => LoopEvent::TargetDue,
        Some(input) = station.display.next() => LoopEvent::Page(input),
        Some(news) = station.arm.next() => LoopEvent::Arm(news),
        Some(message) = station.button_box.next() => LoopEvent::ButtonBox(message),
        Some(advice) = shell.advice() => LoopEvent::Advice(advice),
        Some(remark) = station.observers.next() => LoopEvent::Remark(remark),
        _ = ticks.pointer.tick(), if with_pointer => LoopEvent::PointerTick,
        _ = ticks.files.tick() => LoopEvent::FileTick,
        _ = ticks.watch.tick() => LoopEvent::WatchTick,
        () = sleep_until(frame) => LoopEvent::FrameDue,
        () = or_never(due.file_gaze.map(sleep_until)) => LoopEvent::FileGazeDue,
        Some(news) = station.tracker.next() => LoopEvent::Gaze(news),
    }
}

/// Waits for this; waits forever if there is nothing to wait for.
pub(super) async fn or_never<T>(next: Option<impl Future<Output = T>>) -> T {
    match next {
        Some(next) => next.await,
        None => std::future::pending().await,
    }
}

/// Draws the shell's content, unless the terminal is still busy with the last frame.
fn draw<S: ConsoleShell>(shell: &mut S, station: &mut OperatorStation) -> Result<(), S::Error> {
    if !shell.advance() || !station.screen.is_ready() {
        return Ok(());
    }
    shell.prepare();
    station.draw(&shell.view())?;
    shell.drawn();
    Ok(())
}
