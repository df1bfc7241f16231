//! Pool of simulated participants, from which studies are drawn ([`super::drawn_study`]); of every trial, the pool
//! contains only the counts that an analysis needs.
//!
//! Each participant has a starting group and one trial in each arm of the plan. Each trial can have an unassisted twin:
//! the same participant, orders and random streams, without signals. Twins tell how large an effect has to be to be
//! detected, and how often a test rejects without an effect.
//!
//! A pool is a file of JSON Lines: a [`PoolHeader`], then one [`PoolTrial`] per line. Parts of a pool, simulated as
//! shards, are joined.

use serde::{Deserialize, Serialize};

use tomcom_session::plan::{PrimaryOutcome, StudyAims};
use tomcom_session::study_arm::StudyArm;

/// Version of the pool's file format.
pub const POOL_FORMAT: u32 = 1;

/// First line of a pool's file (header): what the pool's participants have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolHeader {
    /// Version of the file format of pools.
    pub pool: u32,
    /// Version of the program that simulated the pool.
    pub program: String,
    /// Name of the study plan.
    pub plan: String,
    /// Checksum of plan and settings, as recordings have it, computed with the pool's seed.
    pub digest: String,
    /// Seed of all random numbers of the pool's simulation.
    pub seed: u64,
    /// Number of participants in the whole pool.
    pub participants: u32,
    /// Number of this shard of the pool, from 1.
    pub shard: u64,
    /// Number of shards into which the pool is divided.
    pub shards: u64,
    /// Conditions of the study plan.
    pub conditions: Vec<StudyArm>,
    /// Primary outcome and margin of non-inferiority that the plan sets.
    pub aims: StudyAims,
    /// Whether trials were simulated in the study arms of the plan.
    pub arms: bool,
    /// Whether the unassisted twins (the same trials without signals) were simulated.
    pub unassisted: bool,
}

/// A line of a pool's file: one simulated trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolTrial {
    /// Index of the participant in the plan, from 0.
    pub participant: u32,
    /// Starting group of the participant, such as "AB".
    pub group: String,
    /// Number of the trial in the participant's series, from 1.
    pub period: u32,
    /// Study arm that the plan gives to the trial.
    pub planned: StudyArm,
    /// Study arm of the trial as it was carried out; `none` in an unassisted twin.
    pub arm: StudyArm,
    /// Counts of presses, errors, signals and orders in the trial.
    #[serde(flatten)]
    pub counts: PoolTrialCounts,
}

/// Counts of presses, errors, signals and orders in a simulated trial of a pool.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PoolTrialCounts {
    /// Number of the human's presses.
    pub human_presses: u64,
    /// Number of the robot's presses.
    pub robot_presses: u64,
    /// Number of the human's errors.
    pub errors: u64,
    /// Number of errors that follow from false beliefs.
    pub belief_related_errors: u64,
    /// Length (number of errors) of each error sequence, whose errors follow from the same false belief.
    pub lengths: Vec<u32>,
    /// Number of orders served in the trial.
    pub orders: u64,
    /// Number of signals shown to the participant.
    pub signals: u64,
    /// Time during which a signal was on the display, in seconds.
    pub signal_s: f64,
    /// Length of the trial on its own clock, in seconds.
    pub seconds: f64,
}

impl PoolTrialCounts {
    /// Number of events of the primary outcome in the trial.
    pub fn events(&self, outcome: PrimaryOutcome) -> u64 {
        match outcome {
            PrimaryOutcome::Errors => self.errors,
            PrimaryOutcome::BeliefRelatedErrors => self.belief_related_errors,
            PrimaryOutcome::Sequences => self.lengths.len() as u64,
        }
    }
}

/// A participant of a pool with all trials of this participant.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolParticipant {
    /// Index of the participant in the plan, from 0.
    pub participant: u32,
    /// Starting group of the participant.
    pub group: String,
    /// Trials of the participant, in the order of periods.
    pub trials: Vec<PoolTrialPair>,
}

/// A period of a pool's participant, with its counts in the planned arm and without signals.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolTrialPair {
    /// Study arm that the plan gives to this period of the participant.
    pub arm: StudyArm,
    /// Counts of the trial in the planned arm; `None` if that trial was not simulated.
    pub own: Option<PoolTrialCounts>,
    /// Counts of the trial without signals; `None` if it was not simulated.
    pub unassisted: Option<PoolTrialCounts>,
}

/// A pool of simulated participants, or a shard of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationPool {
    /// Plan, settings and seed that all participants of the pool have in common.
    pub header: PoolHeader,
    /// The pool's participants, in the order of the plan.
    pub persons: Vec<PoolParticipant>,
}

/// Mismatch in the lines of a pool's file, or between shards that are joined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PoolMismatch {
    /// Index of the mismatching line among the trials, or of the mismatching shard.
    pub index: usize,
    /// Description of the mismatch that was found.
    pub found: String,
    /// Advice on how to remedy the mismatch.
    pub remedy: String,
}

impl PoolMismatch {
    fn new(index: usize, found: String, remedy: &str) -> PoolMismatch {
        PoolMismatch { index, found, remedy: remedy.to_string() }
    }
}

impl SimulationPool {
    /// The pool that consists of these trials, which are ordered by participant and period.
    ///
    /// # Errors
    /// A trial is missing, occurs twice, or does not fit the header.
    pub fn from_trials(header: PoolHeader, trials: Vec<PoolTrial>) -> Result<SimulationPool, PoolMismatch> {
        let mut persons: Vec<PoolParticipant> = Vec::new();
        let count = trials.len();
        for (index, trial) in trials.into_iter().enumerate() {
            let wrong = |found: String, remedy: &str| Err(PoolMismatch::new(index, found, remedy));
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
                Err(PoolMismatch::new(count.saturating_sub(1), found, "a pool that was written to its end"))
            }
            None => Ok(SimulationPool { header, persons }),
        }
    }

    /// The pool's trials as lines of its file, in order.
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

    /// The whole pool, joined from these shards.
    ///
    /// # Errors
    /// Shards are of different pools, occur twice, or are not complete.
    pub fn joined(parts: Vec<SimulationPool>) -> Result<SimulationPool, PoolMismatch> {
        let Some(first) = parts.first().map(|part| part.header.clone()) else {
            return Err(PoolMismatch::new(0, "no part".to_string(), "at least one"));
        };
        let whole = PoolHeader { shard: 1, shards: 1, ..first.clone() };
        let mut persons: Vec<(usize, PoolParticipant)> = Vec::new();
        for (index, part) in parts.into_iter().enumerate() {
            if (PoolHeader { shard: 1, shards: 1, ..part.header.clone() }) != whole
                || part.header.shards != first.shards
            {
                let found = "a part of another pool than the first file".to_string();
                return Err(PoolMismatch::new(
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
            return Err(PoolMismatch::new(pair[1].0, found, "each part once"));
        }
        if persons.len() != whole.participants as usize {
            let found = format!("{} of {} participants", persons.len(), whole.participants);
            return Err(PoolMismatch::new(0, found, "all parts of the pool, such as 1/4 to 4/4"));
        }
        Ok(SimulationPool { header: whole, persons: persons.into_iter().map(|(_, person)| person).collect() })
    }
}
