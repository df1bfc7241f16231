//! Comparison of any number of study arms by one primary outcome: the count of an event in a trial, as a rate per press
//! of the human.
//!
//! The primary model is a linear mixed model of log((count + 0.5) / presses), with the participant as random effect,
//! and arm and period as fixed effects ([`super::mixed_models`]). A mixed negative binomial model with log
//! presses as offset is reported beside it. A mixed Poisson model would assume that errors are independent, but errors
//! come in runs. Contrasts are ratios of rates; their p values are corrected together (Holm 1979). With three or more
//! arms, a model with the effect of the previous arm (carry-over) is a sensitivity analysis.
//!
//! Each trial counts in the arm to which the plan assigned it, as randomised. A trial that was carried out otherwise is
//! a deviation; the same comparison by the arms as carried out stands beside.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::effect::{AssistanceEffect, LEVEL, LeftOutParticipant, StudyMeasure, effect, pairs};
use crate::mixed_models::{
    CountObservation, LinearMixedModel, MixedModelContrast, MixedModelMeasurement, NegativeBinomialModel, WaldContrast,
};
use crate::statistics::mean;
use crate::tables::trials::{MEASURES, PROBES_WRONG};
use crate::trial_statistics::{TrialStatistics, TrialTotals};
use tomcom_session::plan::{PrimaryOutcome, StudyAims};
use tomcom_session::settings::{Condition, WizardVisibility};
use tomcom_session::study_arm::StudyArm;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyArmComparison {
    pub outcome: PrimaryOutcome,
    pub participants: usize,
    pub trials: usize,
    pub left_out: Vec<LeftOutParticipant>,
    pub arms: Vec<StudyArmCounts>,
    /// Standard deviations of log rates: between participants, and residual (within participants).
    pub standard_deviations: [f64; 2],
    /// Contrasts of the primary model: arms against the arm without signals and against the wizard.
    pub contrasts: Vec<StudyArmContrast>,
    /// Of the model with the previous arm (carry-over); empty with two arms, or where it cannot be estimated.
    pub with_carry_over: Vec<StudyArmContrast>,
    /// Comparison by the mixed negative binomial model; null where the model cannot be estimated.
    pub negative_binomial: Option<NegativeBinomialComparison>,
    pub non_inferiority: Vec<NonInferiority>,
    pub groups: Vec<GroupOrder>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyArmCounts {
    pub arm: StudyArm,
    pub trials: usize,
    pub events: u64,
    pub presses: u64,
}

impl StudyArmCounts {
    fn per_trial(&self) -> f64 {
        self.events as f64 / self.trials as f64
    }

    /// Events of the primary outcome per 100 presses of the human, over all trials of the arm together.
    pub fn per_100(&self) -> f64 {
        100.0 * self.events as f64 / self.presses as f64
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyArmContrast {
    pub arm: StudyArm,
    pub against: StudyArm,
    pub ratio: f64,
    /// Of the interval: that at which Holm's procedure tests the contrast, 0.95 for a single one. So the interval is without
    /// 1 exactly where the corrected p value is below 0.05.
    pub level: f64,
    /// Confidence interval of the ratio of rates.
    pub interval: [f64; 2],
    pub p_holm: f64,
    /// Why the ratio is not reliable; absent where nothing speaks against it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<ContrastDoubt>,
    #[serde(flatten)]
    pub contrast: MixedModelContrast,
}

/// Mean number of events in a trial below which the primary model is not relied on. Bolker et al. 2009 (Trends in Ecology and
/// Evolution 24, 127-135) give the bound for penalised quasi-likelihood, which also takes counts as about normal: it is biased
/// where fewer than five are expected in a treatment. Logarithms of counts are biased there, too (O'Hara and Kotze 2010, Methods
/// in Ecology and Evolution 1, 118-122).
pub const FEW_EVENTS: f64 = 5.0;

/// What speaks against the ratio of the primary model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ContrastDoubt {
    /// Mean number of events in a trial of the arm with the fewest; null from [`FEW_EVENTS`] on.
    pub few_events: Option<f64>,
    /// The ratio by the negative binomial model, where it lies outside the interval.
    pub other_ratio: Option<f64>,
}

/// What a contrast says about the rates of two arms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContrastVerdict {
    /// The corrected p value is below 0.05.
    Shown,
    /// Only the p value of this contrast alone is.
    Uncertain,
    NoDifference,
}

impl StudyArmContrast {
    pub fn verdict(&self) -> ContrastVerdict {
        match (self.p_holm < 1.0 - LEVEL, self.contrast.p < 1.0 - LEVEL) {
            (true, _) => ContrastVerdict::Shown,
            (false, true) => ContrastVerdict::Uncertain,
            (false, false) => ContrastVerdict::NoDifference,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NegativeBinomialComparison {
    pub between_sd: f64,
    /// The variance of a count is mu + mu^2 / size; null where counts vary as under a Poisson distribution.
    pub size: Option<f64>,
    pub contrasts: Vec<NegativeBinomialContrast>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NegativeBinomialContrast {
    pub arm: StudyArm,
    pub against: StudyArm,
    pub ratio: f64,
    pub p_holm: f64,
    #[serde(flatten)]
    pub contrast: WaldContrast,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NonInferiority {
    pub arm: StudyArm,
    pub against: StudyArm,
    pub margin: f64,
    pub ratio: f64,
    /// Upper end of the one-sided 97.5 % confidence interval of the ratio of rates.
    pub upper: f64,
    /// One-sided p value of the hypothesis that the ratio is at or above the margin.
    pub p: f64,
    pub holds: bool,
}

pub(crate) fn events(outcome: PrimaryOutcome, trial: &TrialStatistics) -> Option<u64> {
    match outcome {
        PrimaryOutcome::Errors => Some(trial.errors),
        PrimaryOutcome::BeliefRelatedErrors => trial.beliefs.as_ref().map(|beliefs| beliefs.errors),
        PrimaryOutcome::Sequences => trial.beliefs.as_ref().map(|beliefs| beliefs.lengths.len() as u64),
    }
}

/// Why the comparison cannot use a trial, in words; otherwise the trial's period and number of events.
fn usable(trial: &TrialStatistics, outcome: PrimaryOutcome) -> Result<(u32, u64), String> {
    if let Some(reason) = &trial.left_out {
        return Err(format!("does not count ({reason})"));
    }
    if trial.human_presses == 0 {
        return Err("no press of the participant".to_string());
    }
    let period = trial.period.ok_or_else(|| "no number in the participant's series".to_string())?;
    let events = events(outcome, trial).ok_or_else(|| format!("{} not known", outcome.title()))?;
    Ok((period, events))
}

/// The usable trials, and the participants without one. Of a repeated period, the last trial counts.
fn counted(trials: &[TrialStatistics], outcome: PrimaryOutcome) -> (Vec<StudyArmTrial>, Vec<LeftOutParticipant>) {
    let (mut rows, mut left_out): (Vec<StudyArmTrial>, _) = (Vec::new(), Vec::new());
    for own in trials.chunk_by(|a, b| a.participant == b.participant) {
        let participant = rows.last().map_or(0, |last| last.participant + 1);
        let (mut own_rows, mut reasons): (Vec<StudyArmTrial>, Vec<String>) = (Vec::new(), Vec::new());
        for trial in own {
            match usable(trial, outcome) {
                Ok((period, events)) => {
                    own_rows.pop_if(|row| row.period == period);
                    let (arm, presses) = (trial.planned_arm, trial.human_presses);
                    own_rows.push(StudyArmTrial { participant, period, arm, events, presses });
                }
                Err(reason) => reasons.push(format!("{}: {reason}", trial.recording)),
            }
        }
        if own_rows.is_empty() {
            left_out.push(LeftOutParticipant { participant: own[0].participant.clone(), reason: reasons.join("; ") });
        }
        rows.extend(own_rows);
    }
    (rows, left_out)
}

/// Contrasts of the design's pairs of arms, each with its corrected p value. `contrast`: that of a pair; `p`: its p value.
fn corrected<Contrast>(
    design: &ArmComparisonDesign,
    contrast: impl Fn((StudyArm, StudyArm)) -> Option<Contrast>,
    p: fn(&Contrast) -> f64,
) -> Vec<((StudyArm, StudyArm), Contrast, f64)> {
    let pairs = arm_pairs(&design.arms).into_iter();
    let all: Vec<_> = pairs.filter_map(|pair| Some((pair, contrast(pair)?))).collect();
    let p_holm = holm(&all.iter().map(|(_, one)| p(one)).collect::<Vec<_>>());
    all.into_iter().zip(p_holm).map(|((pair, one), p_holm)| (pair, one, p_holm)).collect()
}

fn contrasts(design: &ArmComparisonDesign, model: &LinearMixedModel) -> Vec<StudyArmContrast> {
    let contrast = |pair| model.contrast(&design.weights(pair, model.estimates.len()));
    let all = corrected(design, contrast, |one: &MixedModelContrast| one.p);
    let number = all.len();
    let with_interval = |((arm, against), contrast, p_holm): ((StudyArm, StudyArm), MixedModelContrast, f64)| {
        let times = if contrast.p > 0.0 { p_holm / contrast.p } else { number as f64 };
        let level = 1.0 - (1.0 - LEVEL) / times;
        let (ratio, interval) = (contrast.estimate.exp(), contrast.interval(level).map(f64::exp));
        StudyArmContrast { arm, against, ratio, level, interval, p_holm, doubt: None, contrast }
    };
    all.into_iter().map(with_interval).collect()
}

fn count_comparison(design: &ArmComparisonDesign) -> Option<NegativeBinomialComparison> {
    let model = design.counts()?;
    let contrast = |pair| model.contrast(&design.weights(pair, model.estimates.len()));
    let all = corrected(design, contrast, |one: &WaldContrast| one.p).into_iter();
    let contrasts = all.map(|((arm, against), contrast, p_holm)| {
        let ratio = contrast.estimate.exp();
        NegativeBinomialContrast { arm, against, ratio, p_holm, contrast }
    });
    let size = Some(model.size).filter(|size| size.is_finite());
    Some(NegativeBinomialComparison { between_sd: model.between_sd, size, contrasts: contrasts.collect() })
}

/// Holm's correction of p values for multiple tests: each p value is multiplied by the number of p values that are not
/// smaller, and made no smaller than the corrected p value before it.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|a, b| p[*a].total_cmp(&p[*b]));
    let (mut corrected, mut least) = (vec![0.0; p.len()], 0.0_f64);
    for (rank, &index) in order.iter().enumerate() {
        least = least.max((p[index] * (p.len() - rank) as f64).min(1.0));
        corrected[index] = least;
    }
    corrected
}

fn doubt(
    one: &StudyArmContrast,
    arms: &[StudyArmCounts],
    counts: Option<&NegativeBinomialComparison>,
) -> Option<ContrastDoubt> {
    let own = arms.iter().filter(|counts| [one.arm, one.against].contains(&counts.arm));
    let fewest = own.map(StudyArmCounts::per_trial).fold(f64::INFINITY, f64::min);
    let few_events = Some(fewest).filter(|fewest| *fewest < FEW_EVENTS);
    let other = counts.and_then(|counts| counts.of(one)).map(|other| other.ratio);
    let [low, high] = one.interval;
    let other_ratio = other.filter(|ratio| *ratio < low || *ratio > high);
    (few_events.is_some() || other_ratio.is_some()).then_some(ContrastDoubt { few_events, other_ratio })
}

impl StudyArmComparison {
    /// As [`StudyArmCounts::per_100`]; NaN of an arm without trials.
    pub fn per_100(&self, arm: StudyArm) -> f64 {
        self.arms.iter().find(|counts| counts.arm == arm).map_or(f64::NAN, StudyArmCounts::per_100)
    }
}

impl NegativeBinomialComparison {
    /// The same contrast by this model.
    pub fn of(&self, contrast: &StudyArmContrast) -> Option<&NegativeBinomialContrast> {
        self.contrasts.iter().find(|other| (other.arm, other.against) == (contrast.arm, contrast.against))
    }
}

/// `trials`: ordered by participant and period; empty where the model cannot be estimated.
pub(crate) fn primary_contrasts(trials: Vec<StudyArmTrial>) -> Vec<StudyArmContrast> {
    let design = ArmComparisonDesign::new(trials);
    let model = if design.is_within() { design.linear(false) } else { None };
    model.map_or_else(Vec::new, |model| contrasts(&design, &model))
}

/// Compares the arms of the trials that the analysis includes; `trials` must be ordered by participant and period.
/// `None` unless participants have trials in different arms, or where the model cannot be estimated. The plan sets outcome
/// and margin.
pub fn compare_arms(trials: &[TrialStatistics]) -> Option<StudyArmComparison> {
    let aims = trials.iter().filter(|trial| trial.counts()).find_map(|trial| trial.aims).unwrap_or_default();
    let (rows, left_out) = counted(trials, aims.outcome);
    let compared = compare_counts(rows, aims)?;
    Some(StudyArmComparison { groups: group_orders(trials), left_out, ..compared })
}

/// By counts of the outcome that `aims` sets; without starting groups, and leaves nobody out.
pub(crate) fn compare_counts(trials: Vec<StudyArmTrial>, aims: StudyAims) -> Option<StudyArmComparison> {
    let design = ArmComparisonDesign::new(trials);
    if !design.is_within() {
        return None;
    }
    let model = design.linear(false)?;
    let mut found = contrasts(&design, &model);
    let with_carry_over = match design.arms.len() {
        0..=2 => Vec::new(),
        _ => design.linear(true).map_or_else(Vec::new, |model| contrasts(&design, &model)),
    };
    let is_assistants = |arm: StudyArm| arm.condition() == Condition::Assistant;
    let against_wizard = found.iter().filter(|one| one.against == StudyArm::Wizard && is_assistants(one.arm));
    let non_inferiority = against_wizard.map(|one| {
        let upper = one.contrast.interval(LEVEL)[1].exp();
        NonInferiority {
            arm: one.arm,
            against: one.against,
            margin: aims.margin,
            ratio: one.ratio,
            upper,
            p: one.contrast.p_below(aims.margin.ln()),
            holds: upper < aims.margin,
        }
    });
    let non_inferiority: Vec<NonInferiority> = non_inferiority.collect();
    let outcome_of = |arm: StudyArm| {
        let own = || design.trials.iter().filter(|trial| trial.arm == arm);
        StudyArmCounts {
            arm,
            trials: own().count(),
            events: own().map(|trial| trial.events).sum(),
            presses: own().map(|trial| trial.presses).sum(),
        }
    };
    let arms: Vec<StudyArmCounts> = design.arms.iter().copied().map(outcome_of).collect();
    let negative_binomial = count_comparison(&design);
    found.iter_mut().for_each(|one| one.doubt = doubt(one, &arms, negative_binomial.as_ref()));
    Some(StudyArmComparison {
        outcome: aims.outcome,
        participants: design.trials.last().map_or(0, |trial| trial.participant + 1),
        trials: design.trials.len(),
        left_out: Vec::new(),
        arms,
        standard_deviations: [model.between.sqrt(), model.within.sqrt()],
        non_inferiority,
        contrasts: found,
        with_carry_over,
        negative_binomial,
        groups: Vec::new(),
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StudyArmTrial {
    pub participant: usize,
    /// Number of the trial in the participant's series, from 1.
    pub period: u32,
    pub arm: StudyArm,
    pub events: u64,
    /// Number of the human's presses in the trial; above 0.
    pub presses: u64,
}

impl StudyArmTrial {
    /// Dependent variable of the primary model: log((events + 0.5) / presses).
    fn log_rate(&self) -> f64 {
        ((self.events as f64 + 0.5) / self.presses as f64).ln()
    }
}

struct ArmComparisonDesign {
    trials: Vec<StudyArmTrial>,
    arms: Vec<StudyArm>,
    periods: BTreeSet<u32>,
}

/// Every arm with the one without signals, every other one with the wizard's; else all with the first.
pub(crate) fn arm_pairs(arms: &[StudyArm]) -> Vec<(StudyArm, StudyArm)> {
    let mut pairs = Vec::new();
    for against in [StudyArm::None, StudyArm::Wizard] {
        let others = arms.iter().copied().filter(|arm| *arm != against && *arm != StudyArm::None);
        pairs.extend(others.filter(|_| arms.contains(&against)).map(|arm| (arm, against)));
    }
    if pairs.is_empty() {
        pairs.extend(arms.iter().skip(1).map(|arm| (*arm, arms[0])));
    }
    pairs
}

impl ArmComparisonDesign {
    /// The design for these trials, which must be ordered by participant and period.
    fn new(trials: Vec<StudyArmTrial>) -> ArmComparisonDesign {
        let has = |arm: &StudyArm| trials.iter().any(|trial| trial.arm == *arm);
        let arms = StudyArm::ALL.into_iter().filter(has).collect();
        let periods: BTreeSet<u32> = trials.iter().map(|trial| trial.period).collect();
        ArmComparisonDesign { trials, arms, periods }
    }

    fn is_within(&self) -> bool {
        self.arms.len() > 1 && self.trials.windows(2).any(|pair| pair[0].participant == pair[1].participant)
    }

    fn before(&self, index: usize) -> Option<StudyArm> {
        let before = self.trials.get(index.checked_sub(1)?)?;
        (before.participant == self.trials[index].participant).then_some(before.arm)
    }

    /// Intercept, arms without the first, periods without the first; with `carry_over` previous arms likewise.
    fn effects(&self, index: usize, carry_over: bool) -> Vec<f64> {
        let (trial, before) = (&self.trials[index], self.before(index));
        let is = |holds: bool| f64::from(u8::from(holds));
        let arms = self.arms.iter().skip(1).map(|arm| is(trial.arm == *arm));
        let periods = self.periods.iter().skip(1).map(|period| is(trial.period == *period));
        let carried = self.arms.iter().skip(1).filter(|_| carry_over).map(|arm| is(before == Some(*arm)));
        std::iter::once(1.0).chain(arms).chain(periods).chain(carried).collect()
    }

    /// The primary model, with `carry_over` including the previous arm; `None` where it cannot be estimated.
    fn linear(&self, carry_over: bool) -> Option<LinearMixedModel> {
        let measurement = |(index, trial): (usize, &StudyArmTrial)| MixedModelMeasurement {
            participant: trial.participant,
            effects: self.effects(index, carry_over),
            value: trial.log_rate(),
        };
        LinearMixedModel::fit(&self.trials.iter().enumerate().map(measurement).collect::<Vec<_>>())
    }

    /// The negative binomial model of counts; `None` where the model cannot be estimated.
    fn counts(&self) -> Option<NegativeBinomialModel> {
        let count = |(index, trial): (usize, &StudyArmTrial)| CountObservation {
            participant: trial.participant,
            effects: self.effects(index, false),
            count: trial.events,
            exposure: trial.presses as f64,
        };
        NegativeBinomialModel::fit(&self.trials.iter().enumerate().map(count).collect::<Vec<_>>())
    }

    /// Weights of the fixed effects for the difference between two arms, in a model with `size` effects.
    fn weights(&self, (arm, against): (StudyArm, StudyArm), size: usize) -> Vec<f64> {
        let mut weights = vec![0.0; size];
        for (place, other) in self.arms.iter().enumerate().skip(1) {
            weights[place] = f64::from(i8::from(*other == arm) - i8::from(*other == against));
        }
        weights
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GroupOrder {
    /// Name of the starting group, with a letter for each trial: "BAC".
    pub group: String,
    /// Planned condition of each trial of the group; `None` for a missing trial.
    pub order: Vec<Option<StudyArm>>,
    pub participants: usize,
}

fn group_orders(trials: &[TrialStatistics]) -> Vec<GroupOrder> {
    let mut groups: BTreeMap<&str, (BTreeMap<u32, StudyArm>, BTreeSet<&str>)> = BTreeMap::new();
    for trial in trials.iter().filter(|trial| trial.counts()) {
        let (Some(group), Some(period)) = (&trial.group, trial.period) else { continue };
        let (order, participants) = groups.entry(group).or_default();
        order.insert(period, trial.planned_arm);
        participants.insert(&trial.participant);
    }
    let one = |(group, (order, participants)): (&str, (BTreeMap<u32, StudyArm>, BTreeSet<&str>))| GroupOrder {
        group: group.to_string(),
        order: (1..=group.chars().count() as u32).map(|period| order.get(&period).copied()).collect(),
        participants: participants.len(),
    };
    groups.into_iter().map(one).collect()
}

impl GroupOrder {
    /// The starting group as text: "BAC: wizard, unassisted, ToM-Com (2)".
    pub fn describe(&self) -> String {
        let order: Vec<&str> = self.order.iter().map(|arm| arm.map_or("?", StudyArm::title)).collect();
        format!("{}: {} ({})", self.group, order.join(", "), self.participants)
    }
}

/// A trial that was carried out in another arm than the one to which the plan assigned it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArmDeviation {
    pub recording: String,
    pub participant: String,
    pub planned: StudyArm,
    pub carried_out: StudyArm,
    pub unblinded: bool,
}

impl ArmDeviation {
    /// The deviation of a trial; `None` if the trial was carried out as planned.
    pub fn from_trial(trial: &TrialStatistics) -> Option<ArmDeviation> {
        let (planned, carried_out) = (trial.planned_arm, trial.study_arm);
        (planned != carried_out).then(|| ArmDeviation {
            recording: trial.recording.clone(),
            participant: trial.participant.clone(),
            planned,
            carried_out,
            unblinded: carried_out == StudyArm::WizardWithAdvice
                && trial.wizard_sees != WizardVisibility::Recommendation,
        })
    }

    pub fn describe(&self) -> String {
        let why = if self.unblinded { ", since the wizard was shown what the assistants would send" } else { "" };
        format!("{}: planned {}, carried out {}{why}", self.recording, self.planned.title(), self.carried_out.title())
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmAnalysis {
    pub conditions: Vec<StudyConditionSummary>,
    pub effects: Vec<AssistanceEffect>,
    /// By the plan's primary outcome; null unless participants have trials in different arms.
    pub arms: Option<StudyArmComparison>,
}

impl ArmAnalysis {
    /// By planned arms; `trials` must be ordered by participant and period. `seed`: of the permutations.
    pub fn from_trials(trials: &[TrialStatistics], seed: u64) -> ArmAnalysis {
        let effects = compared(trials).map(|measure| effect(measure, pairs(trials, measure), seed)).collect();
        ArmAnalysis { conditions: conditions(trials), effects, arms: compare_arms(trials) }
    }

    pub fn as_carried_out(trials: &[TrialStatistics], seed: u64) -> ArmAnalysis {
        let moved = trials.iter().map(|trial| TrialStatistics { planned_arm: trial.study_arm, ..trial.clone() });
        ArmAnalysis::from_trials(&moved.collect::<Vec<_>>(), seed)
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyConditionSummary {
    pub condition: StudyArm,
    pub trials: u64,
    #[serde(flatten)]
    pub totals: TrialTotals,
    pub mean_errors: Option<f64>,
    pub mean_order_s: Option<f64>,
    /// Mean over trials of the summed regret of both agents per served order.
    pub mean_additional_presses_per_order: Option<f64>,
    pub mean_press_s: Option<f64>,
    /// Number of error sequences by their length: sequences with 1, 2, 3, … errors.
    pub sequence_lengths: Vec<u64>,
}

/// The measures that are compared in these trials; those of freeze probes only if there are probes.
fn compared(trials: &[TrialStatistics]) -> impl Iterator<Item = StudyMeasure> {
    let has_probes = trials.iter().any(|trial| trial.probes.is_some());
    MEASURES.into_iter().filter(move |measure| *measure != PROBES_WRONG || has_probes)
}

fn conditions(trials: &[TrialStatistics]) -> Vec<StudyConditionSummary> {
    let of = |condition: StudyArm| {
        let is_own = |trial: &&TrialStatistics| trial.counts() && trial.planned_arm == condition;
        let trials: Vec<&TrialStatistics> = trials.iter().filter(is_own).collect();
        let lengths = || trials.iter().filter_map(|trial| trial.beliefs.as_ref()).flat_map(|one| one.lengths.iter());
        let mut sequence_lengths = vec![0; lengths().copied().max().unwrap_or(0) as usize];
        lengths().for_each(|&length| sequence_lengths[length as usize - 1] += 1);
        (!trials.is_empty()).then(|| StudyConditionSummary {
            condition,
            trials: trials.len() as u64,
            totals: TrialTotals::from_trials(&trials),
            mean_errors: mean(trials.iter().map(|trial| trial.errors as f64)),
            mean_order_s: mean(trials.iter().filter_map(|trial| trial.order_s)),
            mean_additional_presses_per_order: mean(trials.iter().filter_map(|one| one.additional_presses_per_order)),
            mean_press_s: mean(trials.iter().filter_map(|trial| trial.press_s)),
            sequence_lengths,
        })
    };
    StudyArm::ALL.into_iter().filter_map(of).collect()
}
