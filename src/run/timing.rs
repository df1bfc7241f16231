//! Command `tomcom replay RECORDING --timing`: measures computing times of inference and planning, for each event.

use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::advisor::{AdviceRequest, Advisor};
use tomcom_session::files::file_error::FileResult;
use tomcom_session::follower::InferenceTiming;
use tomcom_session::replay::RecordingReplay;
use tomcom_study::analysis::timing_summary::{DurationPercentiles, TimingSummary};

/// Nanoseconds on the monotonic clock since this function was first called.
pub(super) fn monotonic_ns() -> u64 {
    static BEGAN: LazyLock<Instant> = LazyLock::new(Instant::now);
    BEGAN.elapsed().as_nanos() as u64
}

/// An assistant whose computing times for answers are measured.
struct TimedAdvisor {
    advisor: Advisor,
    answer_ns: Vec<u64>,
    /// Number of decisions whose cost to go the answers had to compute, because no cache held them.
    decisions_in_answers: u64,
}

impl TimedAdvisor {
    fn new(advisor: Advisor) -> TimedAdvisor {
        TimedAdvisor { advisor, answer_ns: Vec::new(), decisions_in_answers: 0 }
    }

    /// Answers a request for advice; returns the computing time in nanoseconds.
    fn answer(&mut self, question: &AdviceRequest) -> u64 {
        let before = self.advisor.computed_decisions();
        let began = Instant::now();
        self.advisor.answer(question);
        let took_ns = began.elapsed().as_nanos() as u64;
        self.answer_ns.push(took_ns);
        self.decisions_in_answers += self.advisor.computed_decisions() - before;
        took_ns
    }

    /// Works ahead after a request for advice for at most the time until the next request; returns the computing time
    /// in nanoseconds.
    fn work_ahead(&mut self, last: &AdviceRequest, until: SessionTime) -> u64 {
        let free = Duration::from_secs_f64(until.secs_since(last.time).max(0.0));
        let began = Instant::now();
        self.advisor.work_ahead(last, &mut || began.elapsed() < free);
        began.elapsed().as_nanos() as u64
    }
}

/// Replays a recording and measures computing times.
///
/// # Errors
/// The errors of [`RecordingReplay::run`].
pub fn measure(recording: &Path) -> FileResult<TimingSummary> {
    let mut replay = RecordingReplay::open(recording)?;
    replay.follower.timing = Some(InferenceTiming::with_clock(monotonic_ns));
    let session = replay.session();
    let [mut plain, mut ahead] =
        [(); 2].map(|()| TimedAdvisor::new(Advisor::new(session, CostToGo::new(session.kitchen.clone()))));
    let began = Instant::now();
    let (mut step_ns, mut step_ahead_ns, mut ahead_ns) = (Vec::new(), Vec::new(), 0);
    let (mut last, mut presses): (Option<AdviceRequest>, usize) = (None, 0);
    while let Some(question) = replay.next_question()? {
        // The advisor works ahead for as long as it had in the session until this request.
        if let Some(last) = last {
            ahead_ns += ahead.work_ahead(&last, question.time);
        }
        // Only a request after a press has an inference about that press before it.
        let inferred = replay.follower.timing.as_ref().map_or(&[][..], |timing| &timing.action_ns);
        let inference = inferred[presses.min(inferred.len())..].last().copied();
        presses = inferred.len();
        let [took_ns, took_ahead_ns] = [&mut plain, &mut ahead].map(|advisor| advisor.answer(&question));
        step_ns.extend(inference.map(|inference| inference + took_ns));
        step_ahead_ns.extend(inference.map(|inference| inference + took_ahead_ns));
        last = Some(question);
    }
    let wall_s = began.elapsed().as_secs_f64();
    let measured = replay.follower.timing.take().map(|timing| (timing.gaze_ns, timing.action_ns));
    let (gaze_ns, action_ns) = measured.unwrap_or_default();
    Ok(TimingSummary {
        gaze_us: DurationPercentiles::from_nanoseconds(gaze_ns),
        action_us: DurationPercentiles::from_nanoseconds(action_ns),
        decisions_computed: plain.decisions_in_answers,
        decisions_computed_ahead: ahead.decisions_in_answers,
        plan_us: DurationPercentiles::from_nanoseconds(plain.answer_ns),
        step_us: DurationPercentiles::from_nanoseconds(step_ns),
        plan_ahead_us: DurationPercentiles::from_nanoseconds(ahead.answer_ns),
        step_ahead_us: DurationPercentiles::from_nanoseconds(step_ahead_ns),
        ahead_s: ahead_ns as f64 / 1e9,
        session_s: replay.session().time.as_secs_f64(),
        wall_s,
    })
}
