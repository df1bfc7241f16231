//! Requests to Pupil Capture, the eye tracker's program, at events of the trial.

use std::time::Instant;

use tokio::sync::mpsc::Sender;

use crate::run::operator_station::GazeTracker;
use tomcom_devices::pupil::CaptureRequest;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::{Event, Session, TrialPhase};

const RUNNING: &str = "trial running";
const PAUSED: &str = "trial paused";
const LEFT: &str = "session left";

/// Sends requests to Pupil Capture for one recording.
#[derive(Debug, Default)]
pub(super) struct CaptureRequestSender {
    /// Channel to the program Pupil Capture; `None` if it is not the tracker.
    orders: Option<Sender<CaptureRequest>>,
    /// Name of the recording, under which Pupil Capture records, too.
    name: String,
    /// Whether a trial is recorded in Pupil Capture that has not ended.
    pub is_on: bool,
    /// Label of the trial's phase that was sent to Pupil Capture last.
    phase: Option<&'static str>,
    signal: Option<String>,
    probe: Option<u32>,
}

impl CaptureRequestSender {
    /// Prepares Pupil Capture for a recording with this name; in a continued recording, Pupil Capture records the trial
    /// from now on.
    pub fn begin(tracker: &GazeTracker, name: String, session: &Session, now: Instant) -> CaptureRequestSender {
        let orders = tracker.orders.clone();
        let mut capture = CaptureRequestSender { orders, name, ..CaptureRequestSender::default() };
        capture.probe = session.probes.open.as_ref().map(|open| open.number);
        capture.phase = match session.phase {
            TrialPhase::Running => Some(RUNNING),
            TrialPhase::Paused => Some(PAUSED),
            _ => None,
        };
        if let Some(phase) = capture.phase {
            capture.record(session.tracker.is_recording());
            capture.annotate(phase.to_string(), now);
        }
        capture
    }

    pub fn tell(&mut self, event: &Event, at: Instant) {
        if self.orders.is_none() {
            return;
        }
        let ends = matches!(event, Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded);
        let label = match event {
            Event::TrialStarted => {
                self.record(false);
                self.phase = Some(RUNNING);
                "trial started".to_string()
            }
            Event::TrialPaused => {
                self.phase = Some(PAUSED);
                PAUSED.to_string()
            }
            Event::TrialResumed if self.probe.is_some() => "the probe goes on".to_string(),
            Event::TrialResumed => {
                self.phase = Some(RUNNING);
                "trial resumed".to_string()
            }
            Event::Probe(ProbeEvent::Begun { probe, .. }) => {
                (self.phase, self.probe) = (Some(PAUSED), Some(*probe));
                format!("probe {probe} begun")
            }
            Event::Probe(ProbeEvent::Ended { probe }) => {
                (self.phase, self.probe) = (Some(RUNNING), None);
                format!("probe {probe} ended")
            }
            Event::TrialEnded { .. } => "trial ended".to_string(),
            Event::TrialAborted { .. } => "trial aborted".to_string(),
            Event::SignalShown { signal, .. } => {
                let shown = format!("signal shown: {}", signal.target().unwrap_or("next press"));
                self.signal = Some(shown.clone());
                shown
            }
            Event::SignalEnded { .. } => {
                self.signal = None;
                "signal ended".to_string()
            }
            Event::SessionEnded if self.is_on => {
                self.annotate(LEFT.to_string(), at);
                "trial ended".to_string()
            }
            Event::SessionEnded => String::new(),
            _ => return,
        };
        if ends {
            (self.phase, self.signal, self.probe) = (None, None, None);
        }
        if !label.is_empty() {
            self.annotate(label, at);
        }
        if ends && std::mem::take(&mut self.is_on) {
            self.order(CaptureRequest::StopRecording);
        }
    }

    /// Ends Pupil Capture's recording when the wizard leaves a trial that can be continued later.
    pub fn leave(&mut self, at: Instant) {
        if std::mem::take(&mut self.is_on) {
            (self.phase, self.signal, self.probe) = (None, None, None);
            self.annotate(LEFT.to_string(), at);
            self.order(CaptureRequest::StopRecording);
        }
    }

    /// Requests a recording of the trial; `goes_on` says that one may still run that this program began for it.
    fn record(&mut self, goes_on: bool) {
        self.is_on = true;
        self.order(CaptureRequest::Record { name: self.name.clone(), goes_on });
    }

    fn annotate(&self, label: String, at: Instant) {
        let phase = self.phase.map(str::to_string);
        let state = phase.into_iter().flat_map(|phase| [Some(phase), self.signal.clone()]).flatten().collect();
        self.order(CaptureRequest::Annotate { label, at, state });
    }

    /// Sends a request to Pupil Capture if it is connected; the console's line about devices shows a lost connection.
    fn order(&self, order: CaptureRequest) {
        if let Some(orders) = &self.orders {
            let _ = orders.try_send(order);
        }
    }
}
