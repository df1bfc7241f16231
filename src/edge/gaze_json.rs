//! Gaze from any other program: lines {"t": seconds, "x": 0..1, "y": 0..1, "confidence": 0..1} over TCP or UDP. Coordinates are
//! fractions of the wall display, the origin at the top left; t is the tracker's own clock.
//! Lines that are no samples are counted. A connection or datagram that does not begin with a JSON object is rejected and
//! counted, and none of its lines is read: websites can make a browser send requests to this port. From other computers only
//! listed addresses are read.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::{Duration, Instant};

use serde::Deserialize;
use tokio::io::AsyncReadExt;
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::{sleep, timeout};

use super::connection_table::{ConnectionLimits, ConnectionPlace, ConnectionTable};
use super::datagram_holder::DatagramHolder;
use super::gaze_input::{GazeNews, WAITING};
use crate::gaze::GazeSample;
use crate::session::settings::GazeSenders;

/// Longest line, in bytes.
const MAX_LINE: usize = 4096;
/// Longest datagram, in bytes; it can contain several lines.
const MAX_DATAGRAM: usize = 1 << 16;
/// Time limit for the first line of a connection.
const FIRST_LINE: Duration = Duration::from_secs(10);
/// Least time between two notices about senders that are not listed: datagrams can come in thousands.
const NOTICE: Duration = Duration::from_millis(100);
/// All connections come from this machine or from listed ones. A tracker that has sent a sample may be silent as long as there is room.
const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 32,
    per_address: 32,
    admitted: 32,
    admitted_per_address: 32,
    silence: Duration::from_secs(5),
};

#[derive(Deserialize)]
struct Line {
    #[serde(default)]
    t: Option<f64>,
    x: f64,
    y: f64,
    confidence: f64,
}

/// The open gaze input.
#[derive(Debug)]
pub struct GazeListener {
    /// Address for connections and datagrams.
    pub address: SocketAddr,
    /// What trackers send.
    pub news: Receiver<GazeNews>,
}

/// Listens at this address for connections and datagrams of this computer and of the listed addresses; trackers may come and go. Port 0
/// stands for a free port.
///
/// # Errors
/// The address cannot be listened on.
pub async fn listen(at: SocketAddr, senders: GazeSenders, listed: Vec<IpAddr>) -> io::Result<GazeListener> {
    let listener = TcpListener::bind(at).await?;
    let address = listener.local_addr()?;
    let socket = UdpSocket::bind(address).await?;
    let (sender, news) = channel(WAITING);
    let gate = Gate { listed, news: sender.clone(), told: None };
    tokio::spawn(take_datagrams(socket, DatagramHolder::new(senders), gate.clone(), sender.clone()));
    tokio::spawn(take_connections(listener, gate, sender));
    Ok(GazeListener { address, news })
}

/// Rejects addresses that are not listed.
#[derive(Clone)]
struct Gate {
    listed: Vec<IpAddr>,
    news: Sender<GazeNews>,
    /// When a sender was told of last.
    told: Option<Instant>,
}

impl Gate {
    /// Whether what comes from this address is read; tells of it if not.
    fn admits(&mut self, from: IpAddr, now: Instant) -> bool {
        // Where both kinds of addresses are listened on, those of version 4 come in the clothes of version 6.
        let from = from.to_canonical();
        if from.is_loopback() || self.listed.iter().any(|listed| listed.to_canonical() == from) {
            return true;
        }
        if self.told.is_none_or(|told| now.saturating_duration_since(told) >= NOTICE) {
            self.told = Some(now);
            // A closed or full channel has more serious consequences than a missing notice.
            let _ = self.news.try_send(GazeNews::Unlisted(from));
        }
        false
    }
}

/// Accepts connections without end.
async fn take_connections(listener: TcpListener, mut gate: Gate, news: Sender<GazeNews>) {
    let table = ConnectionTable::new(LIMITS);
    while !news.is_closed() {
        let Ok((stream, from)) = listener.accept().await else {
            // The process may be out of descriptors: the pause prevents a busy loop.
            sleep(Duration::from_millis(100)).await;
            continue;
        };
        if !gate.admits(from.ip(), Instant::now()) {
            continue;
        }
        match table.arrive(from.ip(), Instant::now()) {
            Some(arrival) => drop(tokio::spawn(attend(stream, arrival.place, news.clone()))),
            None => reject(&news),
        }
    }
}

/// Reads a connection until it ends, is rejected, or is replaced by another.
async fn attend(stream: TcpStream, place: ConnectionPlace, news: Sender<GazeNews>) {
    let is_tracker = tokio::select! {
        biased;
        () = place.closed() => false,
        is_tracker = read(stream, &place, &news) => is_tracker,
    };
    if !is_tracker {
        reject(&news);
    }
}

/// Counts a rejected sender.
fn reject(news: &Sender<GazeNews>) {
    // A closed or full channel has more serious consequences than a wrong count.
    let _ = news.try_send(GazeNews::Rejected(1));
}

/// Reads datagrams without end; samples that are not processed in time are counted.
async fn take_datagrams(socket: UdpSocket, mut holder: DatagramHolder, mut gate: Gate, news: Sender<GazeNews>) {
    let mut buffer = vec![0; MAX_DATAGRAM];
    let (mut lost, mut tracker) = (0, None);
    while !news.is_closed() {
        let Ok((count, from)) = socket.recv_from(&mut buffer).await else {
            // Somebody who sent has gone: that is told here, and nothing else.
            sleep(Duration::from_millis(1)).await;
            continue;
        };
        let (now, datagram) = (Instant::now(), &buffer[..count]);
        if !gate.admits(from.ip(), now) {
            continue;
        }
        if begins_object(datagram) == Some(false) || !holder.admits(from.ip(), now) {
            reject(&news);
            continue;
        }
        let found: Vec<GazeNews> = datagram.split(|&byte| byte == b'\n').filter_map(parse).collect();
        let mut began = None;
        if found.iter().any(|news| matches!(news, GazeNews::Sample(..))) {
            holder.heard(from.ip(), now);
            began = (tracker.replace(from) != Some(from)).then_some(GazeNews::Began);
        }
        for one in began.into_iter().chain(found) {
            lost += u64::from(news.try_send(one).is_err());
        }
        if lost > 0 && news.try_send(GazeNews::Overrun(lost)).is_ok() {
            lost = 0;
        }
    }
}

/// Whether bytes begin like a JSON object; `None` if there are too few to decide.
fn begins_object(bytes: &[u8]) -> Option<bool> {
    let mut signs = bytes.iter().filter(|byte| !byte.is_ascii_whitespace());
    match (signs.next(), signs.next()) {
        (Some(b'{'), Some(next)) => Some(matches!(next, b'"' | b'}')),
        (Some(b'{') | None, None) => None,
        _ => Some(false),
    }
}

/// Splits a connection's bytes into lines.
#[derive(Default)]
struct LineReader {
    line: Vec<u8>,
    is_too_long: bool,
    /// Whether the first line is complete.
    has_line: bool,
    /// Whether a sample arrived.
    has_begun: bool,
}

impl LineReader {
    /// Adds a byte; returns the content of the line that it ends, if any.
    fn take(&mut self, byte: u8) -> Option<GazeNews> {
        if byte != b'\n' {
            // The bound protects the memory against a sender that never ends its line.
            match self.line.len() < MAX_LINE {
                true => self.line.push(byte),
                false => self.is_too_long = true,
            }
            return None;
        }
        self.end()
    }

    /// Ends the line and returns its content, if any.
    fn end(&mut self) -> Option<GazeNews> {
        let found = if self.is_too_long { Some(GazeNews::Malformed(1)) } else { parse(&self.line) };
        self.line.clear();
        self.is_too_long = false;
        self.has_line |= found.is_some();
        found
    }

    /// Whether the beginning of the first line shows that the sender is no tracker.
    fn is_foreign(&self) -> bool {
        !self.has_line && begins_object(&self.line) == Some(false)
    }
}

/// Reads lines until the connection ends; a sender that is too fast is slowed down by TCP. Returns false if the sender has to
/// be rejected.
async fn read(mut stream: TcpStream, place: &ConnectionPlace, news: &Sender<GazeNews>) -> bool {
    let mut buffer = vec![0; MAX_LINE];
    let mut lines = LineReader::default();
    let first_by = tokio::time::Instant::now() + FIRST_LINE;
    loop {
        let left = first_by.saturating_duration_since(tokio::time::Instant::now());
        let patience = if lines.has_line { Duration::MAX } else { left };
        let Ok(count) = timeout(patience, stream.read(&mut buffer)).await else { return false };
        let Ok(count @ 1..) = count else { break };
        place.heard(Instant::now());
        for &byte in &buffer[..count] {
            let found = lines.take(byte);
            if lines.is_foreign() {
                return false;
            }
            if let Some(found) = found
                && !tell(found, &mut lines, place, news).await
            {
                return true;
            }
        }
    }
    // The last line may lack its newline.
    if !lines.is_too_long
        && let Some(found) = lines.end()
    {
        tell(found, &mut lines, place, news).await;
    }
    true
}

/// Passes on the content of a line, with `Began` before the first sample; returns false if the receiver is gone.
async fn tell(found: GazeNews, lines: &mut LineReader, place: &ConnectionPlace, news: &Sender<GazeNews>) -> bool {
    if matches!(found, GazeNews::Sample(..)) && !lines.has_begun {
        lines.has_begun = true;
        // All connections together are not more than may be admitted.
        let _ = place.admit();
        if news.send(GazeNews::Began).await.is_err() {
            return false;
        }
    }
    news.send(found).await.is_ok()
}

/// Parses a line; `None` for an empty line.
pub fn parse(line: &[u8]) -> Option<GazeNews> {
    if line.trim_ascii().is_empty() {
        return None;
    }
    let Ok(found) = serde_json::from_slice::<Line>(line) else { return Some(GazeNews::Malformed(1)) };
    // Beside the display is a place, too; a confidence beyond its scale is a tracker that speaks another language.
    if !(found.x.is_finite() && found.y.is_finite() && (0.0..=1.0).contains(&found.confidence)) {
        return Some(GazeNews::Malformed(1));
    }
    let device_ns = match found.t.map(|t| device_ns(t).ok_or(t)).transpose() {
        Ok(device_ns) => device_ns,
        Err(t) => return Some(GazeNews::WrongTime(t)),
    };
    let sample = GazeSample { device_ns, ..GazeSample::new(found.x, found.y, found.confidence) };
    Some(GazeNews::Sample(sample, None))
}

/// Converts a time stamp to nanoseconds; `None` if it is none. Up to ten digits are seconds of any clock. More are milliseconds,
/// microseconds or nanoseconds since 1970, which differ by three digits each.
fn device_ns(t: f64) -> Option<u64> {
    let ns_per_unit = match t {
        0.0..1e10 => 1e9,
        1e11..1e13 => 1e6,
        1e14..1e16 => 1e3,
        1e17..1e19 => 1.0,
        _ => return None,
    };
    Some((t * ns_per_unit).round() as u64)
}

#[cfg(test)]
mod tests {
    use std::net::Ipv4Addr;

    use super::*;
    use tokio::io::AsyncWriteExt;

    #[tokio::test]
    async fn samples_arrive_and_what_is_none_is_counted() {
        // Port 0: the system chooses; so the test listens itself.
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.expect("a port");
        let address = listener.local_addr().expect("an address");
        let (sender, mut lines) = channel(WAITING);
        let reader = tokio::spawn(async move {
            let (stream, from) = listener.accept().await.expect("a tracker");
            let arrival = ConnectionTable::new(LIMITS).arrive(from.ip(), Instant::now()).expect("a place");
            attend(stream, arrival.place, sender).await;
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
            GazeNews::Sample(GazeSample { device_ns, ..GazeSample::new(x, y, confidence) }, None)
        };
        assert_eq!(found.remove(0), GazeNews::Began);
        let expected = [sample(0.25, 0.5, 0.9, Some(1_500_000_000)), sample(0.1, 2.0, 0.0, None)];
        assert_eq!(found[..2], expected);
        assert_eq!(found[2..4], vec![GazeNews::Malformed(1); 2]);
        let milliseconds = sample(0.0, 0.0, 1.0, Some(1_764_057_600_123_500_032));
        assert_eq!(found[4..6], [milliseconds, GazeNews::WrongTime(-3.5)]);
        assert_eq!(found[6..], vec![GazeNews::Malformed(1); 4]);
    }

    #[test]
    fn time_stamps_are_seconds_or_finer_units_since_1970_or_refused() {
        let since_1970_s = 1_764_057_600.25;
        for unit in [1.0, 1e3, 1e6, 1e9] {
            let ns = device_ns(since_1970_s * unit).expect("a time");
            assert!(ns.abs_diff(1_764_057_600_250_000_000) < 500, "{unit}: {ns}");
        }
        assert_eq!(device_ns(12.5), Some(12_500_000_000));
        for wrong in [-0.001, 5e10, 5e13, 5e16, 1e20, f64::NAN, f64::INFINITY] {
            assert_eq!(device_ns(wrong), None, "{wrong}");
        }
    }
}
