//! The stream of gaze samples in a session: how a sample changes the session's state, and faults of the stream.

use super::accuracy_check;
use super::session_state::Session;
use crate::base::time::SessionTime;
use crate::gaze::{GazeSample, MIN_CONFIDENCE};
use crate::kitchen::LocationId;

/// A gap between gaze samples of this length makes the sampling rate be measured anew, in seconds.
const GAP_S: f64 = 0.5;

/// Applies a gaze sample: counts it, updates the sampling rate, and records which location the participant looks at. A
/// look counts by the time at which the sample was taken: a sample that arrives after a change may have been taken before.
pub(super) fn take_sample(session: &mut Session, now: SessionTime, sample: GazeSample) {
    let status = &mut session.gaze;
    status.samples += 1;
    let interval_s = status.arrived.map_or(GAP_S, |last| now.secs_since(last));
    status.arrived = Some(now);
    match status.steady_since.filter(|_| interval_s < GAP_S) {
        Some(since) => {
            // Sampling rate: the mean since the last gap in the gaze, or over about the last second if the gap is
            // longer ago. The window is a few milliseconds at least, because samples of one packet arrive together.
            let window_s = now.secs_since(since).clamp(0.005, 1.0);
            status.rate_hz += ((1.0 - interval_s * status.rate_hz) / window_s).max(-status.rate_hz);
        }
        None => {
            status.rate_hz = 0.0;
            status.steady_since = Some(now);
        }
    }
    status.here = 0;
    status.fault = status.judge.judge(&sample, now);
    if status.fault.is_some() {
        return;
    }
    let taken = sample.taken(now);
    accuracy_check::gaze(session, taken, sample);
    let sample = session.corrected(sample);
    let status = &mut session.gaze;
    let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
    if !on_display || sample.confidence < MIN_CONFIDENCE {
        status.unusable += 1;
        return;
    }
    status.last = Some((now, sample));
    if !session.had_kitchen_on_display(taken) {
        return;
    }
    let status = &mut session.gaze;
    for (index, location) in session.kitchen.locations.iter().enumerate() {
        if location.display.distance_m([sample.x, sample.y], session.kitchen.display_m) == 0.0 {
            status.looked_at[index] = Some(taken);
            status.here |= 1 << index;
        }
    }
}

impl Session {
    /// Whether a gaze sample that arrives now and was taken at `taken` can be a look at the kitchen: during a freeze probe
    /// the kitchen is not on the display.
    pub fn had_kitchen_on_display(&self, taken: SessionTime) -> bool {
        !self.is_frozen() && self.probes.ended_at.is_none_or(|ended| taken >= ended)
    }

    /// Whether the latest gaze sample is a look at this location's present content: inside the location's area, and taken
    /// since the content last changed.
    pub fn sees_present_content(&self, location: LocationId) -> bool {
        let is_here = self.gaze.here & 1 << location.index() != 0;
        is_here && self.gaze.looked_at[location.index()].is_some_and(|taken| taken >= self.changed_at[location.index()])
    }

    /// The location in whose area the latest gaze sample lies.
    pub fn looked_at(&self) -> Option<LocationId> {
        let here = self.gaze.here;
        (here != 0).then(|| LocationId(here.trailing_zeros() as u8))
    }
}

/// Kinds of faulty gaze samples that have occurred so far, each with its number of samples.
pub fn faults(session: &Session) -> Vec<(u64, &'static str)> {
    let (dropped, read) = (session.tracker.dropped, session.gaze.judge.counts);
    let all = [
        (dropped.malformed, "malformed"),
        (dropped.too_frequent, "too frequent"),
        (dropped.overrun, "overrun"),
        (read.duplicate, "duplicate"),
        (read.too_old, "late"),
        (read.out_of_order, "out of order"),
    ];
    all.into_iter().filter(|(count, _)| *count > 0).collect()
}
