//! Command `tomcom simulate`: simulates whole trials in virtual time. A trial's result does not depend on the number of
//! trials.
//!
//! Trials are simulated on all processors in blocks and summed up in their order, so that results do not depend on
//! timing, and memory use does not grow. A trial whose complete recording with the same header exists is read instead
//! of simulated. A shard takes every n-th trial.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::leaving::ways_to_look;
use super::options;
use tomcom_core::base::text::count;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::FileError;
use tomcom_session::log::RecordingError;
use tomcom_session::log::{LogReader, RecordingLock, RecordingWriteError, SimulatedLogState, check_simulated, ruling};
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::{Condition, ParticipantSpec, SessionSpec};
use tomcom_session::shard::SimulationShard;
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{LogHeader, TimestampedEvent};
use tomcom_study::analysis::kitchen_summary::plan_lengths;
use tomcom_study::analysis::trial_summary::{SimulationSummary, SimulationSums, StudyArmTotals, TrialSummary};
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::parallel::WorkerPool;

/// Request of `tomcom simulate`.
#[derive(Clone, Debug)]
pub struct SimulationRequest {
    /// Settings of the session, with the files that they name.
    pub files: SessionSetup,
    /// Total number of trials, over all shards of the simulation.
    pub trials: u64,
    /// Shard (part) of the trials that is simulated here.
    pub shard: SimulationShard,
    /// Folder in which the recordings are made.
    pub out: PathBuf,
}

impl SimulationRequest {
    /// Indices of the trials of this shard, in order.
    pub fn own_trials(&self) -> impl Iterator<Item = u64> + Clone {
        let SimulationShard { number, of } = self.shard;
        (number - 1..self.trials).step_by(of as usize)
    }
}

/// Period of polling a trial that another program is simulating.
const LOOK: Duration = Duration::from_millis(50);
/// Number of trials whose results are held in memory before they are summed up.
const BLOCK: usize = 256;

/// Settings of a simulated trial without a study plan. Without a scripted wizard, the wizard condition becomes
/// unassisted. Every trial has a participant of its own with a code of its own.
pub fn settings_of_trial(spec: &SessionSpec, trial: u64) -> SessionSpec {
    let mut spec = spec.clone();
    if spec.unattended(spec.trial.condition) != spec.trial.condition {
        // Without a wizard, nobody would see the assistant's advice, so it is not computed.
        (spec.trial.condition, spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    }
    spec.participant.code = format!("S{:03}", trial + 1);
    spec
}

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
    let (mut excluded, mut found, mut recordings, mut moved) = (0, 0, Vec::new(), Vec::new());
    each_trial(simulation, done, |trial| {
        moved.extend(trial.moved.map(|log| log.display().to_string()));
        recordings.push(trial.folder.clone().into());
        found += u64::from(trial.found);
        // An existing recording can have been excluded from the analysis.
        match ruling(&trial.folder).map_err(Box::new)?.is_some_and(|ruling| ruling.excluded) {
            true => excluded += 1,
            false => sums.add(trial.arm, &trial.figures, &plan_lengths),
        }
        Ok(())
    })?;
    let wall_s = began.elapsed().as_secs_f64();
    Ok(SimulationSummary { excluded, found, recordings, moved, wall_s, ..sums.figures() })
}

/// A simulated trial with its recording and summary.
pub struct SimulatedTrial {
    /// Folder of the recording.
    pub folder: PathBuf,
    /// Study arm of the simulated trial, as it was carried out.
    pub arm: StudyArm,
    /// Summary of the simulated trial.
    pub figures: TrialSummary,
    /// Whether the trial's recording existed before, or another program made it in the meantime.
    pub found: bool,
    /// New path of a log that ended before the end of its header and was moved out of the way.
    pub moved: Option<PathBuf>,
}

/// Simulates the trials on all processors and passes the trials to `take` one by one, in order. Trials that another
/// program is simulating in this folder are waited for after all others.
///
/// # Errors
/// The errors of [`simulate`], and the first error of `take`.
pub fn each_trial(
    simulation: &SimulationRequest,
    done: impl Fn() + Sync,
    mut take: impl FnMut(SimulatedTrial) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    // Existing folders are checked before the first trial is simulated.
    for trial in simulation.own_trials() {
        let header = header_of_trial(simulation, trial);
        check_simulated(&folder_of_trial(&simulation.out, &header.session), &header)?;
    }
    let kitchen = Arc::new(simulation.files.kitchen.kitchen.clone());
    let workers = WorkerPool::new(KeptCost::default);
    let mut trials = simulation.own_trials();
    loop {
        let block: Vec<u64> = trials.by_ref().take(BLOCK).collect();
        if block.is_empty() {
            return Ok(());
        }
        let one = |kept: &mut KeptCost, trial: &u64| {
            let simulated = simulate_trial(simulation, &kitchen, *trial, kept);
            if simulated.is_ok() {
                done();
            }
            simulated
        };
        let mut simulated = workers.each(&block, one, || ());
        let is_elsewhere = |one: &Result<SimulatedTrial, RecordingError>| {
            matches!(one, Err(RecordingError::Recording(RecordingWriteError::InUse { .. })))
        };
        let mut elsewhere: Vec<usize> = (0..block.len()).filter(|&index| is_elsewhere(&simulated[index])).collect();
        while !elsewhere.is_empty() {
            let trials: Vec<u64> = elsewhere.iter().map(|&index| block[index]).collect();
            wait_for_any(simulation, &trials);
            let again = workers.each(&trials, one, || ());
            elsewhere.iter().zip(again).for_each(|(&index, one)| simulated[index] = one);
            elsewhere.retain(|&index| is_elsewhere(&simulated[index]));
        }
        for one in simulated {
            one.and_then(&mut take)?;
        }
    }
}

/// Waits until another program has finished at least one of these trials.
fn wait_for_any(simulation: &SimulationRequest, trials: &[u64]) {
    let folders: Vec<PathBuf> = trials.iter().map(|&trial| folder_of(simulation, trial)).collect();
    while folders.iter().all(|folder| RecordingLock::holder(folder).is_some()) {
        std::thread::sleep(LOOK);
    }
}

/// Simulates a recording for wizard training: an unassisted trial of `seconds` in the default kitchen.
///
/// # Errors
/// The errors of [`simulate`].
pub fn for_training(seed: u64, seconds: f64, out: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let mut files = options::session_or_default(None).map_err(Box::new)?;
    (files.spec.plan, files.spec.seed) = (None, seed);
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    (files.spec.trial.seconds, files.spec.trial.orders) = (seconds, None);
    files.spec.participant = ParticipantSpec::default();
    files.spec.check().map_err(|error| {
        Box::new(FileError::from_finding(Path::new("--seconds"), error.found, error.remedy.to_string()))
    })?;
    // The recording's length is part of the path, since recordings of different length would have the same name.
    let out = out.join(format!("{seconds}s"));
    let figures = simulate(&SimulationRequest { files, trials: 1, shard: SimulationShard::WHOLE, out }, || ())?;
    Ok(figures.recordings.into_iter().map(|folder| folder.0).collect())
}

/// Folder of a trial's recording; the folder's name does not depend on the number of trials.
fn folder_of_trial(out: &Path, spec: &SessionSpec) -> PathBuf {
    let period = spec.step.as_ref().and_then(|step| step.period);
    let period = period.map_or(String::new(), |period| format!("-{period}"));
    out.join(format!("seed{}-{}{period}", spec.seed, spec.participant.code))
}

/// Header of a simulated trial's recording. With a study plan, trials are ordered by participant; without a plan, each
/// trial has a participant of its own.
fn header_of_trial(simulation: &SimulationRequest, trial: u64) -> LogHeader {
    let files = &simulation.files.kitchen;
    let (spec, trial) = match simulation.files.study() {
        None => (settings_of_trial(&simulation.files.spec, trial), trial),
        Some(study) => {
            let periods = study.plan.conditions.len() as u64;
            study.simulated((trial / periods) as usize, (trial % periods) as u32 + 1)
        }
    };
    LogHeader::new(spec, trial, files.layout.clone(), files.recipes.clone())
}

fn folder_of(simulation: &SimulationRequest, trial: u64) -> PathBuf {
    folder_of_trial(&simulation.out, &header_of_trial(simulation, trial).session)
}

/// Simulates a trial, or reads its complete recording. `kept`: the cost to go of this thread's last trial.
fn simulate_trial(
    simulation: &SimulationRequest,
    kitchen: &Arc<Kitchen>,
    trial: u64,
    kept: &mut KeptCost,
) -> Result<SimulatedTrial, RecordingError> {
    let header = header_of_trial(simulation, trial);
    let folder = folder_of_trial(&simulation.out, &header.session);
    let opened = SimulatedLogState::open(&folder, &header)?;
    let cost = kept.take(kitchen);
    let (follower, found, moved) = match opened {
        SimulatedLogState::Whole => {
            let mut replay = RecordingReplay::over(LogReader::open(&folder).map_err(Box::new)?, cost);
            replay.run().map_err(Box::new)?;
            (replay.follower, true, None)
        }
        SimulatedLogState::Begun { mut log, moved } => {
            let mut engine = SessionEngine::new(kitchen.clone(), header.session, header.trial, cost);
            tomcom_session::headless::run(&mut engine, |stamped: &TimestampedEvent| log.append(stamped))?;
            log.flush()?;
            (engine.into_follower(), false, moved)
        }
    };
    let (arm, figures) = (follower.session.study_arm(), TrialSummary::from_follower(&follower));
    kept.keep(kitchen, follower.cost);
    Ok(SimulatedTrial { folder, arm, figures, found, moved })
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
    let moved = describe_moved(&figures.moved);
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
         {excluded}\
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

/// One line of text for each log that was moved out of the way, since it ends before the end of its header.
pub(super) fn describe_moved(moved: &[String]) -> String {
    let line = |log: &String| {
        format!("a log that ended before the end of its header was moved to {log}; its trial was simulated again\n")
    };
    moved.iter().map(line).collect()
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
