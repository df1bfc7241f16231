//! Command `tomcom replay RECORDING... --accuracy`: reads recordings and runs the planners for
//! [`tomcom_study::analysis::planner_accuracy`].

use super::timing::monotonic_ns;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::replay::{RecordingReplay, SameKitchenCheck};
use tomcom_study::analysis::planner_accuracy::{
    ComparedAdviceRequest, PlannerAccuracySummary, PlannerComparison, RecordedAdviceRequests, ThreadPlanner,
};
use tomcom_study::gathered::GatheredRecordings;
use tomcom_study::parallel;

/// Numbers of steps at which the planner's accuracy is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccuracyStepCounts {
    /// Number of steps answered by the converged planner.
    pub steps: usize,
    /// Number of steps answered by the plain reference planner, a subset of `steps`.
    pub reference_steps: usize,
}

/// Compares the planner's answers with more precise ones. `done` is called after each step that a planner has answered.
///
/// # Errors
/// A recording cannot be read or replayed, or the recordings are of different kitchens.
pub fn measure(
    recordings: &GatheredRecordings,
    extent: AccuracyStepCounts,
    done: impl Fn() + Sync,
) -> FileResult<PlannerAccuracySummary> {
    let (mut one_kitchen, mut asked) = (SameKitchenCheck::default(), Vec::new());
    for recording in &recordings.paths {
        let mut replay = RecordingReplay::open(recording)?;
        one_kitchen.admit(recording, &replay.session().kitchen)?;
        asked.push(ask(&mut replay)?);
    }
    let bench = PlannerComparison::new(one_kitchen.kitchen()?, asked, monotonic_ns);
    let mut steps = bench.spread(extent.steps);
    bench.answer(&mut steps, extent.reference_steps, &done);
    let converge = |planner: &mut ThreadPlanner, step: &ComparedAdviceRequest| bench.converge(planner, step);
    let steps = parallel::each_with(&steps, ThreadPlanner::default, converge, done);
    Ok(bench.summary(&steps))
}

/// The requests for advice that the assistant gets in a recording.
fn ask(replay: &mut RecordingReplay) -> FileResult<RecordedAdviceRequests> {
    let session = replay.log().session();
    let mut questions = Vec::new();
    while let Some(question) = replay.next_question()? {
        questions.push(question);
    }
    Ok(RecordedAdviceRequests { session, questions })
}
