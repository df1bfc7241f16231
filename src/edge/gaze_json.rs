//! Gaze input from any other program: lines of JSON over TCP and UDP (`gaze_line.rs`). Lines that are no samples are
//! counted. A connection or datagram that does not begin with a JSON object is rejected and counted. Gaze from other
//! computers is read only from listed addresses, or from senders that know the pairing code.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use tokio::net::{TcpListener, UdpSocket};
use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::sleep;

use super::connection_table::{ConnectionLimits, ConnectionTable};
use super::datagram_holder::ExclusiveDatagramSender;
use super::gaze_connection::{GazeConnection, SharedGate, attend, lock, reject};
use super::gaze_gate::{GazeAccessCheck, GazeAdmission};
use super::gaze_input::{GazeSenderRejection, TrackerMessage, WAITING};
use super::gaze_line::{begins_object, parse};
use super::outer_address::reachable;
use super::pairing_code::pairing_code;
use crate::session::settings::GazeSenders;

/// Longest datagram of gaze, in bytes; a datagram can contain several lines.
const MAX_DATAGRAM: usize = 1 << 16;
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
    /// Network address at which gaze connections and datagrams are received.
    pub address: SocketAddr,
    /// Pairing code for senders at other computers; `None` if no other computer can reach the input, or if the session
    /// lists addresses.
    pub code: Option<String>,
    /// Channel of messages from the senders of gaze.
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
    let gate = || GazeAccessCheck::new(listed, code.as_ref(), sender.clone());
    tokio::spawn(take_datagrams(socket, ExclusiveDatagramSender::new(senders), gate(), sender.clone()));
    tokio::spawn(take_connections(listener, Arc::new(Mutex::new(gate())), sender.clone()));
    Ok(GazeListener { address, code, news })
}

/// Accepts gaze connections until the program ends.
async fn take_connections(listener: TcpListener, gate: SharedGate, news: Sender<TrackerMessage>) {
    let table = ConnectionTable::new(LIMITS);
    while !news.is_closed() {
        let Ok((stream, from)) = listener.accept().await else {
            // The process may have run out of file descriptors: the pause prevents a loop that never sleeps.
            sleep(Duration::from_millis(100)).await;
            continue;
        };
        let (from, now) = (from.ip(), Instant::now());
        if lock(&gate).admission(from) == GazeAdmission::Never {
            lock(&gate).refuse(from, GazeSenderRejection::Unlisted, now);
            continue;
        }
        match table.arrive(from, now) {
            Some(arrival) => {
                let (place, gate, news) = (arrival.place, gate.clone(), news.clone());
                drop(tokio::spawn(attend(GazeConnection { stream, from, place, gate, news })));
            }
            None => reject(&news),
        }
    }
}

/// Reads gaze datagrams until the program ends; samples that cannot be queued are counted as dropped.
async fn take_datagrams(
    socket: UdpSocket,
    mut holder: ExclusiveDatagramSender,
    mut gate: GazeAccessCheck,
    news: Sender<TrackerMessage>,
) {
    let mut buffer = vec![0; MAX_DATAGRAM];
    let (mut lost, mut tracker) = (0, None);
    while !news.is_closed() {
        let Ok((count, from)) = socket.recv_from(&mut buffer).await else {
            // The error only says that an earlier sender of datagrams is gone.
            sleep(Duration::from_millis(1)).await;
            continue;
        };
        let (now, datagram) = (Instant::now(), &buffer[..count]);
        let Some(lines) = gate.lines(from, datagram, now) else { continue };
        if begins_object(lines) == Some(false) || !holder.admits(from.ip(), now) {
            reject(&news);
            continue;
        }
        let found: Vec<TrackerMessage> =
            lines.split(|&byte| byte == b'\n').filter_map(|line| parse(line, now)).collect();
        let mut began = None;
        if found.iter().any(|news| matches!(news, TrackerMessage::Sample(..))) {
            holder.heard(from.ip(), now);
            began = (tracker.replace(from) != Some(from)).then_some(TrackerMessage::Began);
        }
        for one in began.into_iter().chain(found) {
            lost += u64::from(news.try_send(one).is_err());
        }
        if lost > 0 && news.try_send(TrackerMessage::Overrun(lost)).is_ok() {
            lost = 0;
        }
    }
}
