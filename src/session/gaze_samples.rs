//! The stream of gaze samples in a session: how a sample changes the session's state, and faults of the stream.

use super::accuracy_check;
use super::session_state::Session;
use crate::base::time::SessionTime;
use crate::gaze::{GazeSample, MIN_CONFIDENCE};

/// A gap between gaze samples of this length makes the sampling rate be measured anew, in seconds.
const GAP_S: f64 = 0.5;

/// Applies a gaze sample: counts it, updates the sampling rate, and records which location the participant looks at.
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
    status.fault = status.judge.judge(&sample, now);
    if status.fault.is_some() {
        return;
    }
    accuracy_check::gaze(session, sample.taken_ns.unwrap_or(now).min(now), sample);
    let sample = session.corrected(sample);
    let status = &mut session.gaze;
    if !sample.is_on_display() || sample.confidence < MIN_CONFIDENCE {
        status.unusable += 1;
        return;
    }
    status.last = Some((now, sample));
    if session.probes.open.is_some() {
        // During a freeze probe the kitchen is not on the display, so the sample is no look at a location.
        return;
    }
    for (index, location) in session.kitchen.locations.iter().enumerate() {
        if location.display.distance_m([sample.x, sample.y], session.kitchen.display_m) == 0.0 {
            status.looked_at[index] = Some(now);
        }
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
