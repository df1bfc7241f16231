//! Input from the terminal. A thread reads it, since a read can wait forever, and since only the reader knows how long
//! no byte came: a busy event loop must not cut a sequence of bytes in two.

use tokio::sync::mpsc::{Receiver, channel};

use crate::console::ConsoleMessage;

/// Number of messages that can wait for the console; with more, the terminal's own buffer fills.
const WAITING: usize = 256;

/// Input from the terminal: keys, mouse, pasted text, and changes of its size or focus. Reading ends when this value is
/// dropped.
#[derive(Debug)]
pub struct TerminalInput {
    messages: Receiver<ConsoleMessage>,
    #[cfg(unix)]
    resized: tokio::signal::unix::Signal,
    /// One end of a connection; the reading thread waits at the other end, too, and ends with the connection.
    #[cfg(unix)]
    _alive: std::os::unix::net::UnixStream,
}

impl TerminalInput {
    /// The waiting messages from the terminal.
    pub fn waiting(&mut self) -> Vec<ConsoleMessage> {
        std::iter::from_fn(|| self.messages.try_recv().ok()).collect()
    }
}

#[cfg(unix)]
mod reading {
    use std::io;
    use std::os::fd::{AsFd, OwnedFd};
    use std::os::unix::net::UnixStream;
    use std::time::Instant;

    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::io::{Errno, read};
    use tokio::signal::unix::{SignalKind, signal};
    use tokio::sync::mpsc::Sender;

    use super::{ConsoleMessage, TerminalInput, WAITING, channel};
    use crate::run::terminal::TerminalScreen;
    use crate::run::terminal_bytes::TerminalParser;

    impl TerminalInput {
        /// Begins to read standard input, which is a terminal in raw mode.
        ///
        /// # Errors
        /// The thread cannot be started, or changes of the terminal's size cannot be received.
        pub fn start() -> io::Result<TerminalInput> {
            TerminalInput::from_terminal(io::stdin().as_fd().try_clone_to_owned()?)
        }

        /// Begins to read this terminal, which is in raw mode.
        ///
        /// # Errors
        /// The thread cannot be started, or changes of the terminal's size cannot be received.
        pub fn from_terminal(terminal: OwnedFd) -> io::Result<TerminalInput> {
            let resized = signal(SignalKind::window_change())?;
            let (sender, messages) = channel(WAITING);
            let (alive, ended) = UnixStream::pair()?;
            let read = move || read_all(&terminal, &ended, &sender);
            std::thread::Builder::new().name("terminal input".to_string()).spawn(read)?;
            Ok(TerminalInput { messages, resized, _alive: alive })
        }

        /// The next message from the terminal; `None` when the terminal is closed.
        pub async fn next(&mut self) -> Option<ConsoleMessage> {
            tokio::select! {
                biased;
                Some(()) = self.resized.recv() => {
                    let (columns, rows) = TerminalScreen::size().ok()?;
                    Some(ConsoleMessage::Resized(columns, rows))
                }
                message = self.messages.recv() => message,
            }
        }
    }

    /// Reads the terminal until it is closed or nobody waits for its messages any more.
    fn read_all(terminal: &OwnedFd, ended: &UnixStream, messages: &Sender<ConsoleMessage>) -> Option<()> {
        let mut parser = TerminalParser::default();
        let mut bytes = [0; 4096];
        loop {
            // If bytes are there, the wait returns them also after the deadline: they were not preceded by silence.
            let left = parser.deadline().map(|deadline| deadline.saturating_duration_since(Instant::now()));
            let left = left.and_then(|left| Timespec::try_from(left).ok());
            let mut waits = [PollFd::new(terminal, PollFlags::IN), PollFd::new(ended, PollFlags::IN)];
            match poll(&mut waits, left.as_ref()) {
                Ok(_) | Err(Errno::INTR) => {}
                Err(_) => return None,
            }
            if !waits[1].revents().is_empty() {
                return None;
            }
            let read = match waits[0].revents().is_empty() {
                true => parser.expire(Instant::now()),
                false => match read(terminal, &mut bytes) {
                    Ok(0) => return None,
                    Ok(count) => parser.read(&bytes[..count], Instant::now()),
                    Err(Errno::INTR | Errno::AGAIN) => Vec::new(),
                    Err(_) => return None,
                },
            };
            for message in read {
                messages.blocking_send(message).ok()?;
            }
        }
    }
}

/// On other operating systems the terminal reports events instead of bytes, so no sequence can be incomplete.
#[cfg(not(unix))]
mod reading {
    use std::io;

    use crossterm::event::{Event, MouseButton, MouseEvent, MouseEventKind, read};

    use super::{ConsoleMessage, TerminalInput, WAITING, channel};

    impl TerminalInput {
        /// Begins to read the terminal.
        ///
        /// # Errors
        /// The thread cannot be started.
        pub fn start() -> io::Result<TerminalInput> {
            let (sender, messages) = channel(WAITING);
            let read_all = move || {
                while let Ok(event) = read() {
                    if sender.blocking_send(message(event)).is_err() {
                        break;
                    }
                }
            };
            std::thread::Builder::new().name("terminal input".to_string()).spawn(read_all)?;
            Ok(TerminalInput { messages })
        }

        /// The next message from the terminal; `None` when the terminal is closed.
        pub async fn next(&mut self) -> Option<ConsoleMessage> {
            self.messages.recv().await
        }
    }

    fn message(event: Event) -> ConsoleMessage {
        match event {
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
            Event::Paste(text) => ConsoleMessage::Paste(Some(text)),
        }
    }
}
