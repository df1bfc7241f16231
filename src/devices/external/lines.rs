//! Lines out and in, each on a thread of its own with a bounded queue.

use std::fmt;
use std::io::{BufRead, BufReader, Read, Write};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::Duration;

use tomcom_session::external::{LONGEST_LINE, MindNews, MindReader, MindWriter};

/// Number of lines that wait to be read by the program, or to be taken from it.
const QUEUE: usize = 64;
/// Tells the program that the trial is over.
const END: &str = "{\"ask\":\"end\"}";

/// Lines on their way to a program. Dropping it says that the trial is over, closes the way, and ends the program.
pub(super) struct LineSender {
    lines: Option<SyncSender<String>>,
    end: Option<Box<dyn FnOnce() + Send>>,
}

impl LineSender {
    /// `end`: ends the program, once the way to it is closed.
    pub fn start(mut to: impl Write + Send + 'static, end: impl FnOnce() + Send + 'static) -> LineSender {
        let (sender, lines) = sync_channel::<String>(QUEUE);
        thread::spawn(move || {
            for mut line in lines {
                line.push('\n');
                // A program that has ended says so on the way back.
                if to.write_all(line.as_bytes()).and_then(|()| to.flush()).is_err() {
                    return;
                }
            }
        });
        LineSender { lines: Some(sender), end: Some(Box::new(end)) }
    }
}

impl fmt::Debug for LineSender {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_struct("LineSender").finish_non_exhaustive()
    }
}

impl MindWriter for LineSender {
    fn send(&mut self, line: String) -> Result<(), String> {
        match self.lines.as_ref().map(|sender| sender.try_send(line)) {
            Some(Ok(())) => Ok(()),
            Some(Err(TrySendError::Full(_))) => Err(format!("it leaves {QUEUE} questions unread")),
            Some(Err(TrySendError::Disconnected(_))) | None => Err("it no longer reads".to_string()),
        }
    }
}

impl Drop for LineSender {
    fn drop(&mut self) {
        if let Some(sender) = self.lines.take() {
            let _ = sender.try_send(END.to_string());
        }
        if let Some(end) = self.end.take() {
            end();
        }
    }
}

/// Lines that come from a program.
#[derive(Debug)]
pub(super) struct LineReceiver(Receiver<MindNews>);

impl LineReceiver {
    /// `why`: says why the program has ended, once nothing more can come.
    pub fn start(from: impl Read + Send + 'static, why: impl FnOnce() -> String + Send + 'static) -> LineReceiver {
        let (sender, lines) = sync_channel(QUEUE);
        thread::spawn(move || {
            let mut from = BufReader::new(from);
            let over = loop {
                match next_line(&mut from) {
                    NextLine::Line(line) if line.trim().is_empty() => {}
                    // A full queue makes the program wait.
                    NextLine::Line(line) => {
                        if sender.send(MindNews::Line(line)).is_err() {
                            return;
                        }
                    }
                    NextLine::TooLong => break format!("a line of more than {} MB", LONGEST_LINE >> 20),
                    NextLine::End => break why(),
                }
            };
            let _ = sender.send(MindNews::Over(over));
        });
        LineReceiver(lines)
    }
}

impl MindReader for LineReceiver {
    fn receive(&mut self, wait: Duration) -> MindNews {
        match self.0.recv_timeout(wait) {
            Ok(news) => news,
            Err(RecvTimeoutError::Timeout) => MindNews::Nothing,
            Err(RecvTimeoutError::Disconnected) => MindNews::Over("its connection has ended".to_string()),
        }
    }
}

enum NextLine {
    Line(String),
    TooLong,
    End,
}

/// No more than the longest line is held in memory.
fn next_line(from: &mut impl BufRead) -> NextLine {
    let mut line = Vec::new();
    let read = from.take(LONGEST_LINE as u64 + 1).read_until(b'\n', &mut line);
    match read {
        Ok(0) | Err(_) => NextLine::End,
        Ok(_) if line.len() > LONGEST_LINE => NextLine::TooLong,
        Ok(_) => NextLine::Line(String::from_utf8_lossy(&line).trim_end_matches(['\n', '\r']).to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::{LineReceiver, NextLine, next_line};
    use std::io::Cursor;
    use std::time::Duration;
    use tomcom_session::external::{LONGEST_LINE, MindNews, MindReader};

    #[test]
    fn a_line_is_bounded_and_half_a_line_is_a_line() {
        let mut text = Cursor::new(b"{\"id\":0}\r\n\nhalf".to_vec());
        let mut lines = Vec::new();
        while let NextLine::Line(line) = next_line(&mut text) {
            lines.push(line);
        }
        assert_eq!(lines, ["{\"id\":0}", "", "half"]);
        let mut endless = std::io::BufReader::new(std::io::repeat(b'x'));
        assert!(matches!(next_line(&mut endless), NextLine::TooLong));
        let longest = [vec![b'x'; LONGEST_LINE - 1], vec![b'\n']].concat();
        assert!(matches!(next_line(&mut Cursor::new(longest)), NextLine::Line(line) if line.len() == LONGEST_LINE - 1));
    }

    #[test]
    fn an_ended_stream_says_why() {
        let mut lines = LineReceiver::start(Cursor::new(b"one\n\ntwo\n".to_vec()), || "exit code 3".to_string());
        let got: Vec<MindNews> = (0..3).map(|_| lines.receive(Duration::from_secs(600))).collect();
        let line = |text: &str| MindNews::Line(text.to_string());
        assert_eq!(got, [line("one"), line("two"), MindNews::Over("exit code 3".to_string())]);
    }
}
