//! A pool of simulated participants, from which studies are drawn ([`super::drawn_study`]), for `tomcom power` and
//! `tomcom arms`. Of every trial it contains only the counts that an analysis needs.
//!
//! Each participant has a starting group and one trial in each arm of the plan. Each trial can have an unassisted twin:
//! the same participant, orders and random streams, without signals. Twins tell how large an effect has to be to be
//! detected, and how often a test rejects without an effect.
//!
//! A pool is a file of JSON Lines: a [`PoolHeader`], then one [`PoolTrial`] per line. Parts of a pool, simulated as
//! shards, are joined.

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::analysis::trial_summary::{SignalTimes, TrialSummary};
use crate::kept_cost::KeptCost;
use crate::parallel;
use crate::study_part::ShardMismatch;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::SessionSpec;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::headless::SimulationShard;
use tomcom_session::plan::{Participants, PrimaryOutcome, Study, StudyAims};
use tomcom_session::settings::Condition;
use tomcom_session::study_arm::StudyArm;

#[derive(Clone, Debug)]
pub struct PoolRequest {
    pub files: SessionSetup,
    pub participants: u32,
    pub shard: SimulationShard,
    pub arms: bool,
    /// Whether unassisted twins (the same trials without signals) are simulated.
    pub unassisted: bool,
}

#[derive(Clone, Copy, Debug)]
struct PoolItem {
    participant: u32,
    period: u32,
    is_twin: bool,
}

struct PoolStudy<'a> {
    request: &'a PoolRequest,
    study: Study,
    header: PoolHeader,
}

impl PoolRequest {
    /// Header of the pool: the first line of its file. Errors: the session file has no study plan.
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

    /// Checks that the plan's trials can be simulated; `path` is the plan's file. Errors: the plan has fewer than two
    /// conditions, or a condition in which only a person could send signals.
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
        if conditions.contains(&StudyArm::External) {
            let found = "the condition external, whose program is not started here".to_string();
            return wrong(found, "a plan without it; tomcom tournament compares external concepts");
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

    fn planned(&self, item: PoolItem) -> StudyArm {
        self.study.group(item.participant as usize).conditions[item.period as usize - 1]
    }

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

    fn simulate(&self, kitchen: &Arc<Kitchen>, item: PoolItem, kept: &mut KeptCost) -> PoolTrial {
        let (spec, arm, trial) = self.settings(item);
        let engine = SessionEngine::new(kitchen.clone(), spec, trial, kept.take(kitchen));
        let mut engine = engine.without_unused_estimate();
        let mut signals = SignalTimes::default();
        tomcom_session::headless::run(&mut engine, |stamped| signals.note(stamped));
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

/// `path`: of the plan; `done` is called after each trial.
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

pub const POOL_FORMAT: u32 = 1;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolHeader {
    pub pool: u32,
    pub program: String,
    pub plan: String,
    /// Checksum of plan and settings, as recordings have it, computed with the pool's seed.
    pub digest: String,
    pub seed: u64,
    pub participants: u32,
    /// Number of this shard of the pool, from 1.
    pub shard: u64,
    pub shards: u64,
    pub conditions: Vec<StudyArm>,
    pub aims: StudyAims,
    pub arms: bool,
    pub unassisted: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolTrial {
    /// Index of the participant in the plan, from 0.
    pub participant: u32,
    pub group: String,
    /// Number of the trial in the participant's series, from 1.
    pub period: u32,
    pub planned: StudyArm,
    /// Study arm of the trial as it was carried out; `none` in an unassisted twin.
    pub arm: StudyArm,
    #[serde(flatten)]
    pub counts: PoolTrialCounts,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoolTrialCounts {
    pub human_presses: u64,
    pub robot_presses: u64,
    pub errors: u64,
    pub belief_related_errors: u64,
    /// Length (number of errors) of each error sequence, whose errors follow from the same false belief.
    pub lengths: Vec<u32>,
    pub orders: u64,
    pub signals: u64,
    pub signal_s: f64,
    pub seconds: f64,
}

impl PoolTrialCounts {
    pub fn events(&self, outcome: PrimaryOutcome) -> u64 {
        match outcome {
            PrimaryOutcome::Errors => self.errors,
            PrimaryOutcome::BeliefRelatedErrors => self.belief_related_errors,
            PrimaryOutcome::Sequences => self.lengths.len() as u64,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct PoolParticipant {
    pub participant: u32,
    pub group: String,
    /// Trials of the participant, in the order of periods.
    pub trials: Vec<PoolTrialPair>,
}

/// A period of a pool's participant, with its counts in the planned arm and without signals.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolTrialPair {
    pub arm: StudyArm,
    /// Counts of the trial in the planned arm; `None` if that trial was not simulated.
    pub own: Option<PoolTrialCounts>,
    /// Counts of the trial without signals; `None` if it was not simulated.
    pub unassisted: Option<PoolTrialCounts>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct SimulationPool {
    pub header: PoolHeader,
    pub persons: Vec<PoolParticipant>,
}

impl SimulationPool {
    /// `trials`: by participant and period. Errors: one is missing, occurs twice, or does not fit the header.
    pub fn from_trials(header: PoolHeader, trials: Vec<PoolTrial>) -> Result<SimulationPool, ShardMismatch> {
        let mut persons: Vec<PoolParticipant> = Vec::new();
        let count = trials.len();
        for (index, trial) in trials.into_iter().enumerate() {
            let wrong = |found: String, remedy: &str| Err(ShardMismatch::new(index, found, remedy));
            if !header.conditions.contains(&trial.planned) || trial.counts.human_presses == 0 {
                let found = format!("a trial of {} with {} presses", trial.planned.name(), trial.counts.human_presses);
                return wrong(found, "a trial of the pool's conditions with presses of the human");
            }
            let next = persons.last().map_or(0, |person| person.participant + 1);
            if trial.participant >= next && trial.participant < header.participants {
                let (participant, group) = (trial.participant, trial.group.clone());
                persons.push(PoolParticipant { participant, group, trials: Vec::new() });
            }
            let Some(person) = persons.last_mut().filter(|person| person.participant == trial.participant) else {
                let found = format!("participant {} after {}", trial.participant, next.saturating_sub(1));
                return wrong(found, "participants in order, each once, from 0");
            };
            if person.trials.len() + 1 == trial.period as usize {
                person.trials.push(PoolTrialPair { arm: trial.planned, own: None, unassisted: None });
            }
            let is_last = person.trials.len() == trial.period as usize;
            let Some(slot) = person.trials.last_mut().filter(|slot| is_last && slot.arm == trial.planned) else {
                let found = format!("trial {} of participant {}", trial.period, trial.participant);
                return wrong(found, "a participant's trials in order, from 1");
            };
            let places =
                [(trial.arm == trial.planned, &mut slot.own), (trial.arm == StudyArm::None, &mut slot.unassisted)];
            for (is_it, place) in places {
                if is_it {
                    *place = Some(trial.counts.clone());
                }
            }
        }
        let is_whole = |trial: &PoolTrialPair| {
            (trial.own.is_some() || !header.arms) && (trial.unassisted.is_some() || !header.unassisted)
        };
        let is_complete = |person: &PoolParticipant| {
            person.trials.len() == header.conditions.len() && person.trials.iter().all(is_whole)
        };
        match persons.iter().find(|person| !is_complete(person)) {
            Some(person) => {
                let found = format!("participant {} without all trials", person.participant);
                Err(ShardMismatch::new(count.saturating_sub(1), found, "a pool that was written to its end"))
            }
            None => Ok(SimulationPool { header, persons }),
        }
    }

    pub fn trials(&self) -> impl Iterator<Item = PoolTrial> + '_ {
        self.persons.iter().flat_map(|person| {
            person.trials.iter().zip(1..).flat_map(move |(trial, period)| {
                let line = |arm: StudyArm, counts: &PoolTrialCounts| PoolTrial {
                    participant: person.participant,
                    group: person.group.clone(),
                    period,
                    planned: trial.arm,
                    arm,
                    counts: counts.clone(),
                };
                let own = trial.own.as_ref().map(|counts| line(trial.arm, counts));
                let twin = trial.unassisted.as_ref().filter(|_| trial.arm != StudyArm::None || own.is_none());
                own.into_iter().chain(twin.map(|counts| line(StudyArm::None, counts)))
            })
        })
    }

    /// Errors: shards are of different pools, occur twice, or are not complete.
    pub fn joined(parts: Vec<SimulationPool>) -> Result<SimulationPool, ShardMismatch> {
        let Some(first) = parts.first().map(|part| part.header.clone()) else {
            return Err(ShardMismatch::new(0, "no part".to_string(), "at least one"));
        };
        let whole = PoolHeader { shard: 1, shards: 1, ..first.clone() };
        let mut persons: Vec<(usize, PoolParticipant)> = Vec::new();
        for (index, part) in parts.into_iter().enumerate() {
            if (PoolHeader { shard: 1, shards: 1, ..part.header.clone() }) != whole
                || part.header.shards != first.shards
            {
                let found = "a part of another pool than the first file".to_string();
                return Err(ShardMismatch::new(
                    index,
                    found,
                    "parts of one plan, seed, number of participants and program",
                ));
            }
            persons.extend(part.persons.into_iter().map(|person| (index, person)));
        }
        persons.sort_by_key(|(_, person)| person.participant);
        if let Some(pair) = persons.windows(2).find(|pair| pair[0].1.participant == pair[1].1.participant) {
            let found = format!("participant {}, who is in another part, too", pair[1].1.participant);
            return Err(ShardMismatch::new(pair[1].0, found, "each part once"));
        }
        if persons.len() != whole.participants as usize {
            let found = format!("{} of {} participants", persons.len(), whole.participants);
            return Err(ShardMismatch::new(0, found, "all parts of the pool, such as 1/4 to 4/4"));
        }
        Ok(SimulationPool { header: whole, persons: persons.into_iter().map(|(_, person)| person).collect() })
    }
}
