//! The stream of gaze samples in a session: how a sample changes the session's state, and faults of the stream.

use super::accuracy_check;
use super::gaze_status::{GazeStatus, RateMeasurement};
use super::session_state::Session;
use crate::base::time::SessionTime;
use crate::gaze::{GazeSample, MIN_CONFIDENCE};

/// A gap between gaze samples of this length makes the sampling rate be measured anew, in seconds.
const GAP_S: f64 = 0.5;
/// Time over which the sampling rate is measured, in seconds; the first measurement counts from [`FIRST_S`] on.
const MEASURED_S: f64 = 1.0;
const FIRST_S: f64 = 0.05;

/// Applies a gaze sample: counts it, updates the sampling rate, and records which location the participant looks at.
pub(super) fn take_sample(session: &mut Session, now: SessionTime, sample: GazeSample) {
    let status = &mut session.gaze;
    status.samples += 1;
    measure_rate(status, now, sample.taken_ns.unwrap_or(now).min(now));
    status.fault = status.judge.judge(&sample, now);
    if status.fault.is_some() {
        return;
    }
    accuracy_check::gaze(session, sample.taken_ns.unwrap_or(now).min(now), sample);
    let sample = session.corrected(sample);
    let status = &mut session.gaze;
    let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
    if !on_display || sample.confidence < MIN_CONFIDENCE {
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

/// Updates the sampling rate by a sample: the number of samples by the time in which they arrived, or were taken, if that
/// is longer. Samples that arrive together say nothing else.
fn measure_rate(status: &mut GazeStatus, now: SessionTime, taken: SessionTime) {
    let is_gap = status.arrived.is_none_or(|last| now.secs_since(last) >= GAP_S);
    status.arrived = Some(now);
    if is_gap || status.measured.is_none() {
        (status.rate_hz, status.measured) = (0.0, None);
    }
    let begun = RateMeasurement { since: now, first_taken: taken, samples: 0 };
    let measured = status.measured.get_or_insert(begun);
    let over_s = now.secs_since(measured.since).max(taken.secs_since(measured.first_taken));
    if over_s >= if status.rate_hz == 0.0 { FIRST_S } else { MEASURED_S } {
        status.rate_hz = f64::from(measured.samples) / over_s;
    }
    if over_s >= MEASURED_S {
        *measured = begun;
    }
    measured.samples += 1;
}

/// Names of kinds of faulty gaze samples.
pub(super) const MALFORMED: &str = "malformed";
pub(super) const TOO_FREQUENT: &str = "too frequent";
pub(super) const DUPLICATE: &str = "duplicate";

/// Kinds of faulty gaze samples that have occurred so far, each with its number of samples.
pub fn faults(session: &Session) -> Vec<(u64, &'static str)> {
    let (dropped, read) = (session.tracker.dropped, session.gaze.judge.counts);
    let all = [
        (dropped.malformed, MALFORMED),
        (dropped.too_frequent, TOO_FREQUENT),
        (dropped.overrun, "overrun"),
        (read.duplicate, DUPLICATE),
        (read.too_old, "late"),
        (read.out_of_order, "out of order"),
    ];
    all.into_iter().filter(|(count, _)| *count > 0).collect()
}
