//! Command `tomcom simulate`: simulates whole trials in virtual time ([`tomcom_study::files::simulated_trials`]) and sums
//! them up.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::clock::monotonic_ns;
use super::leaving::ways_to_look;
use super::options;
use tomcom_core::base::text::count;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_devices::external::LocalMinds;
use tomcom_session::files::file_error::FileError;
use tomcom_session::headless::{Outside, SimulationShard};
use tomcom_session::log::{RecordingError, ruling};
use tomcom_session::settings::{Condition, ParticipantSpec};
use tomcom_session::study_arm::StudyArm;
use tomcom_study::analysis::kitchen_summary::plan_lengths;
use tomcom_study::analysis::trial_summary::{SimulationSummary, SimulationSums, StudyArmTotals};
pub use tomcom_study::files::simulated_trials::SimulationRequest;
use tomcom_study::files::simulated_trials::{describe_moved, each_trial};
use tomcom_study::tournament::of_earlier_run;

/// Simulates the trials on all processors. Trials whose complete recordings exist already are read instead. `done` is
/// called after each trial.
///
/// # Errors
/// A recording cannot be written, its folder holds another recording, or an exclusion file is damaged.
pub fn simulate(simulation: &SimulationRequest, done: impl Fn() + Sync) -> Result<SimulationSummary, RecordingError> {
    let mut sums = SimulationSums::default();
    let began = Instant::now();
    let plan_lengths = plan_lengths(
        &simulation.files.kitchen.kitchen,
        &mut CostToGo::new(Arc::new(simulation.files.kitchen.kitchen.clone())),
    );
    let (mut excluded, mut found, mut found_external, mut recordings, mut moved) = (0, 0, 0, Vec::new(), Vec::new());
    let outside = Outside { minds: &LocalMinds, now_ns: monotonic_ns };
    let mut failed = Vec::new();
    each_trial(simulation, outside, done, |trial| {
        moved.extend(trial.moved.map(|log| log.display().to_string()));
        recordings.push(trial.folder.clone().into());
        found += u64::from(trial.found);
        found_external += u64::from(trial.found && trial.has_external_mind);
        if let Some(reason) = trial.failed {
            failed.push(format!("{}: {reason}", trial.folder.display()));
            return Ok(());
        }
        // An existing recording can have been excluded from the analysis.
        match ruling(&trial.folder)?.is_some_and(|ruling| ruling.excluded) {
            true => excluded += 1,
            false => sums.add(trial.arm, &trial.figures, &plan_lengths),
        }
        Ok(())
    })?;
    let wall_s = began.elapsed().as_secs_f64();
    Ok(SimulationSummary { excluded, failed, found, found_external, recordings, moved, wall_s, ..sums.figures() })
}

/// Simulates a recording for wizard training: an unassisted trial of `seconds` in the default kitchen.
///
/// # Errors
/// The errors of [`simulate`].
pub fn for_training(seed: u64, seconds: f64, out: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let mut files = options::session_or_default(None)?;
    (files.spec.plan, files.spec.seed) = (None, seed);
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    (files.spec.trial.seconds, files.spec.trial.orders) = (seconds, None);
    files.spec.participant = ParticipantSpec::default();
    files
        .spec
        .check()
        .map_err(|error| FileError::from_finding(Path::new("--seconds"), error.found, error.remedy.to_string()))?;
    // The recording's length is part of the path, since recordings of different length would have the same name.
    let out = out.join(format!("{seconds}s"));
    let figures = simulate(&SimulationRequest { files, trials: 1, shard: SimulationShard::WHOLE, out }, || ())?;
    Ok(figures.recordings.into_iter().map(|folder| folder.0).collect())
}

/// The summary of a simulation as text for the terminal.
pub fn describe(figures: &SimulationSummary) -> String {
    let each = match (figures.presses_per_order, figures.optimal_presses_per_order) {
        (Some(presses), Some(best)) => format!(", {presses:.1} presses for an order in the median (at best {best:.1})"),
        _ => String::new(),
    };
    let excluded = match figures.excluded {
        0 => String::new(),
        some => format!("{} excluded, and left out of these numbers\n", count(some, "recording is", "recordings are")),
    };
    let share = |errors: u64, actions: u64| 100.0 * errors as f64 / actions.max(1) as f64;
    let found = match figures.found {
        0 => String::new(),
        some => format!(", {some} of them in an earlier run"),
    };
    let earlier = match figures.found_external {
        0 => String::new(),
        some => of_earlier_run(some) + "\n",
    };
    let moved = describe_moved(&figures.moved);
    let failed = match &figures.failed[..] {
        [] => String::new(),
        [first, ..] => {
            let trials = count(figures.failed.len() as u64, "trial was aborted and is", "trials were aborted and are");
            format!("{trials} left out of these numbers; the first, {first}\n")
        }
    };
    let offers = figures.offers.describe();
    let by_arm: String = match &figures.arms[..] {
        [] => String::new(),
        [one] if one.arm == StudyArm::None => String::new(),
        several => several.iter().map(describe_arm).collect(),
    };
    let look = figures
        .recordings
        .first()
        .map_or(String::new(), |first| format!("{}\n", ways_to_look("a recording", &first.to_string())));
    format!(
        "{moved}{} of simulated participants, {:.0} s simulated in {:.1} s{found}\n\
         presses: {} of the human, {} of the robot\n\
         errors: {} ({:.1} % of the human's presses, {:.1} % of all)\n\
         {by_arm}\
         {}\n\
         {offers}\
         orders served: {}{each}\n\
         {earlier}{excluded}{failed}\
         recordings:\n{}\n{look}",
        count(figures.trials, "trial", "trials"),
        figures.simulated_s,
        figures.wall_s,
        figures.human_actions,
        figures.robot_actions,
        figures.errors,
        share(figures.errors, figures.human_actions),
        share(figures.errors, figures.human_actions + figures.robot_actions),
        figures.beliefs.describe(figures.errors),
        figures.orders_served,
        figures.recordings.iter().map(|path| format!("  {path}")).collect::<Vec<_>>().join("\n"),
    )
}

fn describe_arm(one: &StudyArmTotals) -> String {
    let per_100 = |number: u64| 100.0 * number as f64 / one.human_actions.max(1) as f64;
    let (errors, signals) = (per_100(one.errors), count(one.signals, "signal", "signals"));
    format!(
        "  {}: errors in {errors:.1} % of the human's presses, {signals} ({:.1} per 100 presses)\n",
        one.arm.title(),
        per_100(one.signals)
    )
}
