//! The terminal: taken over for the console, given back whole on every way out, its keys and mouse as messages, and
//! frames written by a thread of its own, so that nothing waits for a slow terminal.

use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, Once, TryLockError};
use std::time::Duration;

use crossterm::event::{
    DisableFocusChange, DisableMouseCapture, EnableFocusChange, EnableMouseCapture, Event, EventStream,
    KeyboardEnhancementFlags, MouseButton, MouseEvent, MouseEventKind, PopKeyboardEnhancementFlags,
    PushKeyboardEnhancementFlags,
};
use crossterm::terminal::{
    BeginSynchronizedUpdate, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen, disable_raw_mode,
    enable_raw_mode, size,
};
use crossterm::{cursor, execute, queue};
use futures::StreamExt;
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;

use super::ask::ground;
use crate::console::question::QuestionPage;
use crate::console::view::sheet::draw_question;
use crate::console::view::theme::{TerminalBackground, Theme};
use crate::console::{ConsoleMessage, ConsoleModel, view};
use crate::session::Session;
use crate::session::settings::{ConsoleSpec, ThemeChoice};

/// Whether the terminal is ours now; held while something is written to it.
static TAKEN: Mutex<bool> = Mutex::new(false);
static HOOK: Once = Once::new();

/// The console's terminal. It is given back when this is dropped, and when anything panics.
#[derive(Debug)]
pub struct TerminalScreen {
    terminal: Terminal<CrosstermBackend<Frame>>,
    /// The terminal's background; dark, if it does not say.
    pub ground: TerminalBackground,
    composed: Frame,
    frames: SyncSender<Vec<u8>>,
    /// The last frame is still being written.
    busy: Arc<AtomicBool>,
    /// The terminal is gone.
    lost: Arc<AtomicBool>,
}

/// The bytes of the frame that is being composed.
#[derive(Clone, Debug, Default)]
struct Frame(Arc<Mutex<Vec<u8>>>);

impl Frame {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()))
    }
}

impl Write for Frame {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl TerminalScreen {
    /// Takes the terminal over: raw mode, alternate screen, key releases where the terminal knows them, and the mouse.
    ///
    /// # Errors
    /// Standard input or output is no terminal, or it cannot be controlled.
    pub fn take() -> io::Result<TerminalScreen> {
        if !io::stdin().is_terminal() || !io::stdout().is_terminal() {
            return Err(io::Error::other("the console needs a terminal for its input and output"));
        }
        HOOK.call_once(|| {
            let then = std::panic::take_hook();
            std::panic::set_hook(Box::new(move |panic| {
                give_back();
                then(panic);
            }));
        });
        enable_raw_mode()?;
        *TAKEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = true;
        let ground = ground().unwrap_or(TerminalBackground::Dark);
        let mut out = io::stdout();
        // All keys as escape codes: only then terminals report repeats and releases of letters, too.
        let keys = KeyboardEnhancementFlags::DISAMBIGUATE_ESCAPE_CODES
            | KeyboardEnhancementFlags::REPORT_EVENT_TYPES
            | KeyboardEnhancementFlags::REPORT_ALTERNATE_KEYS
            | KeyboardEnhancementFlags::REPORT_ALL_KEYS_AS_ESCAPE_CODES;
        execute!(out, EnterAlternateScreen, cursor::Hide, EnableFocusChange, PushKeyboardEnhancementFlags(keys))?;
        execute!(out, EnableMouseCapture)?;
        let (busy, lost) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
        let frames = write_frames(busy.clone(), lost.clone());
        let composed = Frame::default();
        let terminal = Terminal::new(CrosstermBackend::new(composed.clone()))?;
        Ok(TerminalScreen { terminal, ground, composed, frames, busy, lost })
    }

    /// Columns and rows of the terminal.
    ///
    /// # Errors
    /// The terminal is gone.
    pub fn size() -> io::Result<(u16, u16)> {
        size()
    }

    /// Whether the terminal has taken the last frame.
    pub fn is_ready(&self) -> bool {
        !self.busy.load(Ordering::Acquire)
    }

    /// Whether the terminal is gone.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Acquire)
    }

    /// Composes a frame and leaves the writing to the thread. Nothing is drawn while the last frame is on its way.
    ///
    /// # Errors
    /// The terminal's size cannot be found out.
    pub fn draw(&mut self, session: &Session, model: &ConsoleModel) -> io::Result<()> {
        self.compose(|frame| view(session, model, frame))
    }

    /// Composes a question that stands alone.
    ///
    /// # Errors
    /// The terminal's size cannot be found out.
    pub fn ask(&mut self, question: &QuestionPage, theme: Theme) -> io::Result<()> {
        self.compose(|frame| draw_question(question, theme, frame))
    }

    fn compose(&mut self, draw: impl FnOnce(&mut ratatui::Frame)) -> io::Result<()> {
        if !self.is_ready() {
            return Ok(());
        }
        queue!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        self.terminal.draw(draw)?;
        queue!(self.terminal.backend_mut(), EndSynchronizedUpdate)?;
        self.busy.store(true, Ordering::Release);
        if self.frames.try_send(self.composed.take()).is_err() {
            self.lost.store(true, Ordering::Release);
        }
        Ok(())
    }
}

impl Drop for TerminalScreen {
    fn drop(&mut self) {
        give_back();
    }
}

/// The thread that writes frames while the terminal is ours.
fn write_frames(busy: Arc<AtomicBool>, lost: Arc<AtomicBool>) -> SyncSender<Vec<u8>> {
    let (sender, receiver) = sync_channel::<Vec<u8>>(1);
    std::thread::spawn(move || {
        while let Ok(bytes) = receiver.recv() {
            let taken = TAKEN.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            if *taken {
                let mut out = io::stdout().lock();
                if out.write_all(&bytes).and_then(|()| out.flush()).is_err() {
                    lost.store(true, Ordering::Release);
                }
            }
            drop(taken);
            busy.store(false, Ordering::Release);
        }
    });
    sender
}

/// Gives the terminal back as it was; does nothing if that was done already. It never waits long: a terminal that takes
/// no bytes must not keep the program from ending.
fn give_back() {
    for _ in 0..20 {
        match TAKEN.try_lock() {
            Ok(mut taken) => {
                if std::mem::replace(&mut *taken, false) {
                    write_way_out();
                }
                return;
            }
            Err(TryLockError::Poisoned(poisoned)) => {
                *poisoned.into_inner() = false;
                return write_way_out();
            }
            Err(TryLockError::WouldBlock) => std::thread::sleep(Duration::from_millis(5)),
        }
    }
    write_way_out();
}

fn write_way_out() {
    let mut out = io::stdout();
    // What cannot be written to a terminal that is gone need not be.
    let _ = execute!(
        out,
        EndSynchronizedUpdate,
        PopKeyboardEnhancementFlags,
        DisableMouseCapture,
        DisableFocusChange,
        LeaveAlternateScreen,
        cursor::Show
    );
    let _ = disable_raw_mode();
}

/// What somebody does at the terminal.
#[derive(Debug, Default)]
pub struct TerminalInput {
    events: EventStream,
}

impl TerminalInput {
    /// The next message; `None` when the terminal is gone.
    pub async fn next(&mut self) -> Option<ConsoleMessage> {
        loop {
            let message = match self.events.next().await?.ok()? {
                Event::Key(key) => ConsoleMessage::Key(key),
                Event::Mouse(MouseEvent { kind, column, row, .. }) => match kind {
                    MouseEventKind::Down(MouseButton::Left) => ConsoleMessage::Click(column, row),
                    MouseEventKind::ScrollUp => ConsoleMessage::Wheel(column, row, 1),
                    MouseEventKind::ScrollDown => ConsoleMessage::Wheel(column, row, -1),
                    _ => ConsoleMessage::Pointer(column, row),
                },
                Event::Resize(columns, rows) => ConsoleMessage::Resized(columns, rows),
                Event::FocusGained => ConsoleMessage::Focus(true),
                Event::FocusLost => ConsoleMessage::Focus(false),
                Event::Paste(_) => continue,
            };
            return Some(message);
        }
    }
}

/// Colours unless `NO_COLOR` is set (no-color.org), for this background unless the settings say another; Unicode unless
/// the settings ask for ASCII signs or the locale is one of another character set.
pub fn theme(console: &ConsoleSpec, ground: TerminalBackground) -> Theme {
    let value = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
    let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(value).map(|locale| locale.to_lowercase());
    let is_utf8 = locale.is_none_or(|locale| locale.contains("utf-8") || locale.contains("utf8"));
    let ground = match console.theme {
        ThemeChoice::Auto => ground,
        ThemeChoice::Dark => TerminalBackground::Dark,
        ThemeChoice::Light => TerminalBackground::Light,
    };
    Theme { colour: value("NO_COLOR").is_none(), unicode: is_utf8 && !console.ascii, ground }
}

/// A file that grows beyond the limit for files (`ulimit -f`) kills the program by a signal, unless somebody receives it:
/// then the write fails, as on a full disk.
///
/// # Errors
/// Signals cannot be received.
#[cfg(target_os = "linux")]
pub fn outlive_file_limits() -> io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    const SIGXFSZ: i32 = 25;
    // The handler stays after what receives from it is gone.
    signal(SignalKind::from_raw(SIGXFSZ)).map(drop)
}

/// No such signal, or another number.
#[cfg(not(target_os = "linux"))]
pub fn outlive_file_limits() -> io::Result<()> {
    Ok(())
}

/// Waits until the program is asked to end by a signal (terminate, interrupt, hang up).
///
/// # Errors
/// Signals cannot be received.
#[cfg(unix)]
pub async fn asked_to_end() -> io::Result<()> {
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

/// Waits until the program is asked to end.
///
/// # Errors
/// Signals cannot be received.
#[cfg(not(unix))]
pub async fn asked_to_end() -> io::Result<()> {
    tokio::signal::ctrl_c().await
}
