//! The participant's button box on a serial line: a line of text for each press, with the name of the button in the layout or
//! its number there (`gamepad`).
//!
//! A thread reads the line, so that a press is stamped when it arrives, and opens it again by itself once a box that was
//! unplugged is back.

use std::collections::VecDeque;
use std::io::{self, ErrorKind};
use std::thread;
use std::time::{Duration, Instant};

use serial2::SerialPort;
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tomcom_core::base::text::printable;
use tomcom_core::kitchen::{Agent, Kitchen};

const BAUD: u32 = 115_200;
/// In bytes; the names of buttons are shorter.
const LONGEST_LINE: usize = 64;
/// Most presses within [`WITHIN`]: hands are slower, and a box that sends more is faulty.
const MOST_PRESSES: usize = 20;
const WITHIN: Duration = Duration::from_secs(1);
/// Least time between two reports of refused lines.
const TOLD_EVERY: Duration = Duration::from_secs(1);
/// Longest wait for a press, after which it is seen whether the session still listens.
const LISTENS: Duration = Duration::from_millis(100);
/// Time between two attempts to open the line.
const REOPENS: Duration = Duration::from_millis(500);
/// Presses that wait for the session.
const WAITING: usize = 64;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ButtonBoxMessage {
    Connected,
    Lost(String),
    /// With the name of the button, and the instant at which its line arrived.
    Press(String, Instant),
    /// Lines that are no presses: how many since the last report, and what is wrong with the first of them.
    Refused(u64, String),
}

/// Opens the serial line, exclusively where the system can do that: what another program reads is lost here.
///
/// # Errors
/// It is not there, this account may not read it, another program has it, or it is no serial line.
pub fn open(path: &str) -> io::Result<SerialPort> {
    let mut port = SerialPort::open(path, BAUD)?;
    #[cfg(unix)]
    rustix::termios::ioctl_tiocexcl(&port)?;
    port.set_read_timeout(LISTENS)?;
    Ok(port)
}

/// Paths of the serial lines of this computer, as far as the system tells.
pub fn lines_here() -> Vec<String> {
    let ports = SerialPort::available_ports().unwrap_or_default();
    ports.into_iter().map(|path| path.display().to_string()).collect()
}

/// Follows a button box with the buttons of this kitchen's human, until nobody receives any more.
pub fn follow(path: &str, kitchen: &Kitchen) -> Receiver<ButtonBoxMessage> {
    let (news, received) = channel(WAITING);
    let (path, mut lines) = (path.to_string(), PressLines::new(kitchen));
    thread::spawn(move || {
        let mut is_told_lost = false;
        loop {
            // `None`: nobody receives any more.
            let reason = match open(&path) {
                Ok(port) => {
                    is_told_lost = false;
                    match listen(&port, &mut lines, &news) {
                        Some(reason) => reason,
                        None => return,
                    }
                }
                Err(reason) => reason,
            };
            if !std::mem::replace(&mut is_told_lost, true) {
                let _ = news.blocking_send(ButtonBoxMessage::Lost(reason.to_string()));
            }
            thread::sleep(REOPENS);
            if news.is_closed() {
                return;
            }
        }
    });
    received
}

/// Reads presses until the line is lost, and returns why; `None` if nobody receives any more.
fn listen(port: &SerialPort, lines: &mut PressLines, news: &Sender<ButtonBoxMessage>) -> Option<io::Error> {
    news.blocking_send(ButtonBoxMessage::Connected).ok()?;
    lines.begin();
    let mut bytes = [0; 256];
    while !news.is_closed() {
        let read = match port.read(&mut bytes) {
            Ok(0) => return Some(io::Error::new(ErrorKind::UnexpectedEof, "the line has ended")),
            Ok(read) => read,
            // Another program that reads the same line can have taken what was there.
            Err(error)
                if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::Interrupted | ErrorKind::WouldBlock) =>
            {
                0
            }
            Err(error) => return Some(error),
        };
        for message in lines.take(&bytes[..read], Instant::now()) {
            news.blocking_send(message).ok()?;
        }
    }
    None
}

/// Finds the presses in the bytes of a button box.
#[derive(Debug)]
pub struct PressLines {
    /// Names of the buttons, with their numbers.
    buttons: Vec<(String, Option<u8>)>,
    line: Vec<u8>,
    /// Arrivals of the last presses, oldest first.
    presses: VecDeque<Instant>,
    /// Refused lines that are not told yet, with what is wrong with the first.
    refused: (u64, String),
    told: Option<Instant>,
}

impl PressLines {
    pub fn new(kitchen: &Kitchen) -> PressLines {
        let buttons = &kitchen.buttons[Agent::Human.index()];
        PressLines {
            buttons: buttons.iter().map(|button| (button.name.clone(), button.gamepad)).collect(),
            line: Vec::new(),
            presses: VecDeque::new(),
            refused: (0, String::new()),
            told: None,
        }
    }

    /// Forgets a line that was begun: the box was connected anew.
    fn begin(&mut self) {
        self.line.clear();
    }

    /// What these bytes bring, which arrived at this instant; also without bytes, refused lines can be due to be told.
    pub fn take(&mut self, bytes: &[u8], at: Instant) -> Vec<ButtonBoxMessage> {
        let mut messages = Vec::new();
        for &byte in bytes {
            match byte {
                b'\n' | b'\r' => messages.extend(self.end_line(at)),
                // One byte more than the longest line tells that the line is too long.
                byte if self.line.len() <= LONGEST_LINE => self.line.push(byte),
                _ => {}
            }
        }
        if self.refused.0 > 0 && self.told.is_none_or(|told| at.saturating_duration_since(told) >= TOLD_EVERY) {
            self.told = Some(at);
            let (lines, found) = std::mem::take(&mut self.refused);
            messages.push(ButtonBoxMessage::Refused(lines, found));
        }
        messages
    }

    /// The press of the line that ends now; a blank line is none.
    fn end_line(&mut self, at: Instant) -> Option<ButtonBoxMessage> {
        let line = std::mem::take(&mut self.line);
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        if text.is_empty() {
            return None;
        }
        self.presses.retain(|press| at.saturating_duration_since(*press) < WITHIN);
        let fault = match self.button(text) {
            _ if line.len() > LONGEST_LINE => format!("a line of more than {LONGEST_LINE} bytes"),
            None => format!("\"{}\", which is no button of the layout", printable(text)),
            Some(_) if self.presses.len() >= MOST_PRESSES => {
                format!("more than {MOST_PRESSES} presses within a second")
            }
            Some(button) => {
                self.presses.push_back(at);
                return Some(ButtonBoxMessage::Press(button, at));
            }
        };
        if self.refused.0 == 0 {
            self.refused.1 = fault;
        }
        self.refused.0 += 1;
        None
    }

    fn button(&self, text: &str) -> Option<String> {
        let number = text.parse().ok();
        let named = self.buttons.iter().find(|(name, _)| name == text);
        let numbered = || self.buttons.iter().find(|(_, own)| number.is_some() && *own == number);
        named.or_else(numbered).map(|(name, _)| name.clone())
    }
}
