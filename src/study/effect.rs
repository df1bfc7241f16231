//! The effect of assistance in a cross-over of two trials: one assisted, one not, in either order.
//!
//! Trials differ in practice as well as in assistance: the second goes better anyway. So the two starting groups are compared
//! in what they improve from the first trial to the second: what is more of it in the group whose second trial is the assisted
//! one is the effect of assistance (the interaction of period and starting group; Senn 2002, Cross-over Trials, chapter 3).

use serde::{Serialize, Serializer};

use super::statistics::{
    Correlation, FTest, Interval, MixedAnova, hedges_g, hodges_lehmann, mixed_anova, pearson, permutation_p,
};
use super::trial::Trial;

/// The level of intervals.
pub const LEVEL: f64 = 0.95;

/// A participant with both trials.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrialPair {
    pub participant: String,
    /// The second trial was the assisted one.
    pub assisted_second: bool,
    /// The measure in the first trial and in the second; the less, the better.
    pub values: [f64; 2],
}

impl TrialPair {
    /// By how much less the second trial has.
    pub fn improvement(&self) -> f64 {
        self.values[0] - self.values[1]
    }

    /// The values without assistance and with it.
    pub fn by_condition(&self) -> [f64; 2] {
        if self.assisted_second { self.values } else { [self.values[1], self.values[0]] }
    }
}

/// A statistic of a trial that is compared between assisted and unassisted trials; of each, less is better. It is a column of
/// the table of trials, two of the table of participants, and a line of the report's tests.
#[derive(Clone, Copy, Debug)]
pub struct StudyMeasure {
    /// Its column in the table of trials, and its name in the figures. The table of participants has it twice, with `_1` and
    /// `_2`.
    pub name: &'static str,
    /// The unit of these columns.
    pub unit: &'static str,
    /// Its definition, for the dictionary; empty where the unit says it.
    pub meaning: &'static str,
    /// The same of one of a participant's trials: `{}` stands for "first" and for "second".
    pub meaning_in: &'static str,
    /// In words, for the report.
    pub title: &'static str,
    /// So many digits behind the point say as much as is known.
    pub digits: usize,
    /// That of a trial, if it has one.
    pub value: fn(&Trial) -> Option<f64>,
}

/// Names are unique: they are columns of one table.
impl PartialEq for StudyMeasure {
    fn eq(&self, other: &StudyMeasure) -> bool {
        self.name == other.name
    }
}

impl Serialize for StudyMeasure {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name)
    }
}

/// What assistance changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssistanceEffect {
    pub measure: StudyMeasure,
    /// Participants whose second trial was the assisted one, and whose first was.
    pub groups: [usize; 2],
    /// Mean improvements of these groups from the first trial to the second.
    pub improvements: [Option<f64>; 2],
    /// Mixed analysis of variance: period within, starting group between; assistance is the interaction.
    pub by_period: MixedAnova,
    /// The paper's coding: condition within, starting group between; assistance is the factor within.
    pub by_condition: MixedAnova,
    /// Of the starting group (1: assisted second) and the improvement; above 0, assistance helps.
    pub pearson: Option<Correlation>,
    /// Two-sided, of the improvements of the groups.
    pub permutation_p: Option<f64>,
    /// What assistance takes away: half the shift between the groups' improvements.
    pub reduction: Option<Interval>,
    /// The shift in pooled standard deviations.
    pub hedges_g: Option<f64>,
}

impl AssistanceEffect {
    /// The assistance effect, tested as the definition says.
    pub fn assistance(&self) -> Option<FTest> {
        self.by_period.interaction
    }
}

/// The participants with one assisted and one unassisted trial that count and have this measure, in the order of their codes.
/// Of several trials of a participant in a period the last one counts: it was done again.
pub fn pairs(trials: &[Trial], measure: StudyMeasure) -> Vec<TrialPair> {
    let mut codes: Vec<&str> = trials.iter().map(|trial| trial.participant.as_str()).collect();
    codes.sort_unstable();
    codes.dedup();
    codes.into_iter().filter_map(|code| pair(code, trials, measure)).collect()
}

fn pair(code: &str, trials: &[Trial], measure: StudyMeasure) -> Option<TrialPair> {
    let of_period = |period: u32| {
        let is_it = |trial: &&Trial| trial.participant == code && trial.period == Some(period) && trial.counts();
        trials.iter().rfind(is_it)
    };
    let (first, second) = (of_period(1)?, of_period(2)?);
    if first.is_assisted() == second.is_assisted() {
        return None;
    }
    let values = [(measure.value)(first)?, (measure.value)(second)?];
    Some(TrialPair { participant: code.to_string(), assisted_second: second.is_assisted(), values })
}

/// The effect of assistance on a measure of these pairs; `seed` is that of sampled permutations.
pub fn effect(measure: StudyMeasure, pairs: &[TrialPair], seed: u64) -> AssistanceEffect {
    let group = |pair: &TrialPair| usize::from(pair.assisted_second);
    let improvements = |assisted_second: bool| -> Vec<f64> {
        pairs.iter().filter(|pair| pair.assisted_second == assisted_second).map(TrialPair::improvement).collect()
    };
    let (with, without) = (improvements(true), improvements(false));
    let codes: Vec<f64> = pairs.iter().map(|pair| group(pair) as f64).collect();
    let all: Vec<f64> = pairs.iter().map(TrialPair::improvement).collect();
    let half = |interval: Interval| Interval {
        estimate: interval.estimate / 2.0,
        low: interval.low / 2.0,
        high: interval.high / 2.0,
        ..interval
    };
    let mean = |values: &[f64]| super::trial::mean(values.iter().copied());
    AssistanceEffect {
        measure,
        groups: [with.len(), without.len()],
        improvements: [mean(&with), mean(&without)],
        by_period: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.values)).collect::<Vec<_>>()),
        by_condition: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.by_condition())).collect::<Vec<_>>()),
        pearson: pearson(&codes, &all),
        permutation_p: permutation_p(&with, &without, seed),
        reduction: hodges_lehmann(&with, &without, LEVEL).map(half),
        hedges_g: hedges_g(&with, &without),
    }
}
