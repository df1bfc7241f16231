//! Connection to the eye tracker Pupil Core through Pupil Capture's network API: requests for ports and time,
//! subscription, recording, annotations. The program tries to connect again without limit when Capture is missing,
//! ends, hangs or restarts.

mod capture_client;
pub mod eye_events;
mod listener;
pub mod message;
pub mod recorder;
pub mod zmtp;

use std::io;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::time::sleep;

use super::compared_clock::ClockOffsetEstimator;
use super::gaze_input::{TrackerMessage, WAITING};
use capture_client::CaptureClient;
use listener::Listener;
use message::{SURFACES, TOPICS};
use recorder::CaptureRecordingControl;
pub use recorder::CaptureRequest;
use tomcom_core::gaze::tags::SurfaceHomography;
use zmtp::{SocketRole, ZmtpConnection};

/// Time between attempts to connect to Pupil Capture.
const RETRY: Duration = Duration::from_millis(300);
/// Capacity of the channel of requests to Capture, which is emptied at each attempt to connect.
const ORDERS: usize = 256;
/// Capacity of the queue of notifications from Capture's recorder.
const RECORDER_NEWS: usize = 16;

/// Network address of Pupil Capture, and what to receive from it.
#[derive(Clone, Debug)]
pub struct CaptureConfiguration {
    pub address: String,
    pub port: u16,
    pub surface: String,
    /// Map from the surface to the wall display.
    pub map: SurfaceHomography,
    /// Whether Capture is to make a recording; its recordings are annotated in any case.
    pub records: bool,
}

/// Starts following Capture; returns the channels for Capture's messages and for requests. Following ends when the
/// receiver of messages is dropped.
pub fn follow(capture: CaptureConfiguration) -> (Receiver<TrackerMessage>, Sender<CaptureRequest>) {
    let (news, receiver) = channel(WAITING);
    let (sender, orders) = channel(ORDERS);
    tokio::spawn(async move {
        let recorder = CaptureRecordingControl::new(capture.records);
        let mut follower = Follower { capture, news, orders, recorder, run: None, lost: 0 };
        while !follower.news.is_closed() {
            // A Capture that was not there before is not lost.
            if let Ok(reason) = follower.once().await {
                follower.tell_lost(&reason).await;
            }
            sleep(RETRY).await;
            follower.queue_orders();
        }
    });
    (receiver, sender)
}

/// Name and version of the Capture program at this network port.
///
/// # Errors
/// Why Capture does not respond.
pub async fn version(address: &str, port: u16) -> io::Result<String> {
    let mut remote = ZmtpConnection::open(address, port, SocketRole::Req).await?;
    Ok(format!("Pupil Capture {}", remote.ask(&[b"v"]).await?))
}

struct Follower {
    capture: CaptureConfiguration,
    news: Sender<TrackerMessage>,
    orders: Receiver<CaptureRequest>,
    recorder: CaptureRecordingControl,
    /// Ports of the message bus of the Capture that was connected last, by which a restarted Capture is recognised.
    run: Option<[u16; 2]>,
    /// Number of messages that were dropped and have not been reported yet.
    lost: u64,
}

impl Follower {
    /// Connects to Capture and follows it until the connection is lost; returns the reason.
    ///
    /// # Errors
    /// Capture could not be connected.
    async fn once(&mut self) -> io::Result<io::Error> {
        let (address, port) = (self.capture.address.clone(), self.capture.port);
        let mut remote = ZmtpConnection::open(&address, port, SocketRole::Req).await?;
        let version = remote.ask(&[b"v"]).await?;
        let clock = Mutex::new(ClockOffsetEstimator::new());
        CaptureClient::set_clock(&mut remote, &clock).await?;
        let sub_port = port_of(&remote.ask(&[b"SUB_PORT"]).await?)?;
        let pub_port = port_of(&remote.ask(&[b"PUB_PORT"]).await?)?;
        let mut backbone = ZmtpConnection::open(&address, sub_port, SocketRole::Sub).await?;
        // All surfaces are subscribed to: if the display's surface is not detected, the names of the other surfaces
        // help to find the error.
        for topic in [SURFACES].iter().chain(&TOPICS) {
            backbone.subscribe(topic).await?;
        }
        let annotations = ZmtpConnection::open(&address, pub_port, SocketRole::Pub).await?;
        let mut client = CaptureClient { remote, annotations, news: self.news.clone() };
        let listens = client.start_plugin().await?;
        self.tell(TrackerMessage::Connected(format!("Pupil Capture {version}"))).await;
        let run = [sub_port, pub_port];
        let is_same_run = self.run.replace(run) == Some(run);
        let reason = self.attend(client, backbone, &clock, is_same_run, listens).await;
        self.recorder.disconnected();
        Ok(reason)
    }

    /// Listens to Capture, compares clocks, and passes requests on, until one of these three fails.
    async fn attend(
        &mut self,
        mut client: CaptureClient,
        mut backbone: ZmtpConnection,
        clock: &Mutex<ClockOffsetEstimator>,
        is_same_run: bool,
        listens: bool,
    ) -> io::Error {
        self.queue_orders();
        let actions = self.recorder.connected(Instant::now(), is_same_run, listens);
        let (recorder, told) = channel(RECORDER_NEWS);
        let surface = (self.capture.surface.as_str(), self.capture.map);
        let mut listener = Listener::new(self.news.clone(), recorder, surface, clock, &mut self.lost);
        let reason = tokio::select! {
            reason = listener.listen(&mut backbone) => reason,
            reason = client.attend(&mut self.orders, told, &mut self.recorder, clock, actions) => reason,
        };
        listener.end();
        reason
    }

    /// Moves the requests of the session to the recorder's queue. Their channel is bounded, and a session with a full
    /// channel would lose its newest requests while Capture is missing.
    fn queue_orders(&mut self) {
        while let Ok(order) = self.orders.try_recv() {
            self.recorder.queue(order);
        }
    }

    async fn tell(&mut self, news: TrackerMessage) {
        // If the receiver of gaze messages was dropped, the outer loop ends.
        let _ = self.news.send(news).await;
    }

    async fn tell_lost(&mut self, reason: &io::Error) {
        let words = match reason.kind() {
            io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset => "Pupil Capture ended".to_string(),
            io::ErrorKind::TimedOut => "Pupil Capture does not answer".to_string(),
            _ => format!("Pupil Capture: {reason}"),
        };
        self.tell(TrackerMessage::Lost(words)).await;
    }
}

fn port_of(answer: &str) -> io::Result<u16> {
    answer.trim().parse().map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "a port that is none"))
}
