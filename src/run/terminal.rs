//! The terminal: set up for the console (raw mode), and restored on every way out. Frames are written without blocking.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Once};
use std::time::Duration;

use crossterm::event::{
    DisableBracketedPaste, DisableFocusChange, DisableMouseCapture, EnableBracketedPaste, EnableFocusChange,
    EnableMouseCapture, KeyboardEnhancementFlags, PopKeyboardEnhancementFlags, PushKeyboardEnhancementFlags,
};
use crossterm::style::{Attribute, SetAttribute};
use crossterm::terminal::{
    BeginSynchronizedUpdate, Clear, ClearType, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen,
    disable_raw_mode, enable_raw_mode, size,
};
use crossterm::{cursor, queue};
use ratatui::backend::CrosstermBackend;
use ratatui::{CompletedFrame, Terminal};

use super::ask::ground;
use super::event_loop::{LoopEvent, ShellView};
use super::frames::{FrameWriter, write_within};
use crate::console::view;
use crate::console::view::recordings_page::draw_recordings;
use crate::console::view::sheet::draw_question;
use crate::console::view::theme::{TerminalBackground, Theme};
use tomcom_session::settings::{ColourTheme, ConsoleSpec};

/// Writer of frames; `None` unless the terminal is set up for the console.
static TAKEN: Mutex<Option<Arc<FrameWriter>>> = Mutex::new(None);
/// Whether the terminal did not accept the bytes that restore its modes.
static OUT_OF_REACH: AtomicBool = AtomicBool::new(false);
/// Done when the terminal is first set up for the console; from then on a panic restores the terminal.
static HOOK: Once = Once::new();
/// What a terminal rings for.
const BELL: u8 = 0x07;
/// Time limit for output to the terminal after a session.
const LAST_WORDS: Duration = Duration::from_millis(300);
/// Time limit for the program's end after a termination signal, since a reader of its output may be stuck; closing a
/// recording takes milliseconds.
const ENDING: Duration = Duration::from_millis(1800);

/// The terminal in the modes of the console. Its modes are restored when this value is dropped, and when a thread
/// panics.
#[derive(Debug)]
pub struct TerminalScreen {
    terminal: Terminal<CrosstermBackend<ComposedFrame>>,
    /// Whether the terminal's background is dark or light; dark if the terminal does not tell.
    pub ground: TerminalBackground,
    composed: ComposedFrame,
    frames: Arc<FrameWriter>,
}

/// Bytes of the terminal frame that is being composed.
#[derive(Clone, Debug, Default)]
struct ComposedFrame(Arc<Mutex<Vec<u8>>>);

impl ComposedFrame {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
}

impl Write for ComposedFrame {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl TerminalScreen {
    /// Sets the terminal up for the console: raw mode, alternate screen, key releases if the terminal supports them,
    /// and the mouse.
    ///
    /// # Errors
    /// Standard input or output is not a terminal, or the terminal cannot be controlled.
    pub fn take() -> io::Result<TerminalScreen> {
        if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
            return Err(io::Error::other("the console needs a terminal for its input and output"));
        }
        HOOK.call_once(|| {
            let then = std::panic::take_hook();
            std::panic::set_hook(Box::new(move |panic| {
                // Writing a message to a terminal whose output nobody reads could block.
                if give_back() || !io::stderr().is_terminal() {
                    then(panic);
                }
            }));
        });
        let frames = TerminalScreen::take_writer()?;
        let ground = ground().unwrap_or(TerminalBackground::Dark);
        TerminalScreen::set_up(frames, ground).inspect_err(|_| {
            give_back();
        })
    }

    /// Takes the terminal over, in raw mode.
    fn take_writer() -> io::Result<Arc<FrameWriter>> {
        let frames = FrameWriter::start()?;
        enable_raw_mode()?;
        *TAKEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = Some(frames.clone());
        Ok(frames)
    }

    /// Gives the terminal back as it was, and stops the program until the shell continues it.
    ///
    /// # Errors
    /// The program cannot be stopped.
    pub fn stop_program() -> io::Result<()> {
        give_back();
        stop_this_process()
    }

    /// Sets the terminal up as at first, also if another program changed its modes meanwhile; the next frame is drawn
    /// whole.
    ///
    /// # Errors
    /// The terminal cannot be controlled.
    pub fn set_up_again(&mut self) -> io::Result<()> {
        give_back();
        let again = TerminalScreen::set_up(TerminalScreen::take_writer()?, self.ground)?;
        // The old screen must not give back what the new one has taken.
        std::mem::forget(std::mem::replace(self, again));
        Ok(())
    }

    fn set_up(frames: Arc<FrameWriter>, ground: TerminalBackground) -> io::Result<TerminalScreen> {
        frames.show(way_in()?);
        let composed = ComposedFrame::default();
        let terminal = Terminal::new(CrosstermBackend::new(composed.clone()))?;
        Ok(TerminalScreen { terminal, ground, composed, frames })
    }

    /// Columns and rows of the terminal.
    ///
    /// # Errors
    /// The terminal is closed.
    pub fn size() -> io::Result<(u16, u16)> {
        size()
    }

    /// Whether the terminal has accepted the last frame of the console.
    pub fn is_ready(&self) -> bool {
        self.frames.is_ready()
    }

    /// Whether the terminal was closed, or restored because of a panic.
    pub fn is_lost(&self) -> bool {
        self.frames.is_lost()
    }

    /// Composes a frame, which the writing thread then writes; returns it. While the last frame is being written, nothing is
    /// drawn.
    ///
    /// # Errors
    /// The terminal's size is unknown.
    pub(super) fn draw(&mut self, shown: &ShellView<'_>) -> io::Result<Option<CompletedFrame<'_>>> {
        if !self.is_ready() {
            return Ok(None);
        }
        if matches!(shown, ShellView::Console(_, model) if model.rings) {
            self.composed.write_all(&[BELL])?;
        }
        queue!(self.composed, BeginSynchronizedUpdate)?;
        let drawn = self.terminal.draw(|frame| match *shown {
            ShellView::Console(session, model) => view(session, model, frame),
            ShellView::Question(question, notice, theme) => draw_question(question, notice, theme, frame),
            ShellView::Recordings(picker, theme) => draw_recordings(picker, theme, frame),
        })?;
        queue!(self.composed, EndSynchronizedUpdate)?;
        self.frames.show(self.composed.take());
        Ok(Some(drawn))
    }
}

impl Drop for TerminalScreen {
    fn drop(&mut self) {
        give_back();
    }
}

/// Restores the terminal, once; returns whether the terminal accepted the bytes for that. Waits for less than a second,
/// since a terminal whose output nobody reads must not keep the program from ending.
fn give_back() -> bool {
    let taken = TAKEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take();
    let Some(frames) = taken else { return !OUT_OF_REACH.load(Ordering::Acquire) };
    let took = frames.end(way_out());
    OUT_OF_REACH.store(!took, Ordering::Release);
    // The terminal's modes can be restored even if the terminal accepts no bytes.
    let _ = disable_raw_mode();
    took
}

/// Writes to standard output or standard error. After a session at the console the write has a time limit, since a
/// terminal whose output nobody reads must not keep the program from ending. Nothing is written to a terminal that did
/// not accept the bytes that restore its modes.
///
/// # Errors
/// The write fails.
pub fn print(to_errors: bool, bytes: Vec<u8>) -> io::Result<()> {
    let is_terminal = !to_errors || io::stderr().is_terminal();
    let write = move || match to_errors {
        true => io::stderr().write_all(&bytes),
        false => {
            let mut out = io::stdout().lock();
            out.write_all(&bytes)?;
            out.flush()
        }
    };
    match HOOK.is_completed() {
        true if is_terminal && OUT_OF_REACH.load(Ordering::Acquire) => Ok(()),
        true => write_within(LAST_WORDS, write),
        false => write(),
    }
}

fn way_in() -> io::Result<Vec<u8>> {
    // All keys are requested as escape codes: only then terminals report repeats and releases of letters, too.
    let keys = KeyboardEnhancementFlags::DISAMBIGUATE_ESCAPE_CODES
        | KeyboardEnhancementFlags::REPORT_EVENT_TYPES
        | KeyboardEnhancementFlags::REPORT_ALTERNATE_KEYS
        | KeyboardEnhancementFlags::REPORT_ALL_KEYS_AS_ESCAPE_CODES;
    let mut bytes = Vec::new();
    // A killed program leaves its screen behind, perhaps in the middle of a frame.
    queue!(bytes, EndSynchronizedUpdate, SetAttribute(Attribute::Reset), EnterAlternateScreen, Clear(ClearType::All))?;
    queue!(bytes, cursor::Hide, EnableFocusChange, PushKeyboardEnhancementFlags(keys))?;
    // Pasted text is marked as such, so that its letters are not keys.
    queue!(bytes, EnableMouseCapture, EnableBracketedPaste)?;
    Ok(bytes)
}

fn way_out() -> Vec<u8> {
    let mut bytes = Vec::new();
    // Writing to memory cannot fail.
    let _ = queue!(
        bytes,
        EndSynchronizedUpdate,
        PopKeyboardEnhancementFlags,
        DisableBracketedPaste,
        DisableMouseCapture,
        DisableFocusChange,
        LeaveAlternateScreen,
        cursor::Show
    );
    bytes
}

/// Theme of the console: colours unless `NO_COLOR` is set (no-color.org), for this background unless the settings name
/// another background; Unicode unless the settings ask for ASCII or the locale has another character set.
pub fn theme(console: &ConsoleSpec, ground: TerminalBackground) -> Theme {
    let value = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(value).map(|locale| locale.to_lowercase());
    let is_utf8 = locale.is_none_or(|locale| locale.contains("utf-8") || locale.contains("utf8"));
    let ground = match console.theme {
        ColourTheme::Auto => ground,
        ColourTheme::Dark => TerminalBackground::Dark,
        ColourTheme::Light => TerminalBackground::Light,
    };
    Theme { colour: value("NO_COLOR").is_none(), unicode: is_utf8 && !console.ascii, ground }
}

/// Keeps the program alive if a file grows beyond the size limit (`ulimit -f`): without a handler, the signal SIGXFSZ
/// would kill the program; with a handler, the write fails as on a full disk.
///
/// # Errors
/// Signals cannot be received.
#[cfg(target_os = "linux")]
pub fn outlive_file_limits() -> io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    const SIGXFSZ: i32 = 25;
    // The handler stays installed after its receiver is dropped.
    signal(SignalKind::from_raw(SIGXFSZ)).map(drop)
}

/// Does nothing: on this operating system the signal SIGXFSZ does not exist, or has another number.
#[cfg(not(target_os = "linux"))]
pub fn outlive_file_limits() -> io::Result<()> {
    Ok(())
}

/// Waits for a signal that asks the program to end (terminate, interrupt, hang up). From then on the program has a time
/// limit, after which it is ended with exit code 1, since something waits for a reader of its output.
///
/// # Errors
/// Signals cannot be received.
pub async fn asked_to_end() -> io::Result<()> {
    let (sender, asked) = tokio::sync::oneshot::channel();
    // A separate thread receives the signal even if all other threads are blocked.
    std::thread::Builder::new().name("signals".to_string()).spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let signal = runtime.and_then(|runtime| runtime.block_on(next_signal()));
        let is_asked = signal.is_ok();
        // If the signal's receiver no longer exists, the program is about to end.
        let _ = sender.send(signal);
        if is_asked {
            std::thread::sleep(ENDING);
            std::process::exit(1);
        }
    })?;
    asked.await.unwrap_or_else(|gone| Err(io::Error::other(gone)))
}

#[cfg(unix)]
async fn next_signal() -> io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut terminate = signal(SignalKind::terminate())?;
    let mut interrupt = signal(SignalKind::interrupt())?;
    let mut hang_up = signal(SignalKind::hangup())?;
    tokio::select! {
        _ = terminate.recv() => {}
        _ = interrupt.recv() => {}
        _ = hang_up.recv() => {}
    }
    Ok(())
}

#[cfg(not(unix))]
async fn next_signal() -> io::Result<()> {
    tokio::signal::ctrl_c().await
}

/// Signals by which a shell stops the program and continues it.
#[cfg(unix)]
pub(super) struct JobControl {
    stop: tokio::signal::unix::Signal,
    go_on: tokio::signal::unix::Signal,
}

#[cfg(unix)]
impl JobControl {
    pub fn start() -> io::Result<JobControl> {
        use rustix::process::Signal;
        use tokio::signal::unix::{SignalKind, signal};
        let of = |kind: Signal| signal(SignalKind::from_raw(kind.as_raw()));
        Ok(JobControl { stop: of(Signal::TSTP)?, go_on: of(Signal::CONT)? })
    }

    pub async fn next(&mut self) -> LoopEvent {
        tokio::select! {
            biased;
            _ = self.go_on.recv() => LoopEvent::Continued,
            _ = self.stop.recv() => LoopEvent::Suspend,
        }
    }
}

#[cfg(unix)]
fn stop_this_process() -> io::Result<()> {
    use rustix::process::{Signal, getpid, kill_process};
    Ok(kill_process(getpid(), Signal::STOP)?)
}

/// This operating system has no job control.
#[cfg(not(unix))]
pub(super) struct JobControl;

#[cfg(not(unix))]
impl JobControl {
    pub fn start() -> io::Result<JobControl> {
        Ok(JobControl)
    }

    pub async fn next(&mut self) -> LoopEvent {
        std::future::pending().await
    }
}

#[cfg(not(unix))]
fn stop_this_process() -> io::Result<()> {
    Ok(())
}
