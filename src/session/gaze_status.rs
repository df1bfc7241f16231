//! The participant's gaze in a session: the rate of its samples, their faults, and which locations are looked at.

use super::{Session, calibration};
use crate::base::time::SessionTime;
use crate::gaze::quality::{GazeFault, SampleChecker};
use crate::gaze::{GazeSample, MIN_CONFIDENCE};
use crate::kitchen::state::MAX_LOCATIONS;

/// After a gap of this length in the samples, in seconds, the rate is measured anew.
const GAP_S: f64 = 0.5;

/// The participant's gaze as far as the console needs it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStatus {
    /// When the newest sample came, usable or not.
    pub arrived: Option<SessionTime>,
    pub last: Option<(SessionTime, GazeSample)>,
    /// When each location was last looked at (gaze inside its area), indexed by location.
    pub looked_at: [Option<SessionTime>; MAX_LOCATIONS],
    /// Samples so far; those with too low a confidence or outside of the display are counted apart.
    pub samples: u64,
    pub unusable: u64,
    /// Those that were recorded and are not read, by kind.
    pub judge: SampleChecker,
    /// What is wrong with the newest sample.
    pub fault: Option<GazeFault>,
    /// Samples a second, smoothed over about a second: see [`Session::gaze_hz`].
    pub(crate) rate_hz: f64,
    /// Since when samples come without a gap; nothing after a pause.
    pub(crate) steady_since: Option<SessionTime>,
}

/// Takes a gaze sample: counts it, measures the rate, and remembers which locations are looked at.
pub(super) fn take_sample(session: &mut Session, now: SessionTime, sample: GazeSample) {
    let status = &mut session.gaze;
    status.samples += 1;
    let interval_s = status.arrived.map_or(GAP_S, |last| now.secs_since(last));
    status.arrived = Some(now);
    match status.steady_since.filter(|_| interval_s < GAP_S) {
        Some(since) => {
            // The mean since the last gap; after a second of it, of about the last second. A few milliseconds at least,
            // so that samples of one packet are no rate.
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
    calibration::gaze(session, sample.taken_ns.unwrap_or(now).min(now), sample);
    let sample = session.corrected(sample);
    let status = &mut session.gaze;
    let on_display = (0.0..=1.0).contains(&sample.x) && (0.0..=1.0).contains(&sample.y);
    if !on_display || sample.confidence < MIN_CONFIDENCE {
        status.unusable += 1;
        return;
    }
    status.last = Some((now, sample));
    for (index, location) in session.kitchen.locations.iter().enumerate() {
        if location.display.distance_m([sample.x, sample.y], session.kitchen.display_m) == 0.0 {
            status.looked_at[index] = Some(now);
        }
    }
}
