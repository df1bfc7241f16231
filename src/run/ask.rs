//! Queries to the terminal about its abilities, and the terminal's answers (escape sequences). Queries and answers are
//! exchanged before anything else reads the keyboard, and answers are read to their end, so that no part of an answer
//! is taken for a key.

use std::time::{Duration, Instant};

use crate::console::view::theme::TerminalBackground;

/// Longest wait for the terminal's answer: terminals answer within milliseconds, over a network within a second.
const PATIENCE: Duration = Duration::from_secs(1);
/// Query that every terminal answers (primary device attributes). The program sends this query last, so that its answer
/// shows that no answer to an earlier query is still to come.
const LAST: &str = "\x1b[c";

/// Writes a query to the terminal, which must be in raw mode, and reads the terminal's answer.
#[cfg(unix)]
pub fn ask(question: &str) -> Option<String> {
    use std::io::{Read, Write};

    use rustix::event::{PollFd, PollFlags, Timespec, poll};

    let mut terminal = std::fs::OpenOptions::new().read(true).write(true).open("/dev/tty").ok()?;
    let until = Instant::now() + PATIENCE;
    // A terminal whose output nobody reads has a full buffer some day: without a time limit, writing to it would block
    // forever.
    let is_in_time = |terminal: &std::fs::File, what: PollFlags| {
        let left = Timespec::try_from(until.saturating_duration_since(Instant::now())).ok()?;
        poll(&mut [PollFd::new(terminal, what)], Some(&left)).ok().filter(|&ready| ready > 0)
    };
    is_in_time(&terminal, PollFlags::OUT)?;
    terminal.write_all(question.as_bytes()).and_then(|()| terminal.write_all(LAST.as_bytes())).ok()?;
    let mut answer = Vec::new();
    while !is_whole(&answer) {
        is_in_time(&terminal, PollFlags::IN)?;
        let mut bytes = [0; 256];
        match terminal.read(&mut bytes).ok()? {
            0 => return None,
            count => answer.extend_from_slice(&bytes[..count]),
        }
    }
    Some(String::from_utf8_lossy(&answer).into_owned())
}

/// On other operating systems, terminals are not queried.
#[cfg(not(unix))]
pub fn ask(_: &str) -> Option<String> {
    None
}

/// Whether the terminal's answer to the query [`LAST`] has arrived: `ESC [ ? … c`.
fn is_whole(answer: &[u8]) -> bool {
    let start = answer.windows(3).rposition(|bytes| bytes == b"\x1b[?");
    start.is_some_and(|start| answer[start..].iter().all(|byte| byte.is_ascii()) && answer.last() == Some(&b'c'))
}

/// Whether the terminal's background is dark or light; `None` if the terminal does not tell its colour (OSC 11).
pub fn ground() -> Option<TerminalBackground> {
    background(&ask("\x1b]11;?\x1b\\")?)
}

/// The background in a terminal's answer to OSC 11: `]11;rgb:RED/GREEN/BLUE`, each of 1 to 4 hexadecimal digits.
pub fn background(answer: &str) -> Option<TerminalBackground> {
    let colour = answer.split("]11;rgb:").nth(1)?;
    let mut parts = colour.split('/').map(|part| {
        let digits: String = part.chars().take_while(char::is_ascii_hexdigit).collect();
        let most = matches!(digits.len(), 1..=4).then(|| 16_u32.pow(digits.len() as u32) - 1)?;
        let value = u32::from_str_radix(&digits, 16).ok()?;
        Some(f64::from(value) / f64::from(most))
    });
    let [red, green, blue] = [parts.next()??, parts.next()??, parts.next()??];
    // Perceived brightness (ITU-R BT.601) of the background's colour values, without gamma correction.
    let brightness = 0.299 * red + 0.587 * green + 0.114 * blue;
    Some(if brightness > 0.5 { TerminalBackground::Light } else { TerminalBackground::Dark })
}
