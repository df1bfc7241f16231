//! Gaze and what else a tracker tells, on its way into the session; and what the tracker's program is told of the trial.

use std::sync::Arc;

use tokio::sync::mpsc::Sender;
use tokio::time::Instant;

use super::Live;
use crate::base::time::SessionTime;
use crate::edge::gaze_file::GazeFile;
use crate::edge::gaze_input::{GazeNews, SampleTime};
use crate::edge::pupil::CaptureRequest;
use crate::gaze::GazeSample;
use crate::gaze::device_clock::DeviceClock;
use crate::gaze::quality::{DropCounts, RateLimit};
use crate::run::desk::GazeTracker;
use crate::session::tracker::TrackerEvent;
use crate::session::{Event, Phase, Stamped};

/// So many news are taken at once at most: keys come before them.
const PACKET: usize = 32;

/// The recording's side of the tracker.
#[derive(Debug, Default)]
pub(super) struct GazeInput {
    clock: DeviceClock,
    limit: RateLimit,
    dropped: DropCounts,
    /// Gaze that is replayed, and the place of the next sample in it.
    file: Option<Arc<GazeFile>>,
    next: usize,
    /// Where Capture takes orders.
    orders: Option<Sender<CaptureRequest>>,
    is_recording: bool,
}

impl Live {
    /// Takes up with the tracker at the beginning of a recording: what is known of it is told again.
    pub(super) fn greet(&mut self, tracker: &GazeTracker) {
        self.gaze.file = tracker.file();
        self.gaze.orders = tracker.orders();
        if let Some(file) = &self.gaze.file {
            self.gaze.dropped.malformed = file.malformed;
        }
        let session = self.engine.session();
        if let Some(file) = self.gaze.file.as_ref().filter(|_| session.phase != Phase::Ready) {
            let clock_s = session.trial_clock(session.time).as_secs_f64();
            self.gaze.next = file.samples.iter().take_while(|(at_s, _)| *at_s < clock_s).count();
        }
        for news in tracker.known() {
            self.take_gaze(news);
        }
        // A trial that goes on after a cut.
        if matches!(self.engine.session().phase, Phase::Running | Phase::Paused) {
            self.order_recording();
        }
    }

    /// Takes news of the tracker, and what came with them: samples come in packets.
    pub(super) fn take_all(&mut self, first: GazeNews, tracker: &mut GazeTracker) {
        let mut next = Some(first);
        for _ in 0..PACKET {
            let Some(news) = next else { return };
            self.take_gaze(news);
            next = tracker.ready();
        }
        if let Some(news) = next {
            self.take_gaze(news);
        }
    }

    /// Takes news of the tracker.
    pub(super) fn take_gaze(&mut self, news: GazeNews) {
        match news {
            GazeNews::Sample(sample, at) => self.sample(sample, at),
            GazeNews::Malformed(count) => self.gaze.dropped.malformed += count,
            GazeNews::Overrun(count) => self.gaze.dropped.overrun += count,
            GazeNews::Began => self.gaze.clock = DeviceClock::default(),
            GazeNews::Connected(device) => self.tracker(TrackerEvent::Connected { device }),
            GazeNews::Lost(reason) => self.tracker(TrackerEvent::Lost { reason }),
            GazeNews::SeesDisplay(true) => self.tracker(TrackerEvent::DisplayFound),
            GazeNews::SeesDisplay(false) => self.tracker(TrackerEvent::DisplayLost),
            GazeNews::Fixation(found) => {
                let (duration_ms, dispersion_deg) = (found.duration_ms, found.dispersion_deg);
                let (device_ns, began_ns) = (found.began.device_ns, self.session_time(found.began));
                let (at, confidence) = (found.at, found.confidence);
                let event = TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, device_ns, began_ns };
                self.tracker(event);
            }
            GazeNews::Blink { is_onset, confidence, taken } => {
                let (device_ns, taken_ns) = (taken.device_ns, self.session_time(taken));
                self.tracker(TrackerEvent::Blink { closed: is_onset, confidence, device_ns, taken_ns });
            }
        }
    }

    fn tracker(&mut self, event: TrackerEvent) {
        self.input(Event::Tracker(event));
    }

    fn sample(&mut self, sample: GazeSample, at: Option<std::time::Instant>) {
        let now = self.clock.now();
        if !self.gaze.limit.admits(now) {
            self.gaze.dropped.too_frequent += 1;
            return;
        }
        let taken_ns = match (at, sample.device_ns) {
            (Some(at), _) => Some(ago(now, at)),
            (None, Some(device_ns)) => Some(self.gaze.clock.session_time(device_ns, now)),
            (None, None) => None,
        };
        self.input(Event::Gaze(GazeSample { taken_ns, ..sample }));
    }

    fn session_time(&mut self, taken: SampleTime) -> SessionTime {
        let now = self.clock.now();
        taken.at.map_or(now, |at| ago(now, at))
    }

    /// Tells how much could not be recorded, if it got more.
    pub(super) fn tell_drops(&mut self) {
        let session = self.engine.session();
        if self.gaze.dropped != session.tracker.dropped && session.phase != Phase::Closed {
            self.tracker(TrackerEvent::Dropped(self.gaze.dropped));
        }
    }

    /// When the next sample of replayed gaze is due; nothing while the trial stands.
    pub(super) fn next_recorded(&self) -> Option<Instant> {
        let (at_s, _) = self.gaze.file.as_ref()?.samples.get(self.gaze.next)?;
        let session = self.engine.session();
        let time = session.trial_start + session.paused_total + SessionTime::from_secs_f64(*at_s);
        session.is_running().then(|| Instant::from_std(self.clock.instant_of(time)))
    }

    /// Takes the next sample of replayed gaze.
    pub(super) fn take_recorded(&mut self) {
        let next = self.gaze.file.as_ref().and_then(|file| file.samples.get(self.gaze.next)).copied();
        let Some((at_s, sample)) = next else { return };
        self.gaze.next += 1;
        let session = self.engine.session();
        let taken = session.trial_start + session.paused_total + SessionTime::from_secs_f64(at_s);
        self.input(Event::Gaze(GazeSample { taken_ns: Some(taken), ..sample }));
    }

    /// Tells Capture what happens in the trial.
    pub(super) fn tell_tracker(&mut self, stamped: &Stamped) {
        if self.gaze.orders.is_none() {
            return;
        }
        let label = match &stamped.event {
            Event::TrialStarted => {
                self.order_recording();
                "trial started".to_string()
            }
            Event::TrialPaused => "trial paused".to_string(),
            Event::TrialResumed => "trial resumed".to_string(),
            Event::TrialEnded { .. } => "trial ended".to_string(),
            Event::TrialAborted { .. } => "trial aborted".to_string(),
            Event::SignalShown { signal, .. } => format!("signal shown: {}", signal.target()),
            Event::SignalEnded { .. } => "signal ended".to_string(),
            Event::SessionEnded => String::new(),
            _ => return,
        };
        if !label.is_empty() {
            self.order(CaptureRequest::Annotate(label, self.clock.instant_of(stamped.time)));
        }
        let ends = matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. } | Event::SessionEnded);
        if ends && std::mem::take(&mut self.gaze.is_recording) {
            self.order(CaptureRequest::StopRecording);
        }
    }

    fn order_recording(&mut self) {
        let name = self.log.folder().file_name().unwrap_or_default().to_string_lossy().into_owned();
        self.gaze.is_recording = true;
        self.order(CaptureRequest::Record(name));
    }

    /// Capture is told as long as it listens; that it does not is said in the health line.
    fn order(&self, order: CaptureRequest) {
        if let Some(orders) = &self.gaze.orders {
            let _ = orders.try_send(order);
        }
    }
}

/// The session time of a moment that is not after now.
fn ago(now: SessionTime, at: std::time::Instant) -> SessionTime {
    now - SessionTime(at.elapsed().as_nanos().min(u128::from(u64::MAX)) as u64)
}
