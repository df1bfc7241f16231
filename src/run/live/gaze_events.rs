//! Converts messages of the eye tracker to events of the session.

use std::sync::Arc;
use std::time::Instant;

use crate::run::operator_station::GazeTracker;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_core::gaze::quality::{DroppedInputCounts, GazeRateLimiter};
use tomcom_devices::gaze_file::GazeFile;
use tomcom_devices::gaze_input::{TrackerMessage, TrackerTime};
use tomcom_session::tracker::{MissingConfidence, TrackerEvent};
use tomcom_session::{Event, Session, TrialPhase};

/// Gaze input of one recording.
#[derive(Debug, Default)]
pub(super) struct GazeInput {
    limit: GazeRateLimiter,
    dropped: DroppedInputCounts,
    /// Whether the wizard was already told of a wrong time stamp of gaze.
    has_complained: bool,
    /// What is wrong with the time stamps of the latest sender of gaze.
    stamp_fault: Option<StampFault>,
    /// Whether the wizard was already told that samples without confidence are not read.
    has_told_missing: bool,
    /// How samples without confidence are taken.
    missing_confidence: MissingConfidence,
    /// The file from which gaze is replayed, with the index of the next sample.
    file: Option<Arc<GazeFile>>,
    next: usize,
}

impl GazeInput {
    /// The gaze input of a recording that begins or continues with this session.
    pub fn at(tracker: &GazeTracker, session: &Session) -> GazeInput {
        let missing_confidence = session.spec.tracker.missing_confidence;
        let Some(file) = tracker.file.clone() else { return GazeInput { missing_confidence, ..GazeInput::default() } };
        let dropped = DroppedInputCounts { malformed: file.summary.malformed, ..DroppedInputCounts::default() };
        let clock_s = session.trial_clock(session.time).as_secs_f64();
        let is_past = |(at_s, _): &&(f64, GazeSample)| session.phase != TrialPhase::Ready && *at_s < clock_s;
        let next = file.samples.iter().take_while(is_past).count();
        GazeInput { dropped, file: Some(file), next, missing_confidence, ..GazeInput::default() }
    }

    /// Message to the wizard about the first gaze sample with a wrong time stamp, and about the first one without
    /// confidence if such samples are not read.
    pub fn complaint(&mut self, news: &TrackerMessage) -> Option<String> {
        let is_first = |told: &mut bool| !std::mem::replace(told, true);
        match news {
            TrackerMessage::WrongTime(t) => is_first(&mut self.has_complained)
                .then(|| format!("gaze sample refused: t = {t} is no time in seconds, nor in ms, us or ns since 1970")),
            TrackerMessage::Sample(sample, _)
                if sample.confidence.is_nan() && self.missing_confidence == MissingConfidence::Bad =>
            {
                is_first(&mut self.has_told_missing).then(|| {
                    "gaze without confidence is recorded and not read: missing_confidence is \"bad\"".to_string()
                })
            }
            _ => None,
        }
    }

    /// The session's event for a tracker message; `None` for messages that are only counted.
    pub fn event(&mut self, news: TrackerMessage, now: SessionTime) -> Option<Event> {
        let tracker = match news {
            TrackerMessage::Sample(sample, at) => return self.sample(sample, at, now),
            TrackerMessage::Malformed(count) => {
                self.dropped.malformed += count;
                return None;
            }
            TrackerMessage::WrongTime(_) => {
                self.dropped.malformed += 1;
                return None;
            }
            TrackerMessage::Overrun(count) => {
                self.dropped.overrun += count;
                return None;
            }
            // Senders that are no trackers, or leave, are told at the console only, not in the log.
            TrackerMessage::Rejected { .. } | TrackerMessage::Closed => return None,
            // Every sender's stamps are judged; what is the same for the next sender is no news.
            TrackerMessage::Stamps(fault) if fault == self.stamp_fault => return None,
            TrackerMessage::Stamps(fault) => {
                self.stamp_fault = fault;
                TrackerEvent::Stamps { fault }
            }
            TrackerMessage::SeveralStreams(streams) => TrackerEvent::SeveralStreams { streams },
            TrackerMessage::Connected(device) => TrackerEvent::Connected { device },
            TrackerMessage::Lost(reason) => TrackerEvent::Lost { reason },
            TrackerMessage::SeesDisplay(true) => TrackerEvent::DisplayFound,
            TrackerMessage::SeesDisplay(false) => TrackerEvent::DisplayLost,
            TrackerMessage::OtherSurfaces(names) => TrackerEvent::OtherSurfaces { names },
            TrackerMessage::ClockSet { by_s, known_at } => {
                TrackerEvent::ClockSet { by_s, uncertain_since_ns: ago(now, known_at) }
            }
            TrackerMessage::Recording(state) => TrackerEvent::Recording { state },
            TrackerMessage::Fixation(found) => {
                let (duration_ms, dispersion_deg) = (found.duration_ms, found.dispersion_deg);
                let (device_ns, began_ns) = (found.began.device_ns, session_time(found.began, now));
                let (at, confidence) = (found.at, found.confidence);
                TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, device_ns, began_ns }
            }
            TrackerMessage::Blink { is_onset, confidence, taken } => {
                let (device_ns, taken_ns) = (taken.device_ns, session_time(taken, now));
                TrackerEvent::Blink { closed: is_onset, confidence, device_ns, taken_ns }
            }
        };
        Some(Event::Tracker(tracker))
    }

    /// The event of a gaze sample, which was taken at the instant `at`, if that is known.
    fn sample(&mut self, sample: GazeSample, at: Option<Instant>, now: SessionTime) -> Option<Event> {
        if !self.limit.admits(now) {
            self.dropped.too_frequent += 1;
            return None;
        }
        let confidence = match sample.confidence {
            missing if missing.is_nan() => self.missing_confidence.confidence(),
            known => known,
        };
        Some(Event::Gaze(GazeSample { taken_ns: at.map(|at| ago(now, at)), confidence, ..sample }))
    }

    /// An event with the counts of gaze input that was dropped, if they have grown.
    pub fn drops(&self, session: &Session) -> Option<Event> {
        let is_news = self.dropped != session.tracker.dropped && session.phase != TrialPhase::Closed;
        is_news.then_some(Event::Tracker(TrackerEvent::Dropped(self.dropped)))
    }

    /// Session time of the next sample of replayed gaze; `None` while the trial is not running.
    pub fn file_due(&self, session: &Session) -> Option<SessionTime> {
        let (at_s, _) = self.file.as_ref()?.samples.get(self.next)?;
        session.is_running().then(|| session_time_in_file(session, *at_s))
    }

    pub fn next_of_file(&mut self, session: &Session) -> Option<Event> {
        let (at_s, sample) = self.file.as_ref()?.samples.get(self.next).copied()?;
        self.next += 1;
        let taken = session_time_in_file(session, at_s);
        Some(Event::Gaze(GazeSample { taken_ns: Some(taken), ..sample }))
    }
}

/// Session time of a sample from a gaze file, given the sample's time on the trial's clock in seconds.
fn session_time_in_file(session: &Session, at_s: f64) -> SessionTime {
    session.trial_start + session.paused_total + SessionTime::from_secs_f64(at_s)
}

fn session_time(taken: TrackerTime, now: SessionTime) -> SessionTime {
    taken.at.map_or(now, |at| ago(now, at))
}

/// Session time of an instant before `now`.
pub(super) fn ago(now: SessionTime, at: Instant) -> SessionTime {
    now - SessionTime(at.elapsed().as_nanos().min(u128::from(u64::MAX)) as u64)
}
