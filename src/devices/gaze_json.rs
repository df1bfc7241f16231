//! Gaze input from any other program: lines of JSON over TCP and UDP (`gaze_line.rs`). Lines that are no samples are
//! counted. A sender whose connection or datagram does not begin with a JSON object is rejected and reported. Gaze from
//! other computers is read only from listed addresses, or from senders that know the pairing code. Every connection, and
//! every address and port that sends datagrams, has a clock of its own.

use std::collections::VecDeque;
use std::future::poll_fn;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex};
use std::task::Poll;
use std::time::{Duration, Instant};

use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::sleep;

use super::arrival::{Arrival, ArrivalWatch};
use super::connection_table::{ConnectionLimits, ConnectionTable};
use super::gaze_connection::{GazeConnection, SharedGate, attend};
use super::gaze_gate::{GazeAccessCheck, GazeAdmission, RejectionReporter};
use super::gaze_input::{GazeSenderRejection, TrackerMessage, WAITING};
use super::gaze_line::{begins_object, opening_fault, parse};
use super::outer_address::reachable;
use super::pairing::pairing_code;
use super::sender_clock::SenderClock;
use crate::lock;
use tomcom_session::settings::GazeSenders;

/// Longest datagram of gaze, in bytes; a datagram can contain several lines.
const MAX_DATAGRAM: usize = 1 << 16;
/// Largest number of datagram senders whose clocks are kept; the one that was silent for longest is forgotten first.
const MAX_CLOCKS: usize = 64;
/// Limits for gaze connections. A sender that has sent a gaze sample may be silent as long as there is room; senders
/// that are not admitted are replaced first.
const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 32,
    per_address: 32,
    admitted: 32,
    admitted_per_address: 32,
    silence: Duration::from_secs(5),
};

/// The open gaze input for connections (TCP) and datagrams (UDP).
#[derive(Debug)]
pub struct GazeListener {
    pub address: SocketAddr,
    /// Pairing code for senders at other computers; `None` if no other computer can reach the input, or if the session
    /// lists addresses.
    pub code: Option<String>,
    pub news: Receiver<TrackerMessage>,
}

impl GazeListener {
    /// Address to which gaze senders at other computers send.
    pub fn reachable(&self) -> SocketAddr {
        reachable(self.address)
    }
}

/// Listens at the address `at` for gaze connections and datagrams, of this computer and of others: from listed
/// addresses, or, if none is listed, from senders that know the pairing code. Senders may come and go. Port 0 stands
/// for a free port.
///
/// # Errors
/// The program cannot listen at the address.
pub async fn listen(at: SocketAddr, senders: GazeSenders, listed: &[IpAddr]) -> io::Result<GazeListener> {
    let listener = TcpListener::bind(at).await?;
    let address = listener.local_addr()?;
    let socket = UdpSocket::bind(address).await?;
    let (sender, news) = channel(WAITING);
    let code = (!at.ip().is_loopback() && listed.is_empty()).then(pairing_code);
    let rejections = RejectionReporter::new(sender.clone());
    let gate = || GazeAccessCheck::new(listed, code.as_ref(), rejections.clone());
    let datagrams = DatagramReader {
        holder: ExclusiveDatagramSender::new(senders),
        gate: gate(),
        rejections: rejections.clone(),
        clocks: VecDeque::new(),
    };
    tokio::spawn(take_datagrams(socket, datagrams, sender.clone()));
    tokio::spawn(take_connections(listener, Arc::new(Mutex::new(gate())), rejections, sender.clone()));
    Ok(GazeListener { address, code, news })
}

/// Accepts gaze connections until the program ends.
async fn take_connections(
    listener: TcpListener,
    gate: SharedGate,
    rejections: RejectionReporter,
    news: Sender<TrackerMessage>,
) {
    let table = ConnectionTable::new(LIMITS);
    let mut watch = ArrivalWatch::new(Instant::now());
    while !news.is_closed() {
        let Ok((stream, from)) = accept(&listener, &mut watch).await else {
            // The process may have run out of file descriptors: the pause prevents a loop that never sleeps.
            sleep(Duration::from_millis(100)).await;
            continue;
        };
        // What a connection sends may have waited as long as the connection itself.
        let (from, now, watch) = (SocketAddr::new(from.ip(), 0), Instant::now(), watch);
        if lock(&gate).admission(from.ip()) == GazeAdmission::Never {
            rejections.report(from, GazeSenderRejection::Unlisted, now);
            continue;
        }
        match table.arrive(from.ip(), now) {
            Some(arrival) => {
                let (place, gate, rejections, news) = (arrival.place, gate.clone(), rejections.clone(), news.clone());
                drop(tokio::spawn(attend(GazeConnection { stream, from, watch, place, gate, rejections, news })));
            }
            None => rejections.report(from, GazeSenderRejection::Crowded, now),
        }
    }
}

async fn accept(listener: &TcpListener, watch: &mut ArrivalWatch) -> io::Result<(TcpStream, SocketAddr)> {
    let asked = Instant::now();
    match poll_fn(|context| Poll::Ready(listener.poll_accept(context))).await {
        Poll::Ready(found) => found,
        // After an accepted connection the operating system was asked whether there is another one.
        Poll::Pending => {
            watch.was_empty(asked);
            watch.wait(|| listener.accept()).await
        }
    }
}

/// Reads gaze datagrams until the program ends; samples that cannot be queued are counted as dropped.
async fn take_datagrams(socket: UdpSocket, mut reader: DatagramReader, news: Sender<TrackerMessage>) {
    let mut buffer = vec![0; MAX_DATAGRAM];
    let (mut lost, mut watch) = (0, ArrivalWatch::new(Instant::now()));
    while !news.is_closed() {
        // An error shows when the socket is read.
        let _ = watch.wait(|| socket.readable()).await;
        loop {
            let asked = Instant::now();
            let (count, from) = match socket.try_recv_from(&mut buffer) {
                Ok(received) => received,
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                    watch.was_empty(asked);
                    break;
                }
                Err(_) => {
                    // The error only says that an earlier sender of datagrams is gone.
                    sleep(Duration::from_millis(1)).await;
                    break;
                }
            };
            for one in reader.take(&buffer[..count], from, watch.arrival(Instant::now())) {
                lost += u64::from(news.try_send(one).is_err());
            }
            if lost > 0 && news.try_send(TrackerMessage::Overrun(lost)).is_ok() {
                lost = 0;
            }
            // The session reads between two datagrams, also where they come without end.
            tokio::task::consume_budget().await;
        }
    }
}

/// Reads the lines of gaze datagrams.
struct DatagramReader {
    holder: ExclusiveDatagramSender,
    gate: GazeAccessCheck,
    rejections: RejectionReporter,
    /// Clocks of senders by address and port, the latest sender last.
    clocks: VecDeque<(SocketAddr, SenderClock)>,
}

impl DatagramReader {
    fn take(&mut self, datagram: &[u8], from: SocketAddr, arrival: Arrival) -> Vec<TrackerMessage> {
        let now = arrival.by;
        let Some(lines) = self.gate.lines(from, datagram, now) else { return Vec::new() };
        let fault = match self.holder.excludes(from.ip(), now) {
            _ if begins_object(lines) == Some(false) => Some(opening_fault(lines)),
            other => other.map(GazeSenderRejection::OtherSender),
        };
        if let Some(why) = fault {
            self.rejections.report(from, why, now);
            return Vec::new();
        }
        let lines = lines.split(|&byte| byte == b'\n');
        let found: Vec<TrackerMessage> = lines.filter_map(|line| parse(line, arrival.counted())).collect();
        if !found.iter().any(|news| matches!(news, TrackerMessage::Sample(..))) {
            return found;
        }
        self.holder.heard(from.ip(), now);
        // Nothing is wrong with the stamps of a new sender, as far as is known.
        let is_new = self.clocks.iter().all(|(sender, _)| *sender != from);
        let forgets = is_new && self.clocks.back().is_some_and(|(_, clock)| clock.is_faulty());
        let forget = forgets.then_some(TrackerMessage::Stamps(None));
        forget.into_iter().chain(self.clock(from, now).stamp(found, arrival)).collect()
    }

    fn clock(&mut self, from: SocketAddr, now: Instant) -> &mut SenderClock {
        let known = self.clocks.iter().position(|(sender, _)| *sender == from);
        let known = known.and_then(|index| self.clocks.remove(index));
        if known.is_none() && self.clocks.len() == MAX_CLOCKS {
            self.clocks.pop_front();
        }
        let last = self.clocks.len();
        self.clocks.push_back(known.unwrap_or_else(|| (from, SenderClock::new(now))));
        &mut self.clocks[last].1
    }
}

/// Silence after which the network address that sent gaze loses its exclusive use of the gaze input.
pub const RELEASE: Duration = Duration::from_secs(5);

/// Which address may send gaze datagrams: the first sender has exclusive use until it falls silent.
#[derive(Clone, Copy, Debug)]
pub struct ExclusiveDatagramSender {
    senders: GazeSenders,
    /// Address with exclusive use of the gaze input, and the arrival of its last sample.
    holder: Option<(IpAddr, Instant)>,
}

impl ExclusiveDatagramSender {
    /// A filter that no address uses exclusively yet.
    pub fn new(senders: GazeSenders) -> ExclusiveDatagramSender {
        ExclusiveDatagramSender { senders, holder: None }
    }

    /// The other address because of which no gaze datagram from this network address is read; `None` if it is read.
    pub fn excludes(&self, from: IpAddr, now: Instant) -> Option<IpAddr> {
        let (holder, heard) = self.holder.filter(|_| self.senders == GazeSenders::First)?;
        (holder != from && now.saturating_duration_since(heard) < RELEASE).then_some(holder)
    }

    /// Records that a datagram from this network address contained a gaze sample.
    pub fn heard(&mut self, from: IpAddr, now: Instant) {
        self.holder = Some((from, now));
    }
}

#[cfg(test)]
mod tests {
    use tokio::sync::mpsc::channel;

    use super::*;
    use rand::RngExt;
    use tomcom_core::base::rng::stream;

    #[test]
    fn no_sender_of_datagrams_moves_the_clock_of_another_one() {
        let (news, _told) = channel(64);
        let rejections = RejectionReporter::new(news);
        let (holder, clocks) = (ExclusiveDatagramSender::new(GazeSenders::First), VecDeque::new());
        let gate = GazeAccessCheck::new(&[], None, rejections.clone());
        let mut reader = DatagramReader { holder, gate, rejections, clocks };
        let (start, mut random) = (Instant::now(), stream(5, "odd times", 0));
        let port = |port: u16| SocketAddr::from(([127, 0, 0, 1], port));
        let mut taken = |from: SocketAddr, t: f64, x: f64, now: Instant| {
            let line = format!("{{\"t\": {t}, \"x\": {x}, \"y\": 0.5, \"confidence\": 1}}\n");
            let messages = reader.take(line.as_bytes(), from, Arrival { after: now, by: now });
            let sample = messages.into_iter().rfind(|one| matches!(one, TrackerMessage::Sample(..)));
            let Some(TrackerMessage::Sample(_, taken)) = sample else { panic!("no sample") };
            taken.unwrap_or(now)
        };
        for number in 0..2400u32 {
            let now = start + Duration::from_secs_f64(f64::from(number) / 120.0);
            for _ in 0..5 {
                let (from, t) = (port(50_100 + random.random_range(0..50)), random.random_range(-1e6..1e6));
                assert!(taken(from, t, random.random(), now) <= now);
            }
            let found = taken(port(40_000), f64::from(number) / 120.0, f64::from(number) * 1e-5, now);
            let late = now.saturating_duration_since(found);
            assert!(late < Duration::from_millis(1), "sample {number} counts as {late:?} old");
        }
        assert_eq!(reader.clocks.len(), 51);
        for number in 0..1000u16 {
            reader.clock(port(1000 + number), start);
        }
        assert_eq!(reader.clocks.len(), MAX_CLOCKS, "memory is bounded");
    }
}
