//! Command `tomcom replay RECORDING --timing`: computing times of inference and planning, for each event.

use std::path::Path;
use std::sync::LazyLock;
use std::time::Instant;

use super::replay::RecordingReplay;
use crate::analysis::advisor::Advisor;
use crate::analysis::follower::InferenceTiming;
use crate::analysis::timing_summary::{DurationPercentiles, TimingSummary};
use crate::edge::file_error::FileResult;
use crate::kitchen::cost_to_go::CostToGo;

/// Nanoseconds on the monotonic clock since this function was first called.
pub(super) fn monotonic_ns() -> u64 {
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGAN.elapsed().as_nanos() as u64
}

/// Replays a recording and measures computing times.
///
/// # Errors
/// Errors of [`RecordingReplay::run`].
pub fn measure(recording: &Path) -> FileResult<TimingSummary> {
    let mut replay = RecordingReplay::open(recording)?;
    replay.follower.timing = Some(InferenceTiming::with_clock(monotonic_ns));
    let session = replay.session();
    let mut advisor = Advisor::new(session, CostToGo::new(session.kitchen.clone()));
    let began = Instant::now();
    let (mut plan_ns, mut step_ns) = (Vec::new(), Vec::new());
    while let Some(question) = replay.next_question()? {
        let began = Instant::now();
        advisor.answer(&question);
        let took_ns = began.elapsed().as_nanos() as u64;
        plan_ns.push(took_ns);
        let inference = replay.follower.timing.as_ref().and_then(|timing| timing.action_ns.last());
        step_ns.extend(inference.map(|inference| inference + took_ns));
    }
    let wall_s = began.elapsed().as_secs_f64();
    let measured = replay.follower.timing.take().map(|timing| (timing.gaze_ns, timing.action_ns));
    let (gaze_ns, action_ns) = measured.unwrap_or_default();
    Ok(TimingSummary {
        gaze_us: DurationPercentiles::from_nanoseconds(gaze_ns),
        action_us: DurationPercentiles::from_nanoseconds(action_ns),
        plan_us: DurationPercentiles::from_nanoseconds(plan_ns),
        step_us: DurationPercentiles::from_nanoseconds(step_ns),
        session_s: replay.session().time.as_secs_f64(),
        wall_s,
    })
}
