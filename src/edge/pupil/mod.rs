//! Pupil Core through Pupil Capture's network API: requests for ports and time, subscription, recording, annotations. The connection
//! is retried without limit when Capture is missing, ends, hangs or restarts.

mod clock;
pub mod message;
pub mod zmtp;

use std::io;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::sync::oneshot;
use tokio::time::{interval, sleep, timeout};

use super::gaze_input::{GazeNews, SampleTime, TrackerFixation, WAITING};
use crate::gaze::GazeSample;
use crate::gaze::surface::SurfaceMap;
use clock::{ANSWERS, PupilClock};
use message::PupilMessage;
use zmtp::{SocketRole, ZmtpConnection, ZmtpMessage};

/// Time between connection attempts.
const RETRY: Duration = Duration::from_millis(300);
/// The surface counts as lost after this long without a datum.
const UNSEEN: Duration = Duration::from_secs(1);
/// Period of time requests to Capture.
const ASK_TIME: Duration = Duration::from_secs(1);
/// Capacity of the queue of requests to Capture.
const ORDERS: usize = 256;

/// Address of Capture, and what to receive from it.
#[derive(Clone, Debug)]
pub struct CaptureAddress {
    /// The host on which Capture runs.
    pub address: String,
    /// Port of Pupil Remote.
    pub port: u16,
    /// The name of the surface that Capture defines by the tags.
    pub surface: String,
    /// Map from the surface to the display.
    pub map: SurfaceMap,
    /// Whether Capture records and is annotated.
    pub records: bool,
}

/// A request to Capture.
#[derive(Debug)]
pub enum CaptureRequest {
    /// Start a recording with this name.
    Record(String),
    /// End the recording.
    StopRecording,
    /// Annotate its recording with an event at this instant.
    Annotate(String, Instant),
    /// Report when all earlier requests have been carried out.
    Report(oneshot::Sender<()>),
}

/// Starts following Capture; returns the channels of its messages and of requests. Ends when the receiver is dropped.
pub fn follow(capture: CaptureAddress) -> (Receiver<GazeNews>, Sender<CaptureRequest>) {
    let (news, receiver) = channel(WAITING);
    let (sender, orders) = channel(ORDERS);
    tokio::spawn(async move {
        let mut follower = Follower { capture, news, orders, recording: None, lost: 0, waiting: None };
        while !follower.news.is_closed() {
            let was_there = follower.once().await;
            if let Err(reason) = was_there {
                follower.tell_lost(&reason).await;
            }
            sleep(RETRY).await;
        }
    });
    (receiver, sender)
}

/// Name and version of Capture at this port.
///
/// # Errors
/// Reason why it does not respond.
pub async fn version(address: &str, port: u16) -> io::Result<String> {
    let mut remote = ZmtpConnection::open(address, port, SocketRole::Req).await?;
    Ok(format!("Pupil Capture {}", remote.ask(&[b"v"]).await?))
}

struct Follower {
    capture: CaptureAddress,
    news: Sender<GazeNews>,
    orders: Receiver<CaptureRequest>,
    /// Name of the present recording, also after a restart of Capture.
    recording: Option<String>,
    /// Number of dropped messages that have not been reported yet.
    lost: u64,
    /// The fixation that may still last.
    waiting: Option<TrackerFixation>,
}

impl Follower {
    /// Follows Capture until the connection is lost; returns the reason, and whether it was connected.
    async fn once(&mut self) -> Result<(), Lost> {
        let never = |reason: io::Error| Lost { reason, was_there: false };
        let (address, port) = (self.capture.address.clone(), self.capture.port);
        let mut remote = ZmtpConnection::open(&address, port, SocketRole::Req).await.map_err(never)?;
        let version = remote.ask(&[b"v"]).await.map_err(never)?;
        let clock = Mutex::new(PupilClock::new());
        for _ in 0..ANSWERS {
            ask_time(&mut remote, &clock).await.map_err(never)?;
        }
        let sub_port = port_of(&remote.ask(&[b"SUB_PORT"]).await.map_err(never)?).map_err(never)?;
        let pub_port = port_of(&remote.ask(&[b"PUB_PORT"]).await.map_err(never)?).map_err(never)?;
        let mut backbone = ZmtpConnection::open(&address, sub_port, SocketRole::Sub).await.map_err(never)?;
        for topic in [format!("surfaces.{}", self.capture.surface), "fixations".to_string(), "blinks".to_string()] {
            backbone.subscribe(&topic).await.map_err(never)?;
        }
        let annotations = ZmtpConnection::open(&address, pub_port, SocketRole::Pub).await.map_err(never)?;
        if self.capture.records {
            let payload = message::start_plugin("Annotation_Capture");
            remote.ask(&[b"notify.start_plugin", &payload]).await.map_err(never)?;
        }
        self.tell(GazeNews::Connected(format!("Pupil Capture {version}"))).await;
        let ended = self.attend(remote, backbone, annotations, &clock).await;
        self.waiting = None;
        Err(Lost { reason: ended, was_there: true })
    }

    /// Listens, asks for the time, and passes orders on, until one of it fails.
    async fn attend(
        &mut self,
        remote: ZmtpConnection,
        mut backbone: ZmtpConnection,
        annotations: ZmtpConnection,
        clock: &Mutex<PupilClock>,
    ) -> io::Error {
        let (news, surface) = (self.news.clone(), self.capture.surface.clone());
        let mut told =
            Listener { news, map: self.capture.map, lost: &mut self.lost, waiting: &mut self.waiting, sees: None };
        let listen = async {
            let mut seen = Instant::now();
            loop {
                match timeout(UNSEEN, backbone.receive()).await {
                    Ok(Ok(message)) => {
                        let read = read(&message, &surface);
                        if read.sees_surface {
                            seen = Instant::now();
                        }
                        told.pass(read, clock);
                    }
                    Ok(Err(reason)) => return reason,
                    Err(_) => {}
                }
                let sees = seen.elapsed() < UNSEEN;
                told.sees_display(sees).await;
                if told.news.is_closed() {
                    return io::ErrorKind::BrokenPipe.into();
                }
            }
        };
        let mut desk = Desk { remote, annotations, records: self.capture.records };
        let order = desk.attend(&mut self.orders, &mut self.recording, clock);
        tokio::select! {
            reason = listen => reason,
            reason = order => reason,
        }
    }

    async fn tell(&mut self, news: GazeNews) {
        // The receiver was dropped; the outer loop ends.
        let _ = self.news.send(news).await;
    }

    async fn tell_lost(&mut self, lost: &Lost) {
        if lost.was_there {
            let reason = match lost.reason.kind() {
                io::ErrorKind::UnexpectedEof | io::ErrorKind::ConnectionReset => "Pupil Capture ended".to_string(),
                io::ErrorKind::TimedOut => "Pupil Capture does not answer".to_string(),
                _ => format!("Pupil Capture: {}", lost.reason),
            };
            self.tell(GazeNews::Lost(reason)).await;
        }
    }
}

/// Loss of the connection to Capture.
struct Lost {
    reason: io::Error,
    /// Whether it was connected before.
    was_there: bool,
}

/// What is told of messages.
struct Listener<'a> {
    news: Sender<GazeNews>,
    map: SurfaceMap,
    lost: &'a mut u64,
    waiting: &'a mut Option<TrackerFixation>,
    /// Whether the display has been reported as detected.
    sees: Option<bool>,
}

impl Listener<'_> {
    async fn sees_display(&mut self, sees: bool) {
        if self.sees != Some(sees) {
            self.sees = Some(sees);
            let _ = self.news.send(GazeNews::SeesDisplay(sees)).await;
        }
    }

    /// Passes on a parsed message. If the queue is full, messages are counted and dropped, so that Capture is never blocked.
    fn pass(&mut self, told: PupilMessage, clock: &Mutex<PupilClock>) {
        let mut malformed = told.malformed;
        let taken = |timestamp: f64| SampleTime { device_ns: (timestamp * 1e9) as u64, at: moment(clock, timestamp) };
        for gaze in told.gaze {
            let Some([x, y]) = self.map.to_display(gaze.norm_pos) else {
                malformed += 1;
                continue;
            };
            let taken = taken(gaze.timestamp);
            let sample = GazeSample { device_ns: Some(taken.device_ns), ..GazeSample::new(x, y, gaze.confidence) };
            self.offer(GazeNews::Sample(sample, taken.at));
        }
        for found in told.fixations {
            let on_display = found.on_surface.and_then(|place| self.map.to_display(place));
            let began = taken(found.timestamp);
            let before = self.waiting.filter(|before| before.id == found.id);
            let fixation = TrackerFixation {
                id: found.id,
                at: on_display.or(before.and_then(|before| before.at)),
                duration_ms: found.duration_ms,
                dispersion_deg: found.dispersion_deg,
                confidence: found.confidence,
                began,
            };
            // The same id continues the fixation; another id ends it.
            if let Some(over) = self.waiting.replace(fixation).filter(|over| over.id != fixation.id) {
                self.offer(GazeNews::Fixation(over));
            }
        }
        if let Some(blink) = told.blink {
            let taken = taken(blink.timestamp);
            self.offer(GazeNews::Blink { is_onset: blink.is_onset, confidence: blink.confidence, taken });
        }
        if malformed > 0 {
            self.offer(GazeNews::Malformed(malformed));
        }
        if *self.lost > 0 && self.news.try_send(GazeNews::Overrun(*self.lost)).is_ok() {
            *self.lost = 0;
        }
    }

    fn offer(&mut self, news: GazeNews) {
        if self.news.try_send(news).is_err() {
            *self.lost += 1;
        }
    }
}

fn read(message: &ZmtpMessage, surface: &str) -> PupilMessage {
    match message.as_slice() {
        [topic, payload, ..] => message::read(topic, payload, surface),
        _ => PupilMessage { malformed: 1, ..PupilMessage::default() },
    }
}

fn moment(clock: &Mutex<PupilClock>, pupil_s: f64) -> Option<Instant> {
    clock.lock().ok()?.instant(pupil_s)
}

async fn ask_time(remote: &mut ZmtpConnection, clock: &Mutex<PupilClock>) -> io::Result<()> {
    let asked = Instant::now();
    let answer = remote.ask(&[b"t"]).await?;
    let answered = Instant::now();
    let pupil_s = answer.trim().parse::<f64>().ok().filter(|time| time.is_finite());
    let pupil_s = pupil_s.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "a time that is no number"))?;
    if let Ok(mut clock) = clock.lock() {
        clock.take(asked, answered, pupil_s);
    }
    Ok(())
}

fn port_of(answer: &str) -> io::Result<u16> {
    answer.trim().parse().map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "a port that is none"))
}

/// Sends time requests and other requests to Capture.
struct Desk {
    remote: ZmtpConnection,
    annotations: ZmtpConnection,
    records: bool,
}

impl Desk {
    async fn attend(
        &mut self,
        orders: &mut Receiver<CaptureRequest>,
        recording: &mut Option<String>,
        clock: &Mutex<PupilClock>,
    ) -> io::Error {
        // After a restart of Capture the recording is started again.
        if let Some(name) = recording.clone()
            && let Err(reason) = self.record(&name).await
        {
            return reason;
        }
        let mut hours = interval(ASK_TIME);
        loop {
            let done = tokio::select! {
                _ = hours.tick() => ask_time(&mut self.remote, clock).await,
                order = orders.recv() => match order {
                    Some(order) => self.obey(order, recording, clock).await,
                    None => return io::ErrorKind::BrokenPipe.into(),
                },
            };
            if let Err(reason) = done {
                return reason;
            }
        }
    }

    async fn obey(
        &mut self,
        order: CaptureRequest,
        recording: &mut Option<String>,
        clock: &Mutex<PupilClock>,
    ) -> io::Result<()> {
        match order {
            // Who asked may be gone by now.
            CaptureRequest::Report(to) => drop(to.send(())),
            _ if !self.records => {}
            CaptureRequest::Record(name) => {
                *recording = Some(name.clone());
                self.record(&name).await?;
            }
            CaptureRequest::StopRecording => {
                *recording = None;
                self.remote.ask(&[b"r"]).await?;
            }
            CaptureRequest::Annotate(label, at) => {
                let pupil_s = clock.lock().ok().and_then(|clock| clock.pupil_s(at));
                let payload = message::annotation(&label, pupil_s.unwrap_or(0.0));
                self.annotations.send(&[b"annotation", &payload]).await?;
            }
        }
        Ok(())
    }

    async fn record(&mut self, name: &str) -> io::Result<()> {
        self.remote.ask(&[format!("R {name}").as_bytes()]).await.map(drop)
    }
}
