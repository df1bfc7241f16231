//! Merges the messages of Pupil Capture's online detectors into whole fixations and blinks.
//!
//! The fixation detector sends a fixation anew with every frame, under one id, over a window of the latest gaze (300 ms
//! by default): the windows overlap, and all together are the fixation. The blink detector repeats onset and offset
//! with every frame in which the confidence falls or rises; as in Pupil Player, a blink lasts from its first onset to
//! its last offset.

use std::time::{Duration, Instant};

use super::message::PupilBlink;

/// Time without a message after which a fixation, or the end of a blink, is over: several frames of a slow camera.
const SILENCE: Duration = Duration::from_millis(500);
/// Time without a message after which an onset begins another blink: the lids must have opened meanwhile for the
/// confidence to fall again.
const REOPENED: Duration = Duration::from_secs(1);
/// Largest gap between windows with one id that belong to one fixation, in seconds. Ids begin anew when the fixation
/// detector is restarted.
const APART_S: f64 = 1.0;

/// A window of a fixation as Capture sends it, or several merged windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixationFragment {
    pub id: u64,
    /// Position of the fixation on the display, in fractions; `None` if unknown.
    pub at: Option<[f64; 2]>,
    /// Beginning and end of the window in Pupil time, in seconds.
    pub span_s: [f64; 2],
    /// Spatial dispersion of the gaze samples, in degrees. For merged windows the largest value, which may be less than
    /// the dispersion of the whole fixation.
    pub dispersion_deg: f64,
    /// Capture's confidence in the fixation, 0 to 1; for merged windows the mean.
    pub confidence: f64,
}

/// Merges the overlapping windows of a fixation.
#[derive(Debug, Default)]
pub struct FixationMerger(Option<MergedWindows>);

#[derive(Clone, Copy, Debug)]
struct MergedWindows {
    merged: FixationFragment,
    windows: f64,
    places: f64,
    heard: Instant,
}

impl FixationMerger {
    /// Adds a window of a fixation that arrived at `now`; returns the previous fixation if the previous one is over.
    pub fn take(&mut self, window: FixationFragment, now: Instant) -> Option<FixationFragment> {
        let belongs = |merged: &FixationFragment| {
            let [begin, end] = merged.span_s;
            merged.id == window.id && window.span_s[0] <= end + APART_S && window.span_s[1] >= begin - APART_S
        };
        if let Some(current) = self.0.as_mut().filter(|current| belongs(&current.merged)) {
            current.add(&window, now);
            return None;
        }
        let places = f64::from(u8::from(window.at.is_some()));
        self.0.replace(MergedWindows { merged: window, windows: 1.0, places, heard: now }).map(|over| over.merged)
    }

    /// Returns the present fixation if no window of this fixation has arrived for a while.
    pub fn expire(&mut self, now: Instant) -> Option<FixationFragment> {
        let is_over = |current: &MergedWindows| now.saturating_duration_since(current.heard) >= SILENCE;
        self.0.take_if(|current| is_over(current)).map(|over| over.merged)
    }

    /// Returns the fixation that was not yet over when Capture's messages ended.
    pub fn end(&mut self) -> Option<FixationFragment> {
        self.0.take().map(|over| over.merged)
    }
}

impl MergedWindows {
    fn add(&mut self, window: &FixationFragment, now: Instant) {
        let merged = &mut self.merged;
        merged.span_s = [merged.span_s[0].min(window.span_s[0]), merged.span_s[1].max(window.span_s[1])];
        merged.dispersion_deg = merged.dispersion_deg.max(window.dispersion_deg);
        self.windows += 1.0;
        merged.confidence += (window.confidence - merged.confidence) / self.windows;
        if let Some(at) = window.at {
            self.places += 1.0;
            let before = merged.at.unwrap_or(at);
            merged.at = Some([0, 1].map(|axis| before[axis] + (at[axis] - before[axis]) / self.places));
        }
        self.heard = now;
    }
}

/// Merges repeated onsets and offsets of blinks: the state of the lids.
#[derive(Clone, Copy, Debug, Default)]
pub enum BlinkMerger {
    #[default]
    Open,
    /// The lids are closed: an onset was received, the latest one at this instant.
    Closed(Instant),
    /// The lids are opening: an offset was received; the latest offset, and its arrival.
    Opening(PupilBlink, Instant),
}

impl BlinkMerger {
    /// Adds an onset or offset of a blink that arrived at `now`. Returns the offset of the previous blink, if that
    /// blink is over, and then the onset of a new blink.
    pub fn take(&mut self, blink: PupilBlink, now: Instant) -> [Option<PupilBlink>; 2] {
        use BlinkMerger::{Closed, Open, Opening};
        let (lids, told) = match (*self, blink.is_onset) {
            // An offset without an onset belongs to a blink that began before the program listened.
            (Open, false) => (Open, [None, None]),
            (Closed(heard), true) if now.saturating_duration_since(heard) < REOPENED => (Closed(now), [None, None]),
            (Open | Closed(_), true) => (Closed(now), [None, Some(blink)]),
            (Closed(_), false) => (Opening(blink, now), [None, None]),
            (Opening(before, _), false) => {
                let confidence = before.confidence.max(blink.confidence);
                let last = PupilBlink { confidence, timestamp: before.timestamp.max(blink.timestamp), ..blink };
                (Opening(last, now), [None, None])
            }
            (Opening(before, _), true) => (Closed(now), [Some(before), Some(blink)]),
        };
        *self = lids;
        told
    }

    /// Returns the last offset of a blink if no message has arrived for a while.
    pub fn expire(&mut self, now: Instant) -> Option<PupilBlink> {
        match self {
            BlinkMerger::Opening(_, heard) if now.saturating_duration_since(*heard) >= SILENCE => self.end(),
            _ => None,
        }
    }

    /// Returns the last offset of a blink that was about to end when Capture's messages ended.
    pub fn end(&mut self) -> Option<PupilBlink> {
        match std::mem::take(self) {
            BlinkMerger::Opening(last, _) => Some(last),
            BlinkMerger::Open | BlinkMerger::Closed(_) => None,
        }
    }
}
