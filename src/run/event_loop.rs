//! The event loop of every console: live session, review, training, and the questions before a recording.
//!
//! It waits for whatever comes next, hands that to the shell as a [`LoopEvent`], and draws. A shell is what a console is
//! about: it says when something of its own is due, takes events, and says what is to be seen.

use std::time::Duration;

use tokio::time::{Instant, Interval, MissedTickBehavior, interval, sleep_until};

use super::desk::{OperatorDesk, PageInput};
use super::error::TerminalError;
use crate::communication::recommendation::Recommendation;
use crate::console::question::QuestionPage;
use crate::console::view::theme::Theme;
use crate::console::{ConsoleMessage, ConsoleModel};
use crate::edge::gaze_input::GazeNews;
use crate::edge::terminal::TerminalScreen;
use crate::session::Session;

/// At most 30 frames a second.
pub(super) const FRAME: Duration = Duration::from_millis(33);
/// The pointer is sampled as a tracker of 60 Hz.
const POINTER: Duration = Duration::from_nanos(16_666_667);
/// The period of [`LoopEvent::FileTick`].
const FILES: Duration = Duration::from_millis(50);
/// The period of [`LoopEvent::WatchTick`].
const WATCH: Duration = Duration::from_millis(250);

/// What can come next. Of several that are there at once, the first one here comes first.
pub(super) enum LoopEvent {
    /// The program is asked to end by a signal, or the terminal is gone.
    EndRequest,
    /// A key, the mouse, the size or the focus of the terminal.
    Terminal(ConsoleMessage),
    /// Something happens in the session by itself.
    EngineDue,
    /// The next target of a gaze check is to be shown, or the last one to be hidden.
    TargetDue,
    /// The participant's page says something.
    Page(PageInput),
    /// The assistant has answered.
    Advice(Recommendation),
    /// The mouse pointer is to be sampled.
    PointerTick,
    /// Files that grow are to be written or read on.
    FileTick,
    /// It is to be looked whether all is still as it should be.
    WatchTick,
    /// A frame is to be drawn.
    FrameDue,
    /// The next sample of a file of gaze is due.
    FileGazeDue,
    /// News of the tracker, in the order in which they came. They are last: a tracker that sends more than can be read
    /// delays itself, and neither robot, log nor screen.
    Gaze(Vec<GazeNews>),
}

/// When a shell wants to be called; none: not at all.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShellDeadlines {
    pub engine: Option<Instant>,
    pub target: Option<Instant>,
    pub file_gaze: Option<Instant>,
    /// The time from the last frame to the next.
    pub frame_after: Duration,
}

impl Default for ShellDeadlines {
    /// Only frames, as many as there may be.
    fn default() -> ShellDeadlines {
        ShellDeadlines { engine: None, target: None, file_gaze: None, frame_after: FRAME }
    }
}

/// What a shell shows.
pub(super) enum ShellView<'a> {
    Console(&'a Session, &'a ConsoleModel),
    /// A question that stands alone.
    Question(&'a QuestionPage, Theme),
}

/// What a console is about.
pub(super) trait ConsoleShell {
    /// How it is left.
    type Outcome;
    type Error: From<TerminalError>;

    /// When it wants to be called; asked before each wait.
    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines::default()
    }

    /// Whether the mouse pointer stands for the gaze.
    fn samples_pointer(&self) -> bool {
        false
    }

    /// The assistant's next answer; never, if nobody asks one.
    async fn advice(&mut self) -> Option<Recommendation> {
        std::future::pending().await
    }

    /// Takes what came; how it is left, if that follows from it.
    fn take(&mut self, event: LoopEvent) -> Result<Option<Self::Outcome>, Self::Error>;

    /// Moves on to now before a frame; whether there is anything to be drawn.
    fn advance(&mut self) -> bool {
        true
    }

    /// Makes up what the frame that is drawn now shows.
    fn prepare(&mut self) {}

    /// What it shows.
    fn view(&self) -> ShellView<'_>;

    /// The frame was handed to the terminal.
    fn drawn(&mut self) {}
}

/// Runs a shell at a desk until it is left; none: the program has to end, or the terminal is gone.
pub(super) async fn run<S: ConsoleShell>(
    shell: &mut S,
    desk: &mut OperatorDesk,
) -> Result<Option<S::Outcome>, S::Error> {
    let mut ticks = LoopTicks::start();
    while !desk.screen.is_lost() {
        match next_event(shell, desk, &mut ticks).await {
            LoopEvent::EndRequest => return Ok(None),
            LoopEvent::FrameDue => {
                ticks.frame = Some(Instant::now());
                draw(shell, &mut desk.screen)?;
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

/// What comes at regular times.
struct LoopTicks {
    pointer: Interval,
    files: Interval,
    watch: Interval,
    /// When the last frame was drawn.
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

/// Waits for what comes next.
async fn next_event<S: ConsoleShell>(shell: &mut S, desk: &mut OperatorDesk, ticks: &mut LoopTicks) -> LoopEvent {
    let (due, with_pointer) = (shell.deadlines(), shell.samples_pointer());
    let frame = ticks.frame.map_or_else(Instant::now, |last| last + due.frame_after);
    tokio::select! {
        biased;
        message = desk.seat.next() => message.map_or(LoopEvent::EndRequest, LoopEvent::Terminal),
        () = until(due.engine) => LoopEvent::EngineDue,
        () = until(due.target) => LoopEvent::TargetDue,
        Some(input) = desk.wall.next() => LoopEvent::Page(input),
        Some(advice) = shell.advice() => LoopEvent::Advice(advice),
        _ = ticks.pointer.tick(), if with_pointer => LoopEvent::PointerTick,
        _ = ticks.files.tick() => LoopEvent::FileTick,
        _ = ticks.watch.tick() => LoopEvent::WatchTick,
        () = sleep_until(frame) => LoopEvent::FrameDue,
        () = until(due.file_gaze) => LoopEvent::FileGazeDue,
        Some(news) = desk.tracker.next() => LoopEvent::Gaze(news),
    }
}

async fn until(due: Option<Instant>) {
    match due {
        Some(due) => sleep_until(due).await,
        None => std::future::pending().await,
    }
}

/// Draws what the shell shows. A terminal that is still busy with the last frame gets a later one.
fn draw<S: ConsoleShell>(shell: &mut S, screen: &mut TerminalScreen) -> Result<(), S::Error> {
    if !shell.advance() || !screen.is_ready() {
        return Ok(());
    }
    shell.prepare();
    let drawn = match shell.view() {
        ShellView::Console(session, model) => screen.draw(session, model),
        ShellView::Question(question, theme) => screen.ask(question, theme),
    };
    drawn.map_err(TerminalError)?;
    shell.drawn();
    Ok(())
}
