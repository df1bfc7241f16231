//! Simulates the participants of a pool in memory ([`crate::simulation_pool`]): every trial of the plan, and its
//! unassisted twin (the same trial without signals). The commands `tomcom power` and `tomcom arms` use the pool.

use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;

use super::kept_cost::KeptCost;
use super::parallel;
use crate::analysis::signal_time::SignalTimes;
use crate::analysis::trial_summary::TrialSummary;
use crate::simulation_pool::{POOL_FORMAT, PoolHeader, PoolTrial, PoolTrialCounts, SimulationPool};
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::plan::{Participants, Study};
use tomcom_session::settings::Condition;
use tomcom_session::headless::SimulationShard;
use tomcom_session::study_arm::StudyArm;
use tomcom_session::{SessionSpec, TimestampedEvent};

/// Request to simulate a pool of participants, from which studies are drawn.
#[derive(Clone, Debug)]
pub struct PoolRequest {
    /// Settings that contain the study plan, with the files that they name.
    pub files: SessionSetup,
    /// Number of participants in the whole pool, instead of the plan's number.
    pub participants: u32,
    /// Shard (part) of the pool that is simulated here.
    pub shard: SimulationShard,
    /// Whether trials are simulated in the study arms that the plan gives to them.
    pub arms: bool,
    /// Whether unassisted twins (the same trials without signals) are simulated.
    pub unassisted: bool,
}

/// A trial of a pool that has to be simulated.
#[derive(Clone, Copy, Debug)]
struct PoolItem {
    participant: u32,
    period: u32,
    is_twin: bool,
}

/// A request to simulate a pool, with the plan's study made for the pool's participants.
struct PoolStudy<'a> {
    request: &'a PoolRequest,
    /// The study with the pool's participants instead of the plan's.
    study: Study,
    header: PoolHeader,
}

impl PoolRequest {
    /// Header of the pool: the first line of its file.
    ///
    /// # Errors
    /// The session file has no study plan.
    pub fn header(&self, path: &Path) -> FileResult<PoolHeader> {
        Ok(self.study(path)?.header)
    }

    fn study(&self, path: &Path) -> FileResult<PoolStudy<'_>> {
        let Some(mut study) = self.files.study() else {
            let remedy = "a session file with a [plan], like sessions/arms.toml".to_string();
            return Err(FileError::from_finding(path, "a session without a plan".to_string(), remedy));
        };
        study.plan.participants = Participants::Count(self.participants);
        let header = PoolHeader {
            pool: POOL_FORMAT,
            program: env!("CARGO_PKG_VERSION").to_string(),
            plan: study.plan.name.clone(),
            digest: study.digest.clone(),
            seed: study.session.seed,
            participants: self.participants,
            shard: self.shard.number,
            shards: self.shard.of,
            conditions: study.plan.conditions.clone(),
            aims: study.plan.aims,
            arms: self.arms,
            unassisted: self.unassisted,
        };
        Ok(PoolStudy { request: self, study, header })
    }

    /// Checks that the plan's trials can be simulated; `path` is the plan's file.
    ///
    /// # Errors
    /// The plan has fewer than two conditions, or a condition in which only a person could send signals.
    pub fn check(&self, path: &Path) -> FileResult<()> {
        let pool = self.study(path)?;
        let wrong = |found: String, remedy: &str| Err(FileError::from_finding(path, found, remedy.to_string()));
        let conditions = &pool.header.conditions;
        if conditions.len() < 2 {
            return wrong(
                "a plan with one condition".to_string(),
                "a plan with two conditions or more, which can be compared",
            );
        }
        for period in (1..=conditions.len() as u32).filter(|_| self.arms) {
            let item = PoolItem { participant: 0, period, is_twin: false };
            let (planned, done) = (pool.planned(item), pool.settings(item).1);
            if planned != done {
                let found = format!("the condition {}, which would be simulated as {}", planned.name(), done.name());
                return wrong(found, "[wizard] with kind = \"scripted\", and conditions that the script can carry out");
            }
        }
        Ok(())
    }

    /// Number of trials that have to be simulated for the pool.
    pub fn trials(&self, path: &Path) -> FileResult<u64> {
        Ok(self.study(path)?.items().len() as u64)
    }
}

impl PoolStudy<'_> {
    /// The trials of the shard, ordered by participant and period; an unassisted twin follows its trial.
    fn items(&self) -> Vec<PoolItem> {
        let SimulationShard { number, of } = self.request.shard;
        let own = (0..self.request.participants).filter(|&one| u64::from(one) % of == number - 1);
        let periods = self.header.conditions.len() as u32;
        let items = own.flat_map(|participant| {
            (1..=periods).flat_map(move |period| [false, true].map(|is_twin| PoolItem { participant, period, is_twin }))
        });
        let is_asked = |item: &PoolItem| match (self.planned(*item), item.is_twin) {
            // A trial that is unassisted anyway needs no unassisted twin.
            (StudyArm::None, is_twin) => !is_twin,
            (_, true) => self.request.unassisted,
            (_, false) => self.request.arms,
        };
        items.filter(is_asked).collect()
    }

    /// Study arm that the plan gives to a trial of the pool.
    fn planned(&self, item: PoolItem) -> StudyArm {
        self.study.group(item.participant as usize).conditions[item.period as usize - 1]
    }

    /// Settings of a trial of the pool, its study arm as it will be carried out, and the trial's number.
    fn settings(&self, item: PoolItem) -> (SessionSpec, StudyArm, u64) {
        let (mut spec, trial) = self.study.simulated(item.participant as usize, item.period);
        if item.is_twin {
            spec.trial.condition = Condition::None;
        }
        let done = match item.is_twin {
            true => StudyArm::None,
            false => spec.step.as_ref().and_then(|step| step.arm).unwrap_or_default(),
        };
        if done != StudyArm::WizardWithAdvice {
            // Advice that nobody sees is not computed, since it would only cost computing time.
            spec.assistant.shadow = ShadowMode::Off;
        }
        (spec, done, trial)
    }

    /// Simulates a trial of the pool.
    fn simulate(&self, kitchen: &Arc<Kitchen>, item: PoolItem, kept: &mut KeptCost) -> PoolTrial {
        let (spec, arm, trial) = self.settings(item);
        let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, kept.take(kitchen));
        let mut signals = SignalTimes::default();
        let keep = |stamped: &TimestampedEvent| {
            signals.note(stamped);
            Ok::<(), Infallible>(())
        };
        tomcom_session::headless::run(&mut engine, keep).unwrap_or_else(|never| match never {});
        let follower = engine.into_follower();
        let summary = TrialSummary::from_follower(&follower);
        // Simulated participants record their beliefs before every press, so false beliefs are known.
        let beliefs = summary.beliefs.unwrap_or_default();
        let counts = PoolTrialCounts {
            human_presses: summary.human_actions,
            robot_presses: summary.robot_actions,
            errors: summary.errors,
            belief_related_errors: beliefs.related,
            lengths: beliefs.sequences.iter().map(|sequence| sequence.length()).collect(),
            orders: summary.served.len() as u64,
            signals: summary.signals,
            signal_s: signals.seconds(&follower.session),
            seconds: summary.seconds,
        };
        let group = self.study.group(item.participant as usize).name;
        let PoolItem { participant, period, .. } = item;
        let planned = self.planned(item);
        kept.keep(kitchen, follower.cost);
        PoolTrial { participant, group, period, planned, arm, counts }
    }
}

/// Simulates the participants of the pool's shard on all processors. `path` is the file of the plan; `done` is called
/// after each trial.
///
/// # Errors
/// The errors of [`PoolRequest::check`], or a trial ends without a press of the human.
pub fn simulate(request: &PoolRequest, path: &Path, done: impl Fn() + Sync) -> FileResult<SimulationPool> {
    request.check(path)?;
    let pool = request.study(path)?;
    let kitchen = Arc::new(request.files.kitchen.kitchen.clone());
    let one = |kept: &mut KeptCost, item: &PoolItem| pool.simulate(&kitchen, *item, kept);
    let trials = parallel::each_with(&pool.items(), KeptCost::default, one, done);
    let header = pool.header.clone();
    SimulationPool::from_trials(header, trials)
        .map_err(|wrong| FileError::from_finding(path, wrong.found, wrong.remedy))
}
