//! Carries out requests to Pupil Capture: asks for its time, and executes decisions of [`CaptureRecordingControl`].

use std::collections::VecDeque;
use std::future::pending;
use std::io;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use tokio::sync::mpsc::{Receiver, Sender};
use tokio::time::{interval, sleep_until, timeout_at};

use super::message::{self, ANNOTATION, CaptureNotification};
use super::recorder::{CaptureAction, CaptureRecordingControl, CaptureRequest};
use super::zmtp::{ZmtpConnection, ZmtpMessage};
use crate::compared_clock::{ANSWERS, ClockOffsetEstimator, DeviceClockStep};
use crate::gaze_input::TrackerMessage;

/// Period of time requests to Pupil Capture; a step of Capture's clock is noticed within this time.
const ASK_TIME: Duration = Duration::from_millis(250);
/// Time limit for the subscriptions of Capture's plugins, which arrive right after the connection is made.
const SUBSCRIPTIONS: Duration = Duration::from_millis(200);

/// Connections to Capture for requests and annotations.
pub(super) struct CaptureClient {
    pub remote: ZmtpConnection,
    pub annotations: ZmtpConnection,
    pub news: Sender<TrackerMessage>,
}

impl CaptureClient {
    /// Initialises the clock offset by averaging Capture's first replies to time requests.
    pub async fn set_clock(remote: &mut ZmtpConnection, clock: &Mutex<ClockOffsetEstimator>) -> io::Result<()> {
        for _ in 0..ANSWERS {
            ask_time(remote, clock).await?;
        }
        Ok(())
    }

    /// Starts Capture's annotation plugin unless the plugin runs: starting it twice would replace it and the
    /// annotations that the lab defined in it. Returns whether the plugin already listens.
    pub async fn start_plugin(&mut self) -> io::Result<bool> {
        let until = tokio::time::Instant::now() + SUBSCRIPTIONS;
        while let Ok(found) = timeout_at(until, self.annotations.receive()).await {
            if is_annotated(&found?) {
                return Ok(true);
            }
        }
        let payload = message::start_plugin("Annotation_Capture");
        self.remote.ask(&[b"notify.start_plugin", &payload]).await?;
        Ok(false)
    }

    /// Serves requests to Capture until a request fails.
    pub async fn attend(
        &mut self,
        orders: &mut Receiver<CaptureRequest>,
        mut told: Receiver<CaptureNotification>,
        recorder: &mut CaptureRecordingControl,
        clock: &Mutex<ClockOffsetEstimator>,
        actions: Vec<CaptureAction>,
    ) -> io::Error {
        let mut asking = interval(ASK_TIME);
        let mut actions = VecDeque::from(actions);
        loop {
            while let Some(action) = actions.pop_front() {
                let is_stop = matches!(action, CaptureAction::Stop);
                if let Err(reason) = self.act(action, clock).await {
                    return reason;
                }
                if is_stop {
                    actions.extend(recorder.stop_answered(Instant::now()));
                }
            }
            let due = recorder.due();
            let is_due = async {
                match due {
                    Some(at) => sleep_until(at.into()).await,
                    None => pending().await,
                }
            };
            actions.extend(tokio::select! {
                _ = asking.tick() => match self.check_time(clock).await {
                    Ok(()) => Vec::new(),
                    Err(reason) => return reason,
                },
                order = orders.recv() => match order {
                    Some(order) => recorder.order(order, Instant::now()),
                    None => return io::ErrorKind::BrokenPipe.into(),
                },
                news = told.recv() => match news {
                    Some(news) => recorder.heard(news, Instant::now()),
                    None => return io::ErrorKind::BrokenPipe.into(),
                },
                found = self.annotations.receive() => match found {
                    Ok(found) if is_annotated(&found) => recorder.listens(Instant::now()),
                    Ok(_) => Vec::new(),
                    Err(reason) => return reason,
                },
                () = is_due => recorder.pass(Instant::now()),
            });
        }
    }

    /// Compares the clocks of Capture and this computer; if Capture's clock was set, reports that and asks again until
    /// the mean offset is as exact as before.
    async fn check_time(&mut self, clock: &Mutex<ClockOffsetEstimator>) -> io::Result<()> {
        let Some(DeviceClockStep { by_s, known_at }) = ask_time(&mut self.remote, clock).await? else { return Ok(()) };
        // The receiver of tracker messages may no longer exist, which the listener notices.
        let _ = self.news.send(TrackerMessage::ClockSet { by_s, known_at }).await;
        CaptureClient::set_clock(&mut self.remote, clock).await
    }

    async fn act(&mut self, action: CaptureAction, clock: &Mutex<ClockOffsetEstimator>) -> io::Result<()> {
        match action {
            CaptureAction::Start(name) => self.remote.ask(&[format!("R {name}").as_bytes()]).await.map(drop),
            CaptureAction::Stop => self.remote.ask(&[b"r"]).await.map(drop),
            CaptureAction::Annotate { label, at, not_before } => {
                let stands = not_before.map_or(at, |begun| begun.max(at));
                let late_s = stands.saturating_duration_since(at).as_secs_f64();
                let pupil_s = clock.lock().ok().and_then(|clock| clock.device_s(stands));
                let payload = message::annotation(&label, pupil_s.unwrap_or(0.0), late_s);
                self.annotations.send(&[ANNOTATION.as_bytes(), &payload]).await
            }
            CaptureAction::Tell(state) => {
                let _ = self.news.send(TrackerMessage::Recording(state)).await;
                Ok(())
            }
            CaptureAction::Report(to) => {
                // The task that asked for the report may no longer wait for it.
                let _ = to.send(());
                Ok(())
            }
        }
    }
}

/// Whether a message is the subscription of Capture's annotation plugin.
fn is_annotated(message: &ZmtpMessage) -> bool {
    message.first().and_then(|frame| frame.strip_prefix(&[1])) == Some(ANNOTATION.as_bytes())
}

async fn ask_time(
    remote: &mut ZmtpConnection,
    clock: &Mutex<ClockOffsetEstimator>,
) -> io::Result<Option<DeviceClockStep>> {
    let asked = Instant::now();
    let answer = remote.ask(&[b"t"]).await?;
    let answered = Instant::now();
    let pupil_s = answer.trim().parse::<f64>().ok().filter(|time| time.is_finite());
    let pupil_s = pupil_s.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "a time that is no number"))?;
    Ok(clock.lock().ok().and_then(|mut clock| clock.take(asked, answered, pupil_s)))
}
