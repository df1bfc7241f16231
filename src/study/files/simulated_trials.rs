//! Simulates whole trials in virtual time into recordings. A trial's result does not depend on the number of trials.
//!
//! Trials are simulated on all processors in blocks and summed up in their order, so that results do not depend on
//! timing, and memory use does not grow. A trial whose complete recording with the same header exists is read instead
//! of simulated. A shard takes every n-th trial.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use crate::analysis::trial_summary::TrialSummary;
use crate::kept_cost::KeptCost;
use crate::parallel::WorkerPool;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::SessionSetup;
use tomcom_session::headless::{AdviceTime, Outside, SimulationShard};
use tomcom_session::log::{
    LogReader, RecordingError, RecordingLock, RecordingWriteError, SimulatedLogState, check_simulated,
};
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::{Condition, SessionSpec};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{LogHeader, TimestampedEvent, headless};

#[derive(Clone, Debug)]
pub struct SimulationRequest {
    pub files: SessionSetup,
    /// Total number of trials, over all shards of the simulation.
    pub trials: u64,
    pub shard: SimulationShard,
    pub out: PathBuf,
}

impl SimulationRequest {
    pub fn own_trials(&self) -> impl Iterator<Item = u64> + Clone {
        let SimulationShard { number, of } = self.shard;
        (number - 1..self.trials).step_by(of as usize)
    }
}

/// Period of polling a trial that another program is simulating.
const LOOK: Duration = Duration::from_millis(50);
/// Number of trials whose results are held in memory before they are summed up.
const BLOCK: usize = 256;

/// Without a scripted wizard, the wizard condition becomes unassisted. Every trial has a participant of its own.
pub fn settings_of_trial(spec: &SessionSpec, trial: u64) -> SessionSpec {
    let mut spec = spec.clone();
    if spec.unattended(spec.trial.condition) != spec.trial.condition {
        // Without a wizard, nobody would see the assistant's advice, so it is not computed.
        (spec.trial.condition, spec.assistant.shadow) = (Condition::None, ShadowMode::Off);
    }
    spec.participant.code = format!("S{:03}", trial + 1);
    spec
}

pub struct SimulatedTrial {
    pub folder: PathBuf,
    pub arm: StudyArm,
    pub figures: TrialSummary,
    /// Whether the trial's recording existed before, or another program made it in the meantime.
    pub found: bool,
    /// Whether a program of other people took part, or was to.
    pub has_external_mind: bool,
    /// New path of a log that ended before the end of its header and was moved out of the way.
    pub moved: Option<PathBuf>,
    /// Computing time of the assistant; `None` of a recording that existed before.
    pub advice: Option<AdviceTime>,
    /// Why the trial was aborted: an external mind failed.
    pub failed: Option<String>,
}

/// Simulates the trials on all processors and passes the trials to `take` one by one, in order. Trials that another
/// program is simulating in this folder are waited for after all others. Errors: a recording cannot be written, its
/// folder holds another recording, or an exclusion file is damaged; the first error of `take`.
pub fn each_trial(
    simulation: &SimulationRequest,
    outside: Outside,
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
            let simulated = simulate_trial(simulation, &kitchen, *trial, outside, kept);
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

fn wait_for_any(simulation: &SimulationRequest, trials: &[u64]) {
    let folder = |&trial: &u64| folder_of_trial(&simulation.out, &header_of_trial(simulation, trial).session);
    let folders: Vec<PathBuf> = trials.iter().map(folder).collect();
    while folders.iter().all(|folder| RecordingLock::holder(folder).is_some()) {
        std::thread::sleep(LOOK);
    }
}

/// Folder of a trial's recording; the folder's name does not depend on the number of trials.
fn folder_of_trial(out: &Path, spec: &SessionSpec) -> PathBuf {
    let period = spec.step.as_ref().and_then(|step| step.period);
    let period = period.map_or(String::new(), |period| format!("-{period}"));
    out.join(format!("seed{}-{}{period}", spec.seed, spec.participant.code))
}

/// With a study plan, trials are ordered by participant; without one, each trial has a participant of its own.
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

/// Simulates a trial, or reads its complete recording. `kept`: the cost to go of this thread's last trial.
fn simulate_trial(
    simulation: &SimulationRequest,
    kitchen: &Arc<Kitchen>,
    trial: u64,
    outside: Outside,
    kept: &mut KeptCost,
) -> Result<SimulatedTrial, RecordingError> {
    let header = header_of_trial(simulation, trial);
    let folder = folder_of_trial(&simulation.out, &header.session);
    let opened = SimulatedLogState::open(&folder, &header)?;
    let cost = kept.take(kitchen);
    let (follower, found, moved, advice) = match opened {
        SimulatedLogState::Whole => {
            let mut replay = RecordingReplay::over(LogReader::open(&folder)?, cost);
            replay.run()?;
            (replay.follower, true, None, None)
        }
        SimulatedLogState::Begun { mut log, moved } => {
            let mut engine = SessionEngine::new(kitchen.clone(), header.session, header.trial, cost);
            let advice = headless::run_with(&mut engine, outside, |stamped: &TimestampedEvent| log.append(stamped))?;
            log.flush()?;
            (engine.into_follower(), false, moved, Some(advice))
        }
    };
    let failed = follower.session.aborted.clone();
    let has_external_mind = follower.session.spec.has_external_mind();
    let (arm, figures) = (follower.session.study_arm(), TrialSummary::from_follower(&follower));
    kept.keep(kitchen, follower.cost);
    Ok(SimulatedTrial { folder, arm, figures, found, has_external_mind, moved, advice, failed })
}

pub fn describe_moved(moved: &[String]) -> String {
    let line = |log: &String| {
        format!("a log that ended before the end of its header was moved to {log}; its trial was simulated again\n")
    };
    moved.iter().map(line).collect()
}
