//! Alignment of a film that an eye tracker's program recorded along with gaze: each picture has a time on the program's
//! clock, and the log has gaze samples with times on that clock and on the session's.

/// Share of the gaze samples that the alignment's residual covers; single stamps can be off.
const COVERED: f64 = 0.99;
/// Time between first and last sample below which they do not tell the drift, in seconds.
const TELLS_DRIFT_S: f64 = 60.0;

/// A moment on two clocks, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockPair {
    pub device_s: f64,
    pub session_s: f64,
}

/// How session time and the film's time belong together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockAlignment {
    /// Time in the film of session time 0, in seconds.
    pub offset_s: f64,
    /// Share by which the film's clock goes faster than session time.
    pub drift: f64,
    /// What nearly all gaze samples are off by at most, in seconds.
    pub residual_s: f64,
    /// Median time between pictures, in seconds.
    pub frame_s: f64,
}

/// Why a film was not aligned by its clock.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ClockRefusal {
    #[error("{frames} pictures and {stamps} time stamps")]
    Number { frames: usize, stamps: usize },
    #[error("time stamps that do not rise")]
    Order,
    #[error("a recording without gaze of Pupil Capture")]
    NoGaze,
    #[error("no gaze of the log while the film ran, by Capture's clock: the film of another trial")]
    Elsewhere,
    #[error("gaze of the log that fits the film's clock only to {:.0} ms, where a picture lasts {:.0} ms: the clock was set", residual_s * 1e3, frame_s * 1e3)]
    Residual { residual_s: f64, frame_s: f64 },
}

/// Aligns a film: `times_s` of its pictures as players count them, `stamps_s` of the same pictures on the device's clock.
///
/// # Errors
/// The stamps are not those of the film, or of another trial, or the device's clock was set meanwhile.
pub fn align(times_s: &[f64], stamps_s: &[f64], gaze: &[ClockPair]) -> Result<ClockAlignment, ClockRefusal> {
    if times_s.len() != stamps_s.len() || times_s.len() < 2 {
        return Err(ClockRefusal::Number { frames: times_s.len(), stamps: stamps_s.len() });
    }
    let rises = |values: &[f64]| values.windows(2).all(|pair| pair[0] < pair[1]);
    if !rises(stamps_s) || !rises(times_s) {
        return Err(ClockRefusal::Order);
    }
    if gaze.is_empty() {
        return Err(ClockRefusal::NoGaze);
    }
    let in_film = |pair: &ClockPair| {
        let after = stamps_s.partition_point(|stamp| *stamp < pair.device_s);
        let (before, after) = (after.checked_sub(1)?, Some(after).filter(|after| *after < stamps_s.len())?);
        let share = (pair.device_s - stamps_s[before]) / (stamps_s[after] - stamps_s[before]);
        Some((pair.session_s, times_s[before] + share * (times_s[after] - times_s[before])))
    };
    let pairs: Vec<(f64, f64)> = gaze.iter().filter_map(in_film).collect();
    let (Some(first), Some(last)) = (pairs.first(), pairs.last()) else { return Err(ClockRefusal::Elsewhere) };
    let number = pairs.len() as f64;
    let mean_session = pairs.iter().map(|(session, _)| session).sum::<f64>() / number;
    let mean_distance = pairs.iter().map(|(session, film)| film - session).sum::<f64>() / number;
    let spread: f64 = pairs.iter().map(|(session, _)| (session - mean_session).powi(2)).sum();
    let common = pairs.iter().map(|(session, film)| (session - mean_session) * (film - session - mean_distance));
    let drift = if last.0 - first.0 >= TELLS_DRIFT_S { common.sum::<f64>() / spread } else { 0.0 };
    let offset_s = mean_distance - drift * mean_session;
    let mut off_s: Vec<f64> =
        pairs.iter().map(|(session, film)| (film - offset_s - session * (1.0 + drift)).abs()).collect();
    off_s.sort_by(f64::total_cmp);
    let residual_s = off_s[((number * COVERED) as usize).min(off_s.len() - 1)];
    let frame_s = frame_s(times_s);
    match residual_s <= frame_s {
        true => Ok(ClockAlignment { offset_s, drift, residual_s, frame_s }),
        false => Err(ClockRefusal::Residual { residual_s, frame_s }),
    }
}

/// Median time between pictures, in seconds; 0 for fewer than two. `times_s`: of the pictures.
pub(super) fn frame_s(times_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}
