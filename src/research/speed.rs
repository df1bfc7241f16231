//! Command `tomcom-research speed`: replays a recording and measures computing times of inference and planning, for each
//! event.

use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use serde::Serialize;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::advisor::{AdviceRequest, Advisor};
use tomcom_session::files::file_error::FileResult;
use tomcom_session::follower::InferenceTiming;
use tomcom_session::replay::RecordingReplay;

/// Computing times: the output of `tomcom-research speed`, in microseconds. Values are null for computations that the
/// recording does not need.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimingSummary {
    pub gaze_us: Option<DurationPercentiles>,
    pub action_us: Option<DurationPercentiles>,
    pub plan_us: Option<DurationPercentiles>,
    pub step_us: Option<DurationPercentiles>,
    /// Computing time of the planner where the advisor worked ahead between requests for as long as it had in the
    /// session.
    pub plan_ahead_us: Option<DurationPercentiles>,
    pub step_ahead_us: Option<DurationPercentiles>,
    /// Computing time that the advisor spent on working ahead, in seconds.
    pub ahead_s: f64,
    /// Number of decisions of the cost to go that planning had to compute, because no cache held them.
    pub decisions_computed: u64,
    /// Number of decisions of the cost to go that planning had to compute where the advisor worked ahead.
    pub decisions_computed_ahead: u64,
    pub session_s: f64,
    pub wall_s: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DurationPercentiles {
    pub n: u64,
    pub p50: f64,
    pub p99: f64,
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

/// Nanoseconds on the monotonic clock since this function was first called.
fn monotonic_ns() -> u64 {
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
        self.advisor.work_ahead(last, &|| began.elapsed() < free);
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
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let [mut plain, mut ahead] = [(); 2].map(|()| {
        let mut advisor = Advisor::new(session, CostToGo::new(session.kitchen.clone()));
        advisor.use_threads(threads);
        TimedAdvisor::new(advisor)
    });
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
