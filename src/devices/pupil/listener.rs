//! Reads the messages that Pupil Capture publishes, and passes them on to the session.

use std::collections::BTreeSet;
use std::io;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;
use tokio::time::timeout;

use super::eye_events::{BlinkMerger, FixationFragment, FixationMerger};
use super::message::{self, CaptureNotification, PupilBlink, PupilMessage};
use super::zmtp::{ZmtpConnection, ZmtpMessage};
use crate::compared_clock::ClockOffsetEstimator;
use crate::gaze_input::{TrackerFixation, TrackerMessage, TrackerTime};
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::tags::SurfaceHomography;

/// The display's surface counts as lost after this long without a datum about it.
const UNSEEN: Duration = Duration::from_secs(1);
/// Longest wait for a message before the listener checks whether fixations, blinks and the surface's detection are
/// over.
const WAKE: Duration = Duration::from_millis(250);
/// Largest number of other surfaces (than the display's) whose names are reported.
const MAX_OTHERS: usize = 8;

/// Reads the messages that Capture publishes, and passes them on to the session and to the recorder's task.
pub(super) struct Listener<'a> {
    news: Sender<TrackerMessage>,
    recorder: Sender<CaptureNotification>,
    surface: &'a str,
    map: SurfaceHomography,
    clock: &'a Mutex<ClockOffsetEstimator>,
    /// Number of messages that were dropped and have not been reported yet.
    lost: &'a mut u64,
    fixations: FixationMerger,
    blinks: BlinkMerger,
    /// Whether the display was last reported as detected; `None` before the first report.
    sees: Option<bool>,
    /// Names of other surfaces that are detected while the display's surface is not.
    others: BTreeSet<String>,
    has_new_others: bool,
}

impl<'a> Listener<'a> {
    /// A listener to Capture that has received no message yet.
    pub fn new(
        news: Sender<TrackerMessage>,
        recorder: Sender<CaptureNotification>,
        (surface, map): (&'a str, SurfaceHomography),
        clock: &'a Mutex<ClockOffsetEstimator>,
        lost: &'a mut u64,
    ) -> Listener<'a> {
        Listener {
            news,
            recorder,
            surface,
            map,
            clock,
            lost,
            fixations: FixationMerger::default(),
            blinks: BlinkMerger::default(),
            sees: None,
            others: BTreeSet::new(),
            has_new_others: false,
        }
    }

    /// Reads Capture's messages until the connection fails.
    pub async fn listen(&mut self, backbone: &mut ZmtpConnection) -> io::Error {
        let connected = Instant::now();
        let mut seen: Option<Instant> = None;
        loop {
            match timeout(WAKE, backbone.receive()).await {
                Ok(Ok(message)) => {
                    let told = read(&message, self.surface);
                    if told.sees_surface {
                        seen = Some(Instant::now());
                    }
                    self.pass(told);
                }
                Ok(Err(reason)) => return reason,
                Err(_) => {}
            }
            let sees = seen.is_some_and(|seen| seen.elapsed() < UNSEEN);
            // Before the first datum, or until a datum is overdue, it is unknown whether the display's surface is
            // detected.
            if sees || connected.elapsed() >= UNSEEN {
                self.tell_surfaces(sees).await;
            }
            let now = Instant::now();
            let (fixation, blink) = (self.fixations.expire(now), self.blinks.expire(now));
            self.tell_over(fixation, blink);
            if self.news.is_closed() {
                return io::ErrorKind::BrokenPipe.into();
            }
        }
    }

    /// Reports the fixation and the blink that had not ended when the connection ended.
    pub fn end(&mut self) {
        let (fixation, blink) = (self.fixations.end(), self.blinks.end());
        self.tell_over(fixation, blink);
    }

    fn tell_over(&mut self, fixation: Option<FixationFragment>, blink: Option<PupilBlink>) {
        if let Some(over) = fixation {
            self.tell_fixation(over);
        }
        if let Some(over) = blink {
            self.tell_blink(over);
        }
    }

    /// Reports whether the display's surface is detected, and if it is not, which other surfaces are.
    async fn tell_surfaces(&mut self, sees: bool) {
        if sees {
            self.others.clear();
            self.has_new_others = false;
        }
        if self.sees != Some(sees) {
            self.sees = Some(sees);
            let _ = self.news.send(TrackerMessage::SeesDisplay(sees)).await;
        }
        if !sees && std::mem::take(&mut self.has_new_others) {
            let _ = self.news.send(TrackerMessage::OtherSurfaces(self.others.iter().cloned().collect())).await;
        }
    }

    /// Passes on a parsed message. If the queue to the session is full, messages are counted and dropped, so that
    /// Capture is never blocked.
    fn pass(&mut self, told: PupilMessage) {
        let (now, mut malformed) = (Instant::now(), told.malformed);
        for gaze in told.gaze {
            let Some([x, y]) = self.map.to_display(gaze.norm_pos) else {
                malformed += 1;
                continue;
            };
            let taken = self.taken(gaze.timestamp);
            let sample = GazeSample { device_ns: Some(taken.device_ns), ..GazeSample::new(x, y, gaze.confidence) };
            self.offer(TrackerMessage::Sample(sample, taken.at));
        }
        for found in told.fixations {
            let at = found.at.and_then(|place| self.map.to_display(place));
            if let Some(over) = self.fixations.take(FixationFragment { at, ..found }, now) {
                self.tell_fixation(over);
            }
        }
        if let Some(blink) = told.blink {
            for found in self.blinks.take(blink, now).into_iter().flatten() {
                self.tell_blink(found);
            }
        }
        if let Some(name) = told.other_surface
            && self.others.len() < MAX_OTHERS
        {
            self.has_new_others |= self.others.insert(name);
        }
        if let Some(news) = told.recorder {
            // The recorder's task reads at once, unless it is about to end.
            let _ = self.recorder.try_send(news);
        }
        if malformed > 0 {
            self.offer(TrackerMessage::Malformed(malformed));
        }
        if *self.lost > 0 && self.news.try_send(TrackerMessage::Overrun(*self.lost)).is_ok() {
            *self.lost = 0;
        }
    }

    fn tell_fixation(&mut self, found: FixationFragment) {
        let [begin, end] = found.span_s;
        self.offer(TrackerMessage::Fixation(TrackerFixation {
            at: found.at,
            duration_ms: (end - begin) * 1000.0,
            dispersion_deg: found.dispersion_deg,
            confidence: found.confidence,
            began: self.taken(begin),
        }));
    }

    fn tell_blink(&mut self, found: PupilBlink) {
        let taken = self.taken(found.timestamp);
        self.offer(TrackerMessage::Blink { is_onset: found.is_onset, confidence: found.confidence, taken });
    }

    fn taken(&self, pupil_s: f64) -> TrackerTime {
        let at = self.clock.lock().ok().and_then(|clock| clock.instant(pupil_s));
        TrackerTime { device_ns: (pupil_s * 1e9) as i64, at }
    }

    fn offer(&mut self, news: TrackerMessage) {
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
