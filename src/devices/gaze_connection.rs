//! One network connection that sends lines of gaze. A connection that does not begin with a JSON object is rejected and
//! counted, and none of its lines is read: websites can make a browser send requests to this port. If the sender is at
//! another computer whose address is not listed, the first line must be the pairing code; the program replies, so that
//! the sender can tell whether the code was right.

use std::io;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::io::AsyncWriteExt;
use tokio::net::TcpStream;
use tokio::sync::mpsc::Sender;
use tokio::time::{sleep, timeout, timeout_at};

use super::arrival::{Arrival, ArrivalWatch};
use super::connection_table::ConnectionHandle;
use super::gaze_gate::{GazeAccessCheck, GazeAdmission, RejectionReporter};
use super::gaze_input::{GazeSenderRejection, TrackerMessage};
use super::gaze_line::{begins_object, code_in, long_line_fault, opening_fault, parse};
use super::sender_clock::SenderClock;
use crate::lock;

/// Longest line of a gaze connection, in bytes.
const MAX_LINE: usize = 4096;
/// Most bytes that are read at once: what a sender sends together is stamped together.
const CHUNK: usize = 1 << 16;
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
    pub stream: TcpStream,
    /// Network address of the sender of gaze, with port 0: a sender that connects again counts once.
    pub from: SocketAddr,
    pub watch: ArrivalWatch,
    pub place: ConnectionHandle,
    pub gate: SharedGate,
    pub rejections: RejectionReporter,
    pub news: Sender<TrackerMessage>,
}

/// Reads a gaze connection until the connection ends, is rejected, or is replaced by another one.
pub(super) async fn attend(sender: GazeConnection) {
    let closed = sender.place.closed();
    let is_paired = lock(&sender.gate).admission(sender.from.ip()) == GazeAdmission::Open;
    let (lines, clock) = (LineReader::default(), SenderClock::new(Instant::now()));
    let mut reader = SampleReader { sender, lines, clock, is_paired };
    let rejected = tokio::select! {
        biased;
        () = closed => Err(GazeSenderRejection::GaveWay),
        rejected = reader.read() => rejected,
    };
    let SampleReader { sender, lines, clock, is_paired } = reader;
    match rejected {
        Err(why) => sender.rejections.report(sender.from, why, Instant::now()),
        Ok(()) if is_paired && lines.has_line => drop(sender.news.send(TrackerMessage::Closed).await),
        Ok(()) => {}
    }
    if clock.is_faulty() {
        // Nothing is wrong with the stamps of the next sender, as far as is known.
        let _ = sender.news.send(TrackerMessage::Stamps(None)).await;
    }
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
}

impl LineReader {
    /// Adds a byte that arrived at this instant to the present line; returns the content of the line if the byte ends it.
    fn take(&mut self, byte: u8, arrived: Instant) -> Option<LineContent> {
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
        self.end(arrived)
    }

    /// Ends the present line and returns the line's content; `None` if the line has none.
    fn end(&mut self, arrived: Instant) -> Option<LineContent> {
        let code = if self.has_line || self.is_too_long { None } else { code_in(&self.line) };
        let found = match (code, self.is_too_long) {
            (Some(code), _) => Some(LineContent::Pairing(code)),
            (None, true) => Some(LineContent::News(TrackerMessage::Malformed(1))),
            (None, false) => parse(&self.line, arrived).map(LineContent::News),
        };
        self.line.clear();
        self.is_too_long = false;
        self.has_line |= found.is_some();
        found
    }

    /// What shows that the sender is not an eye tracker's program, if the beginning of the first line does; `rest` are
    /// the bytes that arrived after it. Takes the same time for a line of any length, since it is asked after every byte.
    fn fault(&self, rest: &[u8]) -> Option<GazeSenderRejection> {
        match self.has_line {
            true => None,
            false if begins_object(&self.opening) == Some(false) => Some(opening_fault(&[&self.line, rest].concat())),
            false => self.is_too_long.then(|| long_line_fault(&self.line, MAX_LINE)),
        }
    }
}

/// Reads the lines of a gaze connection.
struct SampleReader {
    sender: GazeConnection,
    lines: LineReader,
    clock: SenderClock,
    /// Whether the sender of gaze is admitted, so that its lines are read.
    is_paired: bool,
}

impl SampleReader {
    /// Reads lines until the gaze connection ends; TCP slows down a sender that is too fast.
    ///
    /// # Errors
    /// Why the sender is rejected.
    async fn read(&mut self) -> Result<(), GazeSenderRejection> {
        let mut buffer = vec![0; CHUNK];
        let first_by = tokio::time::Instant::now() + FIRST_LINE;
        loop {
            let readable = self.sender.watch.wait(|| self.sender.stream.readable());
            if self.lines.has_line {
                // An error shows when the stream is read.
                let _ = readable.await;
            } else if timeout_at(first_by, readable).await.is_err() {
                return Err(match self.lines.line.is_empty() {
                    true => GazeSenderRejection::Silent(FIRST_LINE.as_secs()),
                    false => GazeSenderRejection::NoLineBreak,
                });
            }
            loop {
                let asked = Instant::now();
                let count = match self.sender.stream.try_read(&mut buffer) {
                    Ok(count @ 1..) => count,
                    Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                        self.sender.watch.was_empty(asked);
                        break;
                    }
                    Ok(0) | Err(_) => return self.end().await,
                };
                if !self.take(&buffer[..count], self.sender.watch.arrival(Instant::now())).await? {
                    return Ok(());
                }
            }
        }
    }

    /// Handles the end of the connection, whose last line may lack its newline.
    async fn end(&mut self) -> Result<(), GazeSenderRejection> {
        let arrival = self.sender.watch.arrival(Instant::now());
        if !self.lines.is_too_long
            && let Some(found) = self.lines.end(arrival.counted())
        {
            match found {
                LineContent::News(found) if self.is_paired => self.tell(vec![found], arrival).await,
                content => self.pair(content).await,
            };
        }
        Ok(())
    }

    /// Handles bytes that arrived together; returns whether further ones are read.
    async fn take(&mut self, bytes: &[u8], arrival: Arrival) -> Result<bool, GazeSenderRejection> {
        let mut together = Vec::new();
        for (index, &byte) in bytes.iter().enumerate() {
            let content = self.lines.take(byte, arrival.counted());
            if let Some(why) = self.lines.fault(&bytes[index + 1..]) {
                return Err(why);
            }
            match content {
                None => {}
                Some(LineContent::News(found)) if self.is_paired => together.push(found),
                Some(content) => {
                    let reads_on = self.pair(content).await;
                    if !reads_on {
                        return Ok(false);
                    }
                }
            }
        }
        Ok(self.tell(together, arrival).await)
    }

    /// Pairs with a sender by the content of its first line; returns whether further lines are read.
    async fn pair(&mut self, found: LineContent) -> bool {
        let code = match found {
            LineContent::News(_) => None,
            LineContent::Pairing(code) => Some(code),
        };
        let verdict = match self.is_paired {
            true => Ok(()),
            false => {
                let gate = &self.sender.gate;
                let delay = code.as_deref().map(|code| lock(gate).delay(code, Instant::now()));
                sleep(delay.unwrap_or_default()).await;
                lock(gate).pair(self.sender.from, code.as_deref(), Instant::now())
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
        let _ = timeout(ANSWER, self.sender.stream.write_all(answer.as_bytes())).await;
        self.is_paired
    }

    /// Passes on the contents of lines that arrived together; returns false if the receiver of gaze messages is gone.
    async fn tell(&mut self, together: Vec<TrackerMessage>, arrival: Arrival) -> bool {
        if together.iter().any(|one| matches!(one, TrackerMessage::Sample(..))) {
            // The connection table's limits never reject an admitted sender: no more connections can be open than may
            // be admitted. Only samples keep a connection's place, and nothing else that it sends.
            let _ = self.sender.place.admit();
            self.sender.place.heard(Instant::now());
        }
        for one in self.clock.stamp(together, arrival) {
            if self.sender.news.send(one).await.is_err() {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;
    use crate::connection_table::{ConnectionLimits, ConnectionTable};
    use tokio::net::TcpListener;
    use tokio::sync::mpsc::{Receiver, channel};
    use tomcom_core::gaze::GazeSample;

    const ONE: ConnectionLimits = ConnectionLimits {
        most: 1,
        per_address: 1,
        admitted: 1,
        admitted_per_address: 1,
        silence: Duration::from_secs(5),
    };

    /// A gaze connection that is attended, with the tracker's end of it.
    struct Attended {
        tracker: TcpStream,
        lines: Receiver<TrackerMessage>,
        table: Arc<ConnectionTable>,
        reader: tokio::task::JoinHandle<()>,
    }

    impl Attended {
        async fn begin() -> Attended {
            // The test opens the listener itself, at port 0, so that the system chooses a free port.
            let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
            let tracker = TcpStream::connect(listener.local_addr().expect("an address")).await.expect("connected");
            let (stream, from) = listener.accept().await.expect("a tracker");
            let (news, lines) = channel(64);
            let rejections = RejectionReporter::new(news.clone());
            let gate = Arc::new(Mutex::new(GazeAccessCheck::new(&[], None, rejections.clone())));
            let (table, now) = (ConnectionTable::new(ONE), Instant::now());
            let place = table.arrive(from.ip(), now).expect("a place").place;
            let watch = ArrivalWatch::new(now);
            let reader = tokio::spawn(attend(GazeConnection { stream, from, watch, place, gate, rejections, news }));
            Attended { tracker, lines, table, reader }
        }

        async fn send(&mut self, text: &str) {
            self.tracker.write_all(text.as_bytes()).await.expect("sent");
        }
    }

    #[tokio::test]
    async fn samples_arrive_and_what_is_none_is_counted() {
        let mut attended = Attended::begin().await;
        let text = [
            "{\"x\": 0.1, \"y\": 2, \"confidence\": 0, \"more\": 1}\r\n",
            "{\"x\": 0.5, \"y\": 0.5, \"confidence\": 1.01}\n{\"x\": 0.5, \"y\": 0.5, \"confidence\": -0.1}\n",
            "{\"t\": 1e20, \"x\": 0, \"y\": 0, \"confidence\": 1}\n",
            "{\"x\": NaN, \"y\": 2, \"confidence\": 1}\nnonsense\n",
            &"9".repeat(3 * MAX_LINE),
            "\n{\"x\": 1e999, \"y\": 0, \"confidence\": 1}\n{\"x\": 0.25, \"y\": 0.5, \"confidence\": 0.9}",
        ];
        attended.send(&text.concat()).await;
        let Attended { tracker, mut lines, reader, .. } = attended;
        drop(tracker);
        reader.await.expect("the reader ends with its tracker");
        let mut found = Vec::new();
        while let Some(line) = lines.recv().await {
            found.push(line);
        }
        let sample = |x, y, confidence| TrackerMessage::Sample(GazeSample::new(x, y, confidence), None);
        assert_eq!(found.remove(0), sample(0.1, 2.0, 0.0));
        assert_eq!(found.pop(), Some(TrackerMessage::Closed));
        // The last line lacks its newline.
        assert_eq!(found.pop(), Some(sample(0.25, 0.5, 0.9)));
        assert_eq!(found.remove(2), TrackerMessage::WrongTime(1e20));
        assert_eq!(found, vec![TrackerMessage::Malformed(1); 6]);
    }

    #[tokio::test]
    async fn only_samples_keep_a_place() {
        let mut attended = Attended::begin().await;
        attended.send("{\"x\": 0.5, \"y\": 0.5, \"confidence\": 1}\n").await;
        assert!(matches!(attended.lines.recv().await, Some(TrackerMessage::Sample(..))));
        let heard = Instant::now();
        // Spaces and lines without a sample follow; the line that is counted shows that they were read.
        attended.send(&" ".repeat(50)).await;
        attended.send("nonsense\n").await;
        assert_eq!(attended.lines.recv().await, Some(TrackerMessage::Malformed(1)));
        let place = attended.table.arrive(Ipv4Addr::LOCALHOST.into(), heard + ONE.silence);
        assert!(place.is_some_and(|new| new.made_room), "the place is free 5 s after the sample");
        attended.reader.await.expect("the reader ends");
        let why = GazeSenderRejection::GaveWay;
        let from = Ipv4Addr::LOCALHOST.into();
        assert_eq!(attended.lines.recv().await, Some(TrackerMessage::Rejected { from, why, senders: 1 }));
    }
}
