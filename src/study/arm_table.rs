//! Table of all arms of a plan in simulated trials: rates of each arm with confidence intervals, and contrasts between
//! arms.

use serde::Serialize;

use crate::arm_comparison::{StudyArmComparison, StudyArmTrial, compare_counts};
use crate::pool::{PoolTrialCounts, SimulationPool};
use crate::statistics::interval_where_known;
use tomcom_session::plan::{PrimaryOutcome, StudyAims};
use tomcom_session::study_arm::StudyArm;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyArmStatistic {
    /// The statistic over all trials of the arm; null where it cannot be computed.
    pub value: Option<f64>,
    /// Confidence interval of the arm's statistic; null with fewer than five participants.
    pub interval: Option<[f64; 2]>,
}

impl StudyArmStatistic {
    /// "5.1 (4.2 to 6.3)", or "-".
    pub(crate) fn in_words(self, scale: f64, digits: usize) -> String {
        let Some(value) = self.value else { return "-".to_string() };
        let value = format!("{:.digits$}", scale * value);
        match self.interval {
            Some([low, high]) => format!("{value} ({:.digits$} to {:.digits$})", scale * low, scale * high),
            None => value,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyArmRow {
    pub arm: StudyArm,
    pub trials: u64,
    pub errors_per_100: StudyArmStatistic,
    /// Errors that follow from false beliefs, per 100 presses of the human.
    pub related_per_100: StudyArmStatistic,
    /// Mean number of errors in a sequence that follows from the same false belief.
    pub sequence_length: StudyArmStatistic,
    pub orders_per_minute: StudyArmStatistic,
    pub signals_per_100: StudyArmStatistic,
    pub signal_time: StudyArmStatistic,
}

/// Comparison of all study arms in simulated trials: the output of `tomcom arms`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyArmTable {
    pub plan: String,
    pub digest: String,
    pub program: String,
    pub seed: u64,
    pub participants: u32,
    pub arms: Vec<StudyArmRow>,
    /// By errors and by errors from false beliefs; those that cannot be estimated are left out.
    pub comparisons: Vec<StudyArmComparison>,
}

impl StudyArmRow {
    fn new(arm: StudyArm, trials: &[&PoolTrialCounts]) -> StudyArmRow {
        let figure = |value: fn(&[&PoolTrialCounts]) -> Option<f64>| StudyArmStatistic {
            value: value(trials),
            interval: interval_where_known(trials, value),
        };
        StudyArmRow {
            arm,
            trials: trials.len() as u64,
            errors_per_100: figure(|trials| per_100(trials, |trial| trial.errors)),
            related_per_100: figure(|trials| per_100(trials, |trial| trial.belief_related_errors)),
            sequence_length: figure(|trials| {
                let errors = sum(trials, |trial| trial.lengths.iter().map(|&length| f64::from(length)).sum());
                ratio(errors, sum(trials, |trial| trial.lengths.len() as f64))
            }),
            orders_per_minute: figure(|trials| {
                ratio(60.0 * sum(trials, |trial| trial.orders as f64), sum(trials, |trial| trial.seconds))
            }),
            signals_per_100: figure(|trials| per_100(trials, |trial| trial.signals)),
            signal_time: figure(|trials| ratio(sum(trials, |one| one.signal_s), sum(trials, |one| one.seconds))),
        }
    }
}

fn sum(trials: &[&PoolTrialCounts], value: fn(&PoolTrialCounts) -> f64) -> f64 {
    trials.iter().map(|trial| value(trial)).sum()
}

fn ratio(part: f64, whole: f64) -> Option<f64> {
    (whole > 0.0).then(|| part / whole)
}

fn per_100(trials: &[&PoolTrialCounts], number: fn(&PoolTrialCounts) -> u64) -> Option<f64> {
    let number = trials.iter().map(|trial| number(trial)).sum::<u64>() as f64;
    ratio(100.0 * number, sum(trials, |trial| trial.human_presses as f64))
}

impl StudyArmTable {
    pub fn from_pool(pool: &SimulationPool) -> StudyArmTable {
        let header = &pool.header;
        let row = |arm: StudyArm| {
            let own = pool.persons.iter().flat_map(|person| &person.trials).filter(|trial| trial.arm == arm);
            let counts: Vec<&PoolTrialCounts> = own.filter_map(|trial| trial.own.as_ref()).collect();
            (!counts.is_empty()).then(|| StudyArmRow::new(arm, &counts))
        };
        let outcomes = [PrimaryOutcome::Errors, PrimaryOutcome::BeliefRelatedErrors];
        let compared = |outcome| compare_counts(counted(pool, outcome), StudyAims { outcome, ..header.aims });
        StudyArmTable {
            plan: header.plan.clone(),
            digest: header.digest.clone(),
            program: header.program.clone(),
            seed: header.seed,
            participants: header.participants,
            arms: StudyArm::ALL.into_iter().filter_map(row).collect(),
            comparisons: outcomes.into_iter().filter_map(compared).collect(),
        }
    }
}

fn counted(pool: &SimulationPool, outcome: PrimaryOutcome) -> Vec<StudyArmTrial> {
    let persons = pool.persons.iter().enumerate();
    let trials = persons.flat_map(|(participant, person)| {
        person.trials.iter().zip(1..).filter_map(move |(trial, period)| {
            let counts = trial.own.as_ref()?;
            let (events, presses) = (counts.events(outcome), counts.human_presses);
            Some(StudyArmTrial { participant, period, arm: trial.arm, events, presses })
        })
    });
    trials.collect()
}

pub fn describe(table: &StudyArmTable) -> String {
    let mut text = format!(
        "plan {} ({}), seed {}: {} simulated participants, each with a trial in every condition\n\n",
        table.plan, table.digest, table.seed, table.participants
    );
    text += "| condition | trials | errors /100 | belief related /100 | errors per sequence | orders a minute | signals /100 | time with a signal, % |\n";
    text += "|---|---|---|---|---|---|---|---|\n";
    for row in &table.arms {
        let cells = [
            row.errors_per_100.in_words(1.0, 1),
            row.related_per_100.in_words(1.0, 1),
            row.sequence_length.in_words(1.0, 2),
            row.orders_per_minute.in_words(1.0, 2),
            row.signals_per_100.in_words(1.0, 1),
            row.signal_time.in_words(100.0, 1),
        ];
        text += &format!("| {} | {} | {} |\n", row.arm.title(), row.trials, cells.join(" | "));
    }
    text += "\nper 100 presses of the human; in brackets intervals of 95 %, by a bootstrap over participants\n";
    let without = table.arms.iter().any(|row| row.sequence_length.value.is_none());
    text + if without { "-: no sequence of errors\n" } else { "" }
}
