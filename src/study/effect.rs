//! Effect of assistance in a cross-over design: each participant has one assisted and one unassisted trial, in either
//! order.
//!
//! The second trial also profits from practice. The analysis therefore compares the improvement from the first to the
//! second trial between the two starting groups. The additional improvement of the group whose second trial is assisted
//! is the effect of assistance (the interaction of period and starting group; Senn 2002, Cross-over Trials, chapter 3).

use std::collections::BTreeSet;

use serde::{Serialize, Serializer};

use super::trial_statistics::TrialStatistics;
use crate::grouping::grouped;
use crate::statistics::{
    ConfidenceInterval, Correlation, FTest, MixedAnova, hedges_g, hodges_lehmann, mixed_anova, pearson, permutation_p,
};
use tomcom_session::study_arm::StudyArm;

pub(crate) const LEVEL: f64 = 0.95;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrialPair {
    pub participant: String,
    pub assisted_second: bool,
    /// Values of the measure in the participant's first and second trial; lower is better.
    pub values: [f64; 2],
}

impl TrialPair {
    pub(crate) fn improvement(&self) -> f64 {
        self.values[0] - self.values[1]
    }

    pub fn by_condition(&self) -> [f64; 2] {
        if self.assisted_second { self.values } else { [self.values[1], self.values[0]] }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LeftOutParticipant {
    pub participant: String,
    /// Why the test cannot use the participant, in words.
    pub reason: String,
}

/// "P03, P07 (no trial 2)": participants of the same reason together; `None` if nobody is left out.
pub fn left_out_in_words(left_out: &[LeftOutParticipant]) -> Option<String> {
    let reasons = grouped(left_out.iter().map(|one| (one.reason.as_str(), one.participant.as_str())));
    let words: Vec<String> = reasons.iter().map(|(reason, codes)| format!("{} ({reason})", codes.join(", "))).collect();
    (!words.is_empty()).then(|| words.join("; "))
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairedTrials {
    pub pairs: Vec<TrialPair>,
    pub left_out: Vec<LeftOutParticipant>,
}

/// A statistic of a trial that is compared between assisted and unassisted trials; lower is better. The measure is a
/// column of the table of trials, two columns of the table of participants, and a line of the report's tests.
#[derive(Clone, Copy, Debug)]
pub struct StudyMeasure {
    /// Column in the table of trials, and key in the summary; the table of participants adds `_1` and `_2`.
    pub name: &'static str,
    pub unit: &'static str,
    /// Definition of the measure for the data dictionary; empty if the unit says enough.
    pub meaning: &'static str,
    /// Why a trial has no such value; empty if each has one.
    pub unknown: &'static str,
    /// Meaning of the columns `_1` and `_2` in the table of participants; `{}` stands for "first" or "second".
    pub meaning_in: &'static str,
    pub title: &'static str,
    pub digits: usize,
    /// Value of the measure for a trial; `None` if the trial has no such value.
    pub value: fn(&TrialStatistics) -> Option<f64>,
}

impl StudyMeasure {
    /// Its meaning in the table of trials.
    pub fn meaning_of_trial(&self) -> String {
        let unknown = if self.unknown.is_empty() { String::new() } else { format!("empty: {}", self.unknown) };
        [self.meaning, &unknown].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
    }

    /// Its meaning in the table of participants, for a trial such as the "first".
    pub fn meaning_of_nth(&self, nth: &str) -> String {
        let unknown = if self.unknown.is_empty() { String::new() } else { format!(", or {}", self.unknown) };
        format!("{}; empty: no such trial counts{unknown}", self.meaning_in.replace("{}", nth))
    }
}

/// Two measures are equal if their names are; names are unique, since they are columns of one table.
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

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssistanceEffect {
    pub measure: StudyMeasure,
    pub groups: [usize; 2],
    /// Participants with recordings whom the tests leave out; empty where nothing is tested, since there are no pairs.
    pub left_out: Vec<LeftOutParticipant>,
    pub improvements: [Option<f64>; 2],
    /// Mixed analysis of variance with period within and starting group between; assistance is the interaction.
    pub by_period: MixedAnova,
    /// In the paper's coding: condition within; assistance is the factor within.
    pub by_condition: MixedAnova,
    /// Correlation of starting group (1: assisted second) and improvement; positive if assistance helps.
    pub pearson: Option<Correlation>,
    pub permutation_p: Option<f64>,
    /// Reduction of the measure by assistance: half the Hodges-Lehmann shift between the groups' improvements.
    pub reduction: Option<ConfidenceInterval>,
    /// Hedges' g: the difference of the groups' mean improvements in pooled standard deviations.
    pub hedges_g: Option<f64>,
}

impl AssistanceEffect {
    /// F test of the assistance effect as the report defines it: the interaction of period and starting group.
    pub fn assistance(&self) -> Option<FTest> {
        self.by_period.interaction
    }

    pub fn has_pairs(&self) -> bool {
        self.groups != [0, 0]
    }
}

/// Pairs of one assisted and one unassisted trial that the analysis includes and that have this measure. If a participant
/// repeated a period, its last trial counts. Empty where the trials were planned in more than two arms, which are compared
/// together instead ([`super::arm_comparison`]).
pub fn pairs(trials: &[TrialStatistics], measure: StudyMeasure) -> PairedTrials {
    let counted = trials.iter().filter(|trial| trial.counts());
    let arms: BTreeSet<StudyArm> = counted.map(|trial| trial.planned_arm).collect();
    let mut paired = PairedTrials::default();
    if arms.len() > 2 {
        return paired;
    }
    let codes: BTreeSet<&str> = trials.iter().map(|trial| trial.participant.as_str()).collect();
    for code in codes {
        match pair(code, trials, measure) {
            Ok(pair) => paired.pairs.push(pair),
            Err(reason) => paired.left_out.push(LeftOutParticipant { participant: code.to_string(), reason }),
        }
    }
    paired
}

fn pair(code: &str, trials: &[TrialStatistics], measure: StudyMeasure) -> Result<TrialPair, String> {
    let own: Vec<&TrialStatistics> = trials.iter().filter(|trial| trial.participant == code).collect();
    let of_period = |period: u32| {
        let all = || own.iter().filter(move |trial| trial.period == Some(period));
        let counted = all().rfind(|trial| trial.counts());
        let why = || match all().next_back().and_then(|trial| trial.left_out.as_ref()) {
            Some(reason) => format!("trial {period} does not count ({reason})"),
            None => format!("no trial {period}"),
        };
        counted.copied().ok_or_else(why)
    };
    let (first, second) = (of_period(1)?, of_period(2)?);
    if first.is_assisted() == second.is_assisted() {
        let both = if first.is_assisted() { "assisted" } else { "unassisted" };
        return Err(format!("both trials {both}"));
    }
    let value = |period: u32, trial: &TrialStatistics| {
        (measure.value)(trial).ok_or_else(|| format!("trial {period} has no {}", measure.title))
    };
    let values = [value(1, first)?, value(2, second)?];
    Ok(TrialPair { participant: code.to_string(), assisted_second: second.is_assisted(), values })
}

pub fn effect(measure: StudyMeasure, paired: PairedTrials, seed: u64) -> AssistanceEffect {
    let PairedTrials { pairs, left_out } = paired;
    let group = |pair: &TrialPair| usize::from(pair.assisted_second);
    let improvements = |assisted_second: bool| -> Vec<f64> {
        pairs.iter().filter(|pair| pair.assisted_second == assisted_second).map(TrialPair::improvement).collect()
    };
    let (with, without) = (improvements(true), improvements(false));
    let codes: Vec<f64> = pairs.iter().map(|pair| group(pair) as f64).collect();
    let all: Vec<f64> = pairs.iter().map(TrialPair::improvement).collect();
    let half = |interval: ConfidenceInterval| ConfidenceInterval {
        estimate: interval.estimate / 2.0,
        low: interval.low / 2.0,
        high: interval.high / 2.0,
        ..interval
    };
    let mean = |values: &[f64]| crate::statistics::mean(values.iter().copied());
    AssistanceEffect {
        measure,
        groups: [with.len(), without.len()],
        left_out: if pairs.is_empty() { Vec::new() } else { left_out },
        improvements: [mean(&with), mean(&without)],
        by_period: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.values)).collect::<Vec<_>>()),
        by_condition: mixed_anova(&pairs.iter().map(|pair| (group(pair), pair.by_condition())).collect::<Vec<_>>()),
        pearson: pearson(&codes, &all),
        permutation_p: permutation_p(&with, &without, seed),
        reduction: hodges_lehmann(&with, &without, LEVEL).map(half),
        hedges_g: hedges_g(&with, &without),
    }
}
