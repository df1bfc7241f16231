//! Connection to the eye tracker Pupil Core through Pupil Capture's network API: requests for ports and time,
//! subscription, recording, annotations. The program tries to connect again without limit when Capture is missing,
//! ends, hangs or restarts.

mod capture_desk;
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
use capture_desk::CaptureClient;
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
    /// Host on which Capture runs.
    pub address: String,
    /// Port of Capture's plugin Pupil Remote.
    pub port: u16,
    /// Name of the surface that Capture defines by the display's markers.
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
            let was_there = follower.once().await;
            if let Err(reason) = was_there {
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
    /// Follows Capture until the connection is lost; returns the reason, and whether Capture had been connected.
    async fn once(&mut self) -> Result<(), Lost> {
        let never = |reason: io::Error| Lost { reason, was_there: false };
        let (address, port) = (self.capture.address.clone(), self.capture.port);
        let mut remote = ZmtpConnection::open(&address, port, SocketRole::Req).await.map_err(never)?;
        let version = remote.ask(&[b"v"]).await.map_err(never)?;
        let clock = Mutex::new(ClockOffsetEstimator::new());
        CaptureClient::set_clock(&mut remote, &clock).await.map_err(never)?;
        let sub_port = port_of(&remote.ask(&[b"SUB_PORT"]).await.map_err(never)?).map_err(never)?;
        let pub_port = port_of(&remote.ask(&[b"PUB_PORT"]).await.map_err(never)?).map_err(never)?;
        let mut backbone = ZmtpConnection::open(&address, sub_port, SocketRole::Sub).await.map_err(never)?;
        // All surfaces are subscribed to: if the display's surface is not detected, the names of the other surfaces
        // help to find the error.
        for topic in [SURFACES].iter().chain(&TOPICS) {
            backbone.subscribe(topic).await.map_err(never)?;
        }
        let annotations = ZmtpConnection::open(&address, pub_port, SocketRole::Pub).await.map_err(never)?;
        let mut desk = CaptureClient { remote, annotations, news: self.news.clone() };
        let listens = desk.start_plugin().await.map_err(never)?;
        self.tell(TrackerMessage::Connected(format!("Pupil Capture {version}"))).await;
        let run = [sub_port, pub_port];
        let is_same_run = self.run.replace(run) == Some(run);
        let ended = self.attend(desk, backbone, &clock, is_same_run, listens).await;
        self.recorder.disconnected();
        Err(Lost { reason: ended, was_there: true })
    }

    /// Listens to Capture, compares clocks, and passes requests on, until one of these three fails.
    async fn attend(
        &mut self,
        mut desk: CaptureClient,
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
            reason = desk.attend(&mut self.orders, told, &mut self.recorder, clock, actions) => reason,
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

    async fn tell_lost(&mut self, lost: &Lost) {
        if lost.was_there {
            let reason = match lost.reason.kind() {
                io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset => "Pupil Capture ended".to_string(),
                io::ErrorKind::TimedOut => "Pupil Capture does not answer".to_string(),
                _ => format!("Pupil Capture: {}", lost.reason),
            };
            self.tell(TrackerMessage::Lost(reason)).await;
        }
    }
}

/// Loss of the connection to Capture, or failure to connect.
struct Lost {
    reason: io::Error,
    /// Whether Capture had been connected before the loss.
    was_there: bool,
}

fn port_of(answer: &str) -> io::Result<u16> {
    answer.trim().parse().map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "a port that is none"))
}
