//! Bytes on their way to the terminal, written by a thread of their own: a terminal that is slow, or that nobody reads, holds
//! up neither the session nor its end.

use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard};
use std::time::Duration;

use crossterm::terminal::disable_raw_mode;

/// So long the last bytes may take behind a frame that is still being written.
const PATIENCE: Duration = Duration::from_millis(600);
/// So long they may take once what the terminal has not read is thrown away.
const LAST_PATIENCE: Duration = Duration::from_millis(300);
/// Written at once, in bytes; what a pseudoterminal holds is more.
const PIECE: usize = 2048;

/// What the thread and whoever draws share.
#[derive(Debug, Default)]
struct Pending {
    /// What is written next.
    frame: Option<Vec<u8>>,
    /// What is written last.
    last: Option<Vec<u8>>,
    /// Something is being written.
    writing: bool,
    /// What is being written is not worth to be finished.
    hurries: bool,
    /// The terminal is gone.
    lost: bool,
    /// The last bytes were written, or cannot be.
    done: bool,
}

/// The way to the terminal, which has room for one frame.
#[derive(Debug)]
pub(super) struct FrameWriter {
    pending: Mutex<Pending>,
    changed: Condvar,
}

impl FrameWriter {
    /// Starts the thread.
    ///
    /// # Errors
    /// There can be no further thread.
    pub(super) fn start() -> io::Result<Arc<FrameWriter>> {
        let writer = Arc::new(FrameWriter { pending: Mutex::default(), changed: Condvar::new() });
        let own = writer.clone();
        std::thread::Builder::new().name("terminal".to_string()).spawn(move || while own.write_next() {})?;
        Ok(writer)
    }

    fn pending(&self) -> MutexGuard<'_, Pending> {
        self.pending.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Whether the terminal has taken the last frame.
    pub(super) fn is_ready(&self) -> bool {
        let pending = self.pending();
        pending.frame.is_none() && !pending.writing
    }

    /// Whether the terminal is gone, or was given back.
    pub(super) fn is_lost(&self) -> bool {
        let pending = self.pending();
        pending.lost || pending.done
    }

    /// Leaves a frame to the thread, which has none: see [`FrameWriter::is_ready`].
    pub(super) fn show(&self, frame: Vec<u8>) {
        self.pending().frame = Some(frame);
        self.changed.notify_all();
    }

    /// Writes these bytes after the frame that is on its way, and nothing after them; whether the terminal took them. It
    /// waits no longer than a second. A terminal that takes nothing loses what it has not read, so that they fit in.
    pub(super) fn end(&self, last: Vec<u8>) -> bool {
        let mut pending = self.pending();
        pending.last = Some(last);
        self.changed.notify_all();
        pending = self.wait(pending, PATIENCE);
        if !pending.done {
            pending.hurries = true;
            discard_unread();
            // What waits for room in the terminal looks again when its modes change.
            let _ = disable_raw_mode();
            pending = self.wait(pending, LAST_PATIENCE);
        }
        pending.done && !pending.lost
    }

    fn wait<'a>(&self, pending: MutexGuard<'a, Pending>, longest: Duration) -> MutexGuard<'a, Pending> {
        let waited = self.changed.wait_timeout_while(pending, longest, |pending| !pending.done);
        waited.unwrap_or_else(|poisoned| poisoned.into_inner()).0
    }

    /// Writes what comes next; whether more can come.
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

/// Writes something on a thread of its own, and waits for it no longer than this; whether it was written is not known then.
///
/// # Errors
/// It cannot be written.
pub(super) fn write_within(
    longest: Duration,
    write: impl FnOnce() -> io::Result<()> + Send + 'static,
) -> io::Result<()> {
    let (sender, written) = std::sync::mpsc::channel();
    std::thread::Builder::new().name("last words".to_string()).spawn(move || sender.send(write()))?;
    written.recv_timeout(longest).unwrap_or(Ok(()))
}

/// Throws away what the terminal was given and has not read.
#[cfg(unix)]
fn discard_unread() {
    use rustix::termios::{QueueSelector, tcflush};
    // A terminal that is gone has nothing to throw away.
    let _ = tcflush(io::stdout(), QueueSelector::OFlush);
}

/// Other systems keep it.
#[cfg(not(unix))]
fn discard_unread() {}
