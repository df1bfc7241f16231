//! Writes frames to the terminal from a separate thread, so that a slow or unread terminal blocks neither the session
//! nor the session's end.

use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use crossterm::terminal::disable_raw_mode;

/// Time limit for writing the last bytes to the terminal, after a frame that is still being written.
const PATIENCE: Duration = Duration::from_millis(600);
/// Time limit for writing the last bytes to the terminal after unread output was discarded.
const LAST_PATIENCE: Duration = Duration::from_millis(300);
/// Size of one write to the terminal, in bytes: less than a pseudoterminal's buffer, so that a blocked write ends after
/// unread output was discarded.
const PIECE: usize = 2048;

/// State that the writing thread shares with the rest of the program.
#[derive(Debug, Default)]
struct Pending {
    frame: Option<Vec<u8>>,
    /// Last bytes for the terminal, which restore its modes.
    last: Option<Vec<u8>>,
    /// Whether the writing thread is writing to the terminal now.
    writing: bool,
    /// Whether the writing thread skips the rest of the present frame, to end sooner.
    hurries: bool,
    /// Whether a write to the terminal failed, since the terminal was closed.
    lost: bool,
    /// Whether the writing thread has ended.
    done: bool,
}

/// Writer of frames to the terminal. The writer holds at most one frame that is not yet being written.
#[derive(Debug)]
pub(super) struct FrameWriter {
    pending: Mutex<Pending>,
    changed: Condvar,
}

impl FrameWriter {
    /// Starts the thread that writes frames to the terminal.
    pub(super) fn start() -> io::Result<Arc<FrameWriter>> {
        let writer = Arc::new(FrameWriter { pending: Mutex::default(), changed: Condvar::new() });
        let own = writer.clone();
        std::thread::Builder::new().name("terminal".to_string()).spawn(move || while own.write_next() {})?;
        Ok(writer)
    }

    fn pending(&self) -> MutexGuard<'_, Pending> {
        self.pending.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Whether the terminal has accepted the last frame of the console.
    pub(super) fn is_ready(&self) -> bool {
        let pending = self.pending();
        pending.frame.is_none() && !pending.writing
    }

    /// Whether the terminal was closed, or its modes were restored.
    pub(super) fn is_lost(&self) -> bool {
        let pending = self.pending();
        pending.lost || pending.done
    }

    /// Passes a frame to the writing thread, which must be ready.
    pub(super) fn show(&self, frame: Vec<u8>) {
        self.pending().frame = Some(frame);
        self.changed.notify_all();
    }

    /// Writes the last bytes after the present frame, and ends the thread; returns whether the terminal accepted the
    /// bytes. Waits for less than a second. If the terminal's buffer is full, its unread content is discarded to make
    /// room.
    pub(super) fn end(&self, last: Vec<u8>) -> bool {
        let mut pending = self.pending();
        pending.last = Some(last);
        self.changed.notify_all();
        pending = self.wait(pending, PATIENCE);
        if !pending.done {
            pending.hurries = true;
            discard_unread();
            // Changing the terminal's modes wakes a blocked write.
            let _ = disable_raw_mode();
            pending = self.wait(pending, LAST_PATIENCE);
        }
        pending.done && !pending.lost
    }

    fn wait<'a>(&self, pending: MutexGuard<'a, Pending>, longest: Duration) -> MutexGuard<'a, Pending> {
        let waited = self.changed.wait_timeout_while(pending, longest, |pending| !pending.done);
        waited.unwrap_or_else(|poisoned| poisoned.into_inner()).0
    }

    /// Writes the next bytes to the terminal; returns whether the thread continues.
    fn write_next(&self) -> bool {
        let waited = self.changed.wait_while(self.pending(), |it| it.frame.is_none() && it.last.is_none());
        let mut pending = waited.unwrap_or_else(|poisoned| poisoned.into_inner());
        let frame = pending.frame.take();
        let is_last = frame.is_none();
        let Some(bytes) = frame.or_else(|| pending.last.take()) else { return true };
        pending.writing = true;
        drop(pending);
        let written = self.write(&bytes, is_last);
        let mut pending = self.pending();
        pending.writing = false;
        pending.lost |= written.is_err();
        pending.done |= is_last;
        self.changed.notify_all();
        !is_last
    }

    fn write(&self, bytes: &[u8], is_last: bool) -> io::Result<()> {
        for piece in bytes.chunks(PIECE) {
            if !is_last && self.pending().hurries {
                break;
            }
            let mut out = io::stdout().lock();
            out.write_all(piece)?;
            out.flush()?;
        }
        Ok(())
    }
}

/// Runs a write on a separate thread, and waits for it until a time limit; a write that takes longer counts as done.
pub(super) fn write_within(
    longest: Duration,
    write: impl FnOnce() -> io::Result<()> + Send + 'static,
) -> io::Result<()> {
    let (sender, written) = std::sync::mpsc::channel();
    std::thread::Builder::new().name("last words".to_string()).spawn(move || sender.send(write()))?;
    written.recv_timeout(longest).unwrap_or(Ok(()))
}

/// Discards output that the terminal has not read.
#[cfg(unix)]
fn discard_unread() {
    use rustix::termios::{QueueSelector, tcflush};
    // A closed terminal has no output to discard.
    let _ = tcflush(io::stdout(), QueueSelector::OFlush);
}

/// Discarding unread terminal output is not available on this operating system.
#[cfg(not(unix))]
fn discard_unread() {}
