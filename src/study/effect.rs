//! The effect of assistance in a cross-over of two trials: one assisted, one not, in either order.
//!
//! Trials differ in practice as well as in assistance: the second goes better anyway. So the two starting groups are compared
//! in what they improve from the first trial to the second: what is more of it in the group whose second trial is the assisted
//! one is the effect of assistance (the interaction of period and starting group).

use serde::Serialize;

use super::statistics::{
    Correlation, FTest, Interval, MixedAnova, hedges_g, hodges_lehmann, mixed_anova, pearson, permutation_p,
};
use super::trial::Trial;

/// The level of intervals.
pub const LEVEL: f64 = 0.95;

/// A participant with both trials.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    pub participant: String,
    /// The second trial was the assisted one.
    pub assisted_second: bool,
    /// Errors per press of the human in the first trial and in the second.
    pub rates: [f64; 2],
}

impl Pair {
    /// By how much fewer errors a press the second trial has.
    pub fn improvement(&self) -> f64 {
        self.rates[0] - self.rates[1]
    }

    /// The rates without assistance and with it.
    pub fn by_condition(&self) -> [f64; 2] {
        if self.assisted_second { self.rates } else { [self.rates[1], self.rates[0]] }
    }
}

/// What assistance changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// Participants whose first trial was unassisted, and whose second was.
    pub groups: [usize; 2],
    /// Mixed analysis of variance: period within, starting group between; assistance is the interaction.
    pub by_period: MixedAnova,
    /// The paper's coding: condition within, starting group between; assistance is the factor within.
    pub by_condition: MixedAnova,
    /// Of the starting group (1: assisted second) and the improvement; above 0, assistance helps.
    pub pearson: Option<Correlation>,
    /// Two-sided, of the improvements of the groups.
    pub permutation_p: Option<f64>,
    /// Errors per press of the human that assistance takes away: half the shift between the groups' improvements.
    pub fewer_errors: Option<Interval>,
    /// The shift in pooled standard deviations.
    pub hedges_g: Option<f64>,
}

impl Effect {
    /// The assistance effect, tested as the definition says.
    pub fn assistance(&self) -> Option<FTest> {
        self.by_period.interaction
    }
}

/// The participants with one assisted and one unassisted trial that count, in the order of their codes. Of several trials
/// of a participant in a period the last one counts: it was done again.
pub fn pairs(trials: &[Trial]) -> Vec<Pair> {
    let mut codes: Vec<&str> = trials.iter().map(|trial| trial.participant.as_str()).collect();
    codes.sort_unstable();
    codes.dedup();
    codes.into_iter().filter_map(|code| pair(code, trials)).collect()
}

fn pair(code: &str, trials: &[Trial]) -> Option<Pair> {
    let of_period = |period: u32| {
        let counts =
            |trial: &&Trial| trial.participant == code && trial.period == Some(period) && trial.excluded.is_none();
        trials.iter().rfind(counts)
    };
    let (first, second) = (of_period(1)?, of_period(2)?);
    if first.is_assisted() == second.is_assisted() {
        return None;
    }
    let rates = [first.error_rate()?, second.error_rate()?];
    Some(Pair { participant: code.to_string(), assisted_second: second.is_assisted(), rates })
}

/// The effect of assistance on the rate of errors; `seed` is that of sampled permutations.
pub fn effect(pairs: &[Pair], seed: u64) -> Effect {
    let group = |pair: &Pair| usize::from(pair.assisted_second);
    let improvements = |assisted_second: bool| -> Vec<f64> {
        pairs.iter().filter(|pair| pair.assisted_second == assisted_second).map(Pair::improvement).collect()
    };
    let (with, without) = (improvements(true), improvements(false));
    let codes: Vec<f64> = pairs.iter().map(|pair| group(pair) as f64).collect();
    let all: Vec<f64> = pairs.iter().map(Pair::improvement).collect();
    let half = |interval: Interval| Interval {
        estimate: interval.estimate / 2.0,
        low: interval.low / 2.0,
        high: interval.high / 2.0,
        ..interval
    };
    Effect {
        groups: [with.len(), without.len()],
        by_period: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.rates)).collect::<Vec<_>>()),
        by_condition: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.by_condition())).collect::<Vec<_>>()),
        pearson: pearson(&codes, &all),
        permutation_p: permutation_p(&with, &without, seed),
        fewer_errors: hodges_lehmann(&with, &without, LEVEL).map(half),
        hedges_g: hedges_g(&with, &without),
    }
}
