//! One network connection that sends lines of gaze. A connection that does not begin with a JSON object is rejected and
//! counted, and none of its lines is read: websites can make a browser send requests to this port. If the sender is at
//! another computer whose address is not listed, the first line must be the pairing code; the program replies, so that
//! the sender can tell whether the code was right.

use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::mpsc::Sender;
use tokio::time::{sleep, timeout};

use super::connection_table::ConnectionHandle;
use super::gaze_gate::{GazeAccessCheck, GazeAdmission};
use super::gaze_input::{GazeSenderRejection, TrackerMessage};
use super::gaze_line::{begins_object, code_in, parse};

/// Longest line of a gaze connection, in bytes.
const MAX_LINE: usize = 4096;
/// Number of bytes, without blanks, that show whether a connection begins with a JSON object.
const OPENING: usize = 2;
/// Time limit for the first line of a gaze connection.
const FIRST_LINE: Duration = Duration::from_secs(10);
/// Time limit for sending the reply to a pairing code.
const ANSWER: Duration = Duration::from_secs(1);

/// The access check, shared by all gaze connections.
pub(super) type SharedGate = Arc<Mutex<GazeAccessCheck>>;

/// A gaze connection with the state of its sender.
pub(super) struct GazeConnection {
    /// TCP stream of the connection.
    pub stream: TcpStream,
    /// Network address of the sender of gaze.
    pub from: IpAddr,
    /// Entry of this connection in the table of network connections.
    pub place: ConnectionHandle,
    /// Access check for senders of gaze, shared by all connections.
    pub gate: SharedGate,
    /// Channel by which the connection's gaze messages reach the session.
    pub news: Sender<TrackerMessage>,
}

/// Reads a gaze connection until the connection ends, is rejected, or is replaced by another one.
pub(super) async fn attend(connection: GazeConnection) {
    let GazeConnection { stream, from, place, gate, news } = connection;
    let is_paired = lock(&gate).admission(from) == GazeAdmission::Open;
    let mut reader =
        SampleReader { stream, from, place: &place, gate: &gate, news: &news, lines: LineReader::default(), is_paired };
    let is_tracker = tokio::select! {
        biased;
        () = place.closed() => false,
        is_tracker = reader.read() => is_tracker,
    };
    if !is_tracker {
        reject(&news);
    }
}

/// Counts one rejected sender of gaze.
pub(super) fn reject(news: &Sender<TrackerMessage>) {
    // A queue that is closed or full has worse consequences than a wrong count of rejected senders.
    let _ = news.try_send(TrackerMessage::Rejected(1));
}

/// Locks the shared access check, which stays usable after a panic in another thread.
pub(super) fn lock(gate: &SharedGate) -> std::sync::MutexGuard<'_, GazeAccessCheck> {
    gate.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Content of one line of a gaze connection.
enum LineContent {
    /// The first line of the connection, with a pairing code.
    Pairing(String),
    News(TrackerMessage),
}

/// Splits the bytes of a gaze connection into lines.
#[derive(Default)]
struct LineReader {
    line: Vec<u8>,
    is_too_long: bool,
    /// The first [`OPENING`] bytes of the connection that are not blank, as far as they have arrived.
    opening: Vec<u8>,
    /// Whether the first line of the connection is complete.
    has_line: bool,
    /// Whether a gaze sample has arrived on the connection.
    has_begun: bool,
}

impl LineReader {
    /// Adds a byte to the present line; returns the content of the line if the byte ends it.
    fn take(&mut self, byte: u8) -> Option<LineContent> {
        if !self.has_line && self.opening.len() < OPENING && !byte.is_ascii_whitespace() {
            self.opening.push(byte);
        }
        if byte != b'\n' {
            // The length limit protects the memory against a sender that never ends its line.
            match self.line.len() < MAX_LINE {
                true => self.line.push(byte),
                false => self.is_too_long = true,
            }
            return None;
        }
        self.end()
    }

    /// Ends the present line and returns the line's content; `None` if the line has none.
    fn end(&mut self) -> Option<LineContent> {
        let code = if self.has_line || self.is_too_long { None } else { code_in(&self.line) };
        let found = match (code, self.is_too_long) {
            (Some(code), _) => Some(LineContent::Pairing(code)),
            (None, true) => Some(LineContent::News(TrackerMessage::Malformed(1))),
            (None, false) => parse(&self.line, Instant::now()).map(LineContent::News),
        };
        self.line.clear();
        self.is_too_long = false;
        self.has_line |= found.is_some();
        found
    }

    /// Whether the beginning of the first line shows that the sender is not an eye tracker's program. Takes the same
    /// time for a line of any length, since it is asked after every byte.
    fn is_foreign(&self) -> bool {
        !self.has_line && (self.is_too_long || begins_object(&self.opening) == Some(false))
    }
}

/// Reads the lines of a gaze connection.
struct SampleReader<'a> {
    stream: TcpStream,
    from: IpAddr,
    place: &'a ConnectionHandle,
    gate: &'a SharedGate,
    news: &'a Sender<TrackerMessage>,
    lines: LineReader,
    /// Whether the sender of gaze is admitted, so that its lines are read.
    is_paired: bool,
}

impl SampleReader<'_> {
    /// Reads lines until the gaze connection ends; TCP slows down a sender that is too fast. Returns false if the
    /// sender has to be counted as rejected.
    async fn read(&mut self) -> bool {
        let mut buffer = vec![0; MAX_LINE];
        let first_by = tokio::time::Instant::now() + FIRST_LINE;
        loop {
            let left = first_by.saturating_duration_since(tokio::time::Instant::now());
            let patience = if self.lines.has_line { Duration::MAX } else { left };
            let Ok(count) = timeout(patience, self.stream.read(&mut buffer)).await else { return false };
            let Ok(count @ 1..) = count else { break };
            self.place.heard(Instant::now());
            for &byte in &buffer[..count] {
                let found = self.lines.take(byte);
                if self.lines.is_foreign() {
                    return false;
                }
                if let Some(found) = found
                    && !self.handle(found).await
                {
                    return true;
                }
            }
        }
        // The last line of a connection may lack its newline.
        if !self.lines.is_too_long
            && let Some(found) = self.lines.end()
        {
            self.handle(found).await;
        }
        true
    }

    /// Handles the content of a gaze line; returns whether further lines are read.
    async fn handle(&mut self, found: LineContent) -> bool {
        let code = match found {
            LineContent::News(found) if self.is_paired => return self.tell(found).await,
            LineContent::News(_) => None,
            LineContent::Pairing(code) => Some(code),
        };
        let verdict = match self.is_paired {
            true => Ok(()),
            false => {
                let delay = code.as_deref().map(|code| lock(self.gate).delay(code, Instant::now()));
                sleep(delay.unwrap_or_default()).await;
                lock(self.gate).pair(self.from, code.as_deref(), Instant::now())
            }
        };
        self.is_paired = verdict.is_ok();
        let answer = match verdict {
            Ok(()) => "{\"paired\": true}\n".to_string(),
            Err((why, wait)) => format!(
                "{{\"paired\": false, \"checked\": {}, \"wait_s\": {}}}\n",
                why == GazeSenderRejection::WrongCode,
                wait.as_secs_f64().ceil()
            ),
        };
        // A sender that does not read the program's reply notices the result when the connection is closed.
        let _ = timeout(ANSWER, self.stream.write_all(answer.as_bytes())).await;
        self.is_paired
    }

    /// Passes on the content of a line, preceded by `Began` before the first sample; returns false if the receiver of
    /// gaze messages is gone.
    async fn tell(&mut self, found: TrackerMessage) -> bool {
        if matches!(found, TrackerMessage::Sample(..)) && !self.lines.has_begun {
            self.lines.has_begun = true;
            // The connection table's limits never reject an admitted sender: no more connections can be open than may
            // be admitted.
            let _ = self.place.admit();
            if self.news.send(TrackerMessage::Began).await.is_err() {
                return false;
            }
        }
        self.news.send(found).await.is_ok()
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;
    use crate::edge::connection_table::{ConnectionLimits, ConnectionTable};
    use crate::gaze::GazeSample;
    use tokio::net::TcpListener;
    use tokio::sync::mpsc::channel;

    const ONE: ConnectionLimits = ConnectionLimits {
        most: 1,
        per_address: 1,
        admitted: 1,
        admitted_per_address: 1,
        silence: Duration::from_secs(5),
    };

    #[test]
    fn a_first_line_that_is_longer_than_any_line_is_foreign_before_its_time_is_over() {
        for beginning in ["", "{", "{\"x\": "] {
            let mut lines = LineReader::default();
            for &byte in beginning.as_bytes() {
                assert!(lines.take(byte).is_none() && !lines.is_foreign(), "{beginning:?}");
            }
            let blanks = (0..=MAX_LINE).take_while(|_| {
                lines.take(b' ');
                !lines.is_foreign()
            });
            assert_eq!(blanks.count(), MAX_LINE - beginning.len(), "{beginning:?}");
        }
    }

    #[tokio::test]
    async fn samples_arrive_and_what_is_none_is_counted() {
        // The test opens the listener itself, at port 0, so that the system chooses a free port.
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let (sender, mut lines) = channel(64);
        let reader = tokio::spawn(async move {
            let (stream, from) = listener.accept().await.expect("a tracker");
            let gate = Arc::new(Mutex::new(GazeAccessCheck::new(&[], None, sender.clone())));
            let table = ConnectionTable::new(ONE);
            let place = table.arrive(from.ip(), Instant::now()).expect("a place").place;
            attend(GazeConnection { stream, from: from.ip(), place, gate, news: sender }).await;
        });
        let mut tracker = TcpStream::connect(address).await.expect("connected");
        let text = [
            "{\"t\": 1.5, \"x\": 0.25, \"y\": 0.5, \"confidence\": 0.9}\n",
            "\n{\"x\": 0.1, \"y\": 2, \"confidence\": 0, \"more\": 1}\r\n",
            "{\"x\": 0.5, \"y\": 0.5, \"confidence\": 1.01}\n{\"x\": 0.5, \"y\": 0.5, \"confidence\": -0.1}\n",
            "{\"t\": 1764057600123.5, \"x\": 0, \"y\": 0, \"confidence\": 1}\n",
            "{\"t\": -3.5, \"x\": 0, \"y\": 0, \"confidence\": 1}\n",
            "{\"x\": NaN, \"y\": 2, \"confidence\": 1}\nnonsense\n",
            &"9".repeat(3 * MAX_LINE),
            "\n{\"x\": 1e999, \"y\": 0, \"confidence\": 1}\n",
        ];
        tracker.write_all(text.concat().as_bytes()).await.expect("sent");
        drop(tracker);
        reader.await.expect("the reader ends with its tracker");
        let mut found = Vec::new();
        while let Some(line) = lines.recv().await {
            found.push(line);
        }
        let sample = |x, y, confidence, device_ns| {
            TrackerMessage::Sample(GazeSample { device_ns, ..GazeSample::new(x, y, confidence) }, None)
        };
        assert_eq!(found.remove(0), TrackerMessage::Began);
        let expected = [sample(0.25, 0.5, 0.9, Some(1_500_000_000)), sample(0.1, 2.0, 0.0, None)];
        assert_eq!(found[..2], expected);
        assert_eq!(found[2..4], vec![TrackerMessage::Malformed(1); 2]);
        let milliseconds = sample(0.0, 0.0, 1.0, Some(1_764_057_600_123_500_032));
        assert_eq!(found[4..6], [milliseconds, TrackerMessage::WrongTime(-3.5)]);
        assert_eq!(found[6..], vec![TrackerMessage::Malformed(1); 4]);
    }
}
