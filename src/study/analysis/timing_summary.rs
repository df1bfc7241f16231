//! Computing times of inference and planning during a replay; the caller measures the times.

use serde::Serialize;

/// Computing times: the output of `tomcom replay --timing`, in microseconds. Values are null for computations that the
/// recording does not need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimingSummary {
    /// Computing time of the belief filter for a gaze sample.
    pub gaze_us: Option<DurationPercentiles>,
    /// Computing time of the belief filter for a press of the human or of the robot.
    pub action_us: Option<DurationPercentiles>,
    /// Computing time of the planner for one request for advice.
    pub plan_us: Option<DurationPercentiles>,
    /// Computing time of belief filter and planner together for one press.
    pub step_us: Option<DurationPercentiles>,
    /// Computing time of the planner where the advisor worked ahead between requests for as long as it had in the
    /// session.
    pub plan_ahead_us: Option<DurationPercentiles>,
    /// Computing time of filter and planner together where the advisor worked ahead.
    pub step_ahead_us: Option<DurationPercentiles>,
    /// Computing time that the advisor spent on working ahead, in seconds.
    pub ahead_s: f64,
    /// Number of decisions of the cost to go that planning had to compute, because no cache held them.
    pub decisions_computed: u64,
    /// Number of decisions of the cost to go that planning had to compute where the advisor worked ahead.
    pub decisions_computed_ahead: u64,
    /// Duration of the recording in session time, in seconds.
    pub session_s: f64,
    /// Duration of the replay by the computer's clock, in seconds.
    pub wall_s: f64,
}

/// Percentiles of measured computing times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DurationPercentiles {
    /// Number of computing times that were measured.
    pub n: u64,
    /// Median of the computing times.
    pub p50: f64,
    /// 99th percentile of the computing times.
    pub p99: f64,
    /// Longest of the computing times.
    pub max: f64,
}

impl DurationPercentiles {
    /// Percentiles, in microseconds, of computing times in nanoseconds; `None` without times. Each percentile is a
    /// computing time that occurred (nearest rank).
    pub fn from_nanoseconds(mut times_ns: Vec<u64>) -> Option<DurationPercentiles> {
        times_ns.sort_unstable();
        let (&max, n) = (times_ns.last()?, times_ns.len());
        let us = |ns: u64| ns as f64 / 1000.0;
        let rank = |share: f64| us(times_ns[((share * n as f64).ceil() as usize).clamp(1, n) - 1]);
        Some(DurationPercentiles { n: n as u64, p50: rank(0.5), p99: rank(0.99), max: us(max) })
    }
}

/// The computing times as text for the terminal.
pub fn describe(figures: &TimingSummary) -> String {
    let line = |what: &str, spread: Option<DurationPercentiles>| match spread {
        Some(DurationPercentiles { n, p50, p99, max }) => {
            format!("{what:<34}{n:>8} times, median {p50:>9.2} us, 99 % {p99:>9.2} us, most {max:>9.2} us\n")
        }
        None => format!("{what:<34}       -\n"),
    };
    format!(
        "{}{}{}{}{}{}{:.1} % of the session's time spent on working ahead; planning computed {} decisions without it, {} with it\n{:.0} s of session replayed in {:.2} s\n",
        line("inference, gaze sample", figures.gaze_us),
        line("inference, press", figures.action_us),
        line("planning", figures.plan_us),
        line("inference and planning", figures.step_us),
        line("planning, worked ahead", figures.plan_ahead_us),
        line("inference and planning, ahead", figures.step_ahead_us),
        100.0 * figures.ahead_s / figures.session_s.max(1e-9),
        figures.decisions_computed,
        figures.decisions_computed_ahead,
        figures.session_s,
        figures.wall_s
    )
}
