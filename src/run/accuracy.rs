//! `tomcom replay RECORDING... --accuracy`: reads recordings, and lets planners answer for
//! [`crate::analysis::planner_accuracy`].

use std::path::PathBuf;

use super::parallel;
use super::replay::{Replay, SameKitchen, each_once};
use super::timing::monotonic_ns;
use crate::analysis::planner_accuracy::{AccuracyStep, AccuracySummary, BenchPlanner, PlannerBench, RecordedQuestions};
use crate::edge::file_error::FileResult;

/// How many steps are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccuracySample {
    /// By the converged planner.
    pub steps: usize,
    /// By the plain reference, among them.
    pub reference_steps: usize,
}

/// Holds the planner's answers against better ones. `done` is called after each step of each planner.
///
/// # Errors
/// A recording that cannot be read or applied, or one of another kitchen.
pub fn measure(recordings: &[PathBuf], extent: AccuracySample, done: impl Fn() + Sync) -> FileResult<AccuracySummary> {
    each_once(recordings)?;
    let (mut one_kitchen, mut asked) = (SameKitchen::default(), Vec::new());
    for recording in recordings {
        let mut replay = Replay::open(recording)?;
        one_kitchen.admit(recording, &replay.session().kitchen)?;
        asked.push(ask(&mut replay)?);
    }
    let bench = PlannerBench::new(one_kitchen.kitchen()?, asked, monotonic_ns);
    let mut steps = bench.spread(extent.steps);
    bench.answer(&mut steps, extent.reference_steps, &done);
    let converge = |planner: &mut BenchPlanner, step: &AccuracyStep| bench.converge(planner, step);
    let steps = parallel::each_with(&steps, BenchPlanner::default, converge, done);
    Ok(bench.summary(&steps))
}

/// The questions that the assistant is asked after presses.
fn ask(replay: &mut Replay) -> FileResult<RecordedQuestions> {
    let session = replay.log().session();
    let mut questions = Vec::new();
    while let Some(question) = replay.next_question()? {
        questions.push(question);
    }
    Ok(RecordedQuestions { session, questions })
}
