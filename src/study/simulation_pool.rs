//! A pool of simulated participants, from which studies are drawn ([`super::drawn_study`]): of every trial only what an analysis counts.
//!
//! Each participant has its starting group and one trial in each arm of the plan. Beside each trial there can be its unassisted twin: the
//! same participant, orders and random streams without signals. Twins tell how large an effect has to be to be found, and how often a test
//! finds one where there is none.
//!
//! A pool is a file of JSON Lines: a [`PoolHeader`], then one [`PoolTrial`] a line. Parts of a pool, simulated as shards, are joined.

use serde::{Deserialize, Serialize};

use crate::session::plan::{PrimaryOutcome, StudyAims};
use crate::session::study_arm::StudyArm;

/// Version of the format.
pub const POOL_FORMAT: u32 = 1;

/// The first line of a pool: what its participants have in common.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolHeader {
    /// Version of the format.
    pub pool: u32,
    /// Version of the program that simulated it.
    pub program: String,
    /// The plan's name.
    pub plan: String,
    /// Checksum of plan and settings, as recordings have it, with the pool's seed.
    pub digest: String,
    /// The seed of everything random.
    pub seed: u64,
    /// Number of participants of the whole pool.
    pub participants: u32,
    /// Which part this is; 1 is the first.
    pub shard: u64,
    /// Number of parts.
    pub shards: u64,
    /// The conditions of the plan.
    pub conditions: Vec<StudyArm>,
    /// What the plan asks.
    pub aims: StudyAims,
    /// Whether trials were simulated in the arms of the plan.
    pub arms: bool,
    /// Whether the unassisted twins of these trials were simulated.
    pub unassisted: bool,
}

/// A line of a pool: a simulated trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoolTrial {
    /// The participant's place in the plan, from 0.
    pub participant: u32,
    /// The starting group, as in "AB".
    pub group: String,
    /// Number of the trial, from 1.
    pub period: u32,
    /// The arm that the plan gives to it.
    pub planned: StudyArm,
    /// The arm by what was done; `none` in an unassisted twin.
    pub arm: StudyArm,
    /// What was counted.
    #[serde(flatten)]
    pub counts: TrialCounts,
}

/// What is counted in a simulated trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrialCounts {
    /// Presses of the human.
    pub human_presses: u64,
    /// Presses of the robot.
    pub robot_presses: u64,
    /// Errors of the human.
    pub errors: u64,
    /// Belief related errors.
    pub belief_related_errors: u64,
    /// Number of errors of each sequence of related errors.
    pub lengths: Vec<u32>,
    /// Orders served.
    pub orders: u64,
    /// Signals that were shown.
    pub signals: u64,
    /// Time with a signal on the display, in seconds.
    pub signal_s: f64,
    /// Length of the trial on its own clock, in seconds.
    pub seconds: f64,
}

impl TrialCounts {
    /// Number of the outcome's events.
    pub fn events(&self, outcome: PrimaryOutcome) -> u64 {
        match outcome {
            PrimaryOutcome::Errors => self.errors,
            PrimaryOutcome::BeliefRelatedErrors => self.belief_related_errors,
            PrimaryOutcome::Sequences => self.lengths.len() as u64,
        }
    }
}

/// A participant of a pool.
#[derive(Clone, Debug, PartialEq)]
pub struct PoolPerson {
    /// The participant's place in the plan, from 0.
    pub participant: u32,
    /// The starting group.
    pub group: String,
    /// The trials, the first period first.
    pub trials: Vec<PersonTrial>,
}

/// A period of a participant of a pool.
#[derive(Clone, Debug, PartialEq)]
pub struct PersonTrial {
    /// The arm that the plan gives to it.
    pub arm: StudyArm,
    /// What was counted in that arm, if it was simulated.
    pub own: Option<TrialCounts>,
    /// What was counted without signals, if it was simulated.
    pub unassisted: Option<TrialCounts>,
}

/// A pool, or a part of one.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationPool {
    /// What the participants have in common.
    pub header: PoolHeader,
    /// The participants, in the order of the plan.
    pub persons: Vec<PoolPerson>,
}

/// What is wrong with the lines of a pool, or with parts that are joined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PoolMismatch {
    /// Index of the line among the trials, or of the part.
    pub index: usize,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: String,
}

impl PoolMismatch {
    fn new(index: usize, found: String, remedy: &str) -> PoolMismatch {
        PoolMismatch { index, found, remedy: remedy.to_string() }
    }
}

impl SimulationPool {
    /// The pool of these lines, which are ordered by participant and period.
    ///
    /// # Errors
    /// A trial is missing, is there twice, or does not belong to the header.
    pub fn from_trials(header: PoolHeader, trials: Vec<PoolTrial>) -> Result<SimulationPool, PoolMismatch> {
        let mut persons: Vec<PoolPerson> = Vec::new();
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
                persons.push(PoolPerson { participant, group, trials: Vec::new() });
            }
            let Some(person) = persons.last_mut().filter(|person| person.participant == trial.participant) else {
                let found = format!("participant {} after {}", trial.participant, next.saturating_sub(1));
                return wrong(found, "participants in order, each once, from 0");
            };
            if person.trials.len() + 1 == trial.period as usize {
                person.trials.push(PersonTrial { arm: trial.planned, own: None, unassisted: None });
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
        let is_whole = |trial: &PersonTrial| {
            (trial.own.is_some() || !header.arms) && (trial.unassisted.is_some() || !header.unassisted)
        };
        let is_complete =
            |person: &PoolPerson| person.trials.len() == header.conditions.len() && person.trials.iter().all(is_whole);
        match persons.iter().find(|person| !is_complete(person)) {
            Some(person) => {
                let found = format!("participant {} without all trials", person.participant);
                Err(PoolMismatch::new(count.saturating_sub(1), found, "a pool that was written to its end"))
            }
            None => Ok(SimulationPool { header, persons }),
        }
    }

    /// The trials as lines, in order.
    pub fn trials(&self) -> impl Iterator<Item = PoolTrial> + '_ {
        self.persons.iter().flat_map(|person| {
            person.trials.iter().zip(1..).flat_map(move |(trial, period)| {
                let line = |arm: StudyArm, counts: &TrialCounts| PoolTrial {
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

    /// The whole pool of these parts.
    ///
    /// # Errors
    /// Parts are of different pools, are there twice, or do not make the whole.
    pub fn joined(parts: Vec<SimulationPool>) -> Result<SimulationPool, PoolMismatch> {
        let Some(first) = parts.first().map(|part| part.header.clone()) else {
            return Err(PoolMismatch::new(0, "no part".to_string(), "at least one"));
        };
        let whole = PoolHeader { shard: 1, shards: 1, ..first.clone() };
        let mut persons: Vec<(usize, PoolPerson)> = Vec::new();
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
