//! Comparison of any number of arms by one primary outcome: a count of a trial, as a rate per press of the human.
//!
//! The primary model is a linear mixed model of log((count + 0.5) / presses), with the participant as random, arm and period as fixed effects
//! ([`super::linear_mixed_model`]); a mixed negative binomial model with log presses as offset stands beside it. A mixed Poisson model would
//! take errors for independent events, which they are not: they come in runs. Contrasts are ratios of rates; their p values are corrected
//! together (Holm 1979). From three arms on, a model with the effect of the arm before (carry-over) is a sensitivity analysis.

use serde::Serialize;

use super::effect::LEVEL;
use super::group_orders::{GroupOrder, group_orders};
use super::linear_mixed_model::{Contrast, LinearMixedModel, Measurement};
use super::negative_binomial_model::{NegativeBinomialModel, TrialCount, WaldContrast};
use super::trial_statistics::Trial;
use crate::session::plan::PrimaryOutcome;
use crate::session::study_arm::StudyArm;

/// Comparison of the arms of a study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmComparison {
    /// What is counted.
    pub outcome: PrimaryOutcome,
    /// Number of participants in it.
    pub participants: usize,
    /// Number of their trials.
    pub trials: usize,
    /// The arms, in the order of tables.
    pub arms: Vec<ArmOutcome>,
    /// Standard deviation between participants, and of what is left, of the logarithms of rates.
    pub standard_deviations: [f64; 2],
    /// Contrasts against the arm without signals and against the wizard, of the primary model.
    pub contrasts: Vec<ArmContrast>,
    /// The same with the effect of the arm before; empty below three arms, or where it cannot be estimated.
    pub with_carry_over: Vec<ArmContrast>,
    /// The mixed negative binomial model; null where it cannot be estimated.
    pub negative_binomial: Option<CountComparison>,
    /// Whether arms of the assistant are not worse than the wizard.
    pub non_inferiority: Vec<NonInferiority>,
    /// The starting groups with their orders of conditions.
    pub groups: Vec<GroupOrder>,
}

/// The trials of an arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ArmOutcome {
    /// The arm.
    pub arm: StudyArm,
    /// Number of trials.
    pub trials: usize,
    /// Counted events.
    pub events: u64,
    /// Presses of the human.
    pub presses: u64,
}

impl ArmOutcome {
    /// Events per 100 presses of the human, all trials pooled.
    pub fn per_100(&self) -> f64 {
        100.0 * self.events as f64 / self.presses as f64
    }
}

/// One arm against another one in the primary model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ArmContrast {
    /// The arm.
    pub arm: StudyArm,
    /// The arm that it is compared with.
    pub against: StudyArm,
    /// Ratio of their rates.
    pub ratio: f64,
    /// Its interval of 95 %.
    pub interval: [f64; 2],
    /// p after Holm's correction over all contrasts.
    pub p_holm: f64,
    /// The contrast of logarithms.
    #[serde(flatten)]
    pub contrast: Contrast,
}

/// The mixed negative binomial model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CountComparison {
    /// Standard deviation between participants, of the logarithms of rates.
    pub between_sd: f64,
    /// Size: the variance of a count is mu + mu^2 / size; null where counts vary no more than Poisson's.
    pub size: Option<f64>,
    /// The same contrasts.
    pub contrasts: Vec<CountContrast>,
}

/// One arm against another one in the negative binomial model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CountContrast {
    /// The arm.
    pub arm: StudyArm,
    /// The arm that it is compared with.
    pub against: StudyArm,
    /// Ratio of their rates.
    pub ratio: f64,
    /// p after Holm's correction over all contrasts.
    pub p_holm: f64,
    /// The contrast of logarithms.
    #[serde(flatten)]
    pub contrast: WaldContrast,
}

/// Whether an arm of the assistant is not worse than the wizard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NonInferiority {
    /// The assistant's arm.
    pub arm: StudyArm,
    /// The wizard's arm.
    pub against: StudyArm,
    /// The ratio of rates that would be too much.
    pub margin: f64,
    /// Ratio of their rates.
    pub ratio: f64,
    /// Upper end of the one-sided interval of 97.5 %.
    pub upper: f64,
    /// One-sided p that the ratio is below the margin.
    pub p: f64,
    /// Whether the upper end is below the margin.
    pub holds: bool,
}

/// The design of a comparison: one row of effects per trial.
struct Design<'a> {
    outcome: PrimaryOutcome,
    /// Trials with the index of their participant and the arm of the trial before.
    rows: Vec<(usize, &'a Trial, Option<StudyArm>)>,
    arms: Vec<StudyArm>,
    periods: Vec<u32>,
}

/// Number of the outcome's events in a trial; `None` if it is not known there.
fn events(outcome: PrimaryOutcome, trial: &Trial) -> Option<u64> {
    match outcome {
        PrimaryOutcome::Errors => Some(trial.errors),
        PrimaryOutcome::BeliefRelatedErrors => trial.beliefs.as_ref().map(|beliefs| beliefs.errors),
        PrimaryOutcome::Sequences => trial.beliefs.as_ref().map(|beliefs| beliefs.lengths.len() as u64),
    }
}

impl<'a> Design<'a> {
    /// The counting trials, ordered by participant and period, that have a period and the outcome. A repeated period counts once, by its
    /// last trial.
    fn new(trials: &[&'a Trial], outcome: PrimaryOutcome) -> Design<'a> {
        let mut rows: Vec<(usize, &Trial, Option<StudyArm>)> = Vec::new();
        let usable = trials
            .iter()
            .copied()
            .filter(|trial| trial.period.is_some() && trial.human_presses > 0 && events(outcome, trial).is_some());
        for trial in usable {
            let Some((participant, last, before)) = rows.last().copied() else {
                rows.push((0, trial, None));
                continue;
            };
            if last.participant != trial.participant {
                rows.push((participant + 1, trial, None));
            } else if last.period == trial.period {
                rows.pop();
                rows.push((participant, trial, before));
            } else {
                rows.push((participant, trial, Some(last.study_arm)));
            }
        }
        let has = |arm: &StudyArm| rows.iter().any(|(_, trial, _)| trial.study_arm == *arm);
        let arms = StudyArm::ALL.into_iter().filter(has).collect();
        let mut periods: Vec<u32> = rows.iter().filter_map(|(_, trial, _)| trial.period).collect();
        periods.sort_unstable();
        periods.dedup();
        Design { outcome, rows, arms, periods }
    }

    /// Whether participants can be compared with themselves.
    fn is_within(&self) -> bool {
        self.arms.len() > 1 && self.rows.iter().any(|(_, _, before)| before.is_some())
    }

    /// Intercept, arms without the first, periods without the first, and the arms before without the first, if asked.
    fn effects(&self, (_, trial, before): &(usize, &Trial, Option<StudyArm>), carry_over: bool) -> Vec<f64> {
        let is = |holds: bool| f64::from(u8::from(holds));
        let arms = self.arms.iter().skip(1).map(|arm| is(trial.study_arm == *arm));
        let periods = self.periods.iter().skip(1).map(|period| is(trial.period == Some(*period)));
        let carried = self.arms.iter().skip(1).filter(|_| carry_over).map(|arm| is(*before == Some(*arm)));
        std::iter::once(1.0).chain(arms).chain(periods).chain(carried).collect()
    }

    fn linear(&self, carry_over: bool) -> Option<LinearMixedModel> {
        let measurement = |row: &(usize, &Trial, Option<StudyArm>)| {
            let (participant, trial, _) = row;
            let count = events(self.outcome, trial)? as f64;
            let value = ((count + 0.5) / trial.human_presses as f64).ln();
            Some(Measurement { participant: *participant, effects: self.effects(row, carry_over), value })
        };
        LinearMixedModel::fit(&self.rows.iter().filter_map(measurement).collect::<Vec<_>>())
    }

    fn counts(&self) -> Option<NegativeBinomialModel> {
        let count = |row: &(usize, &Trial, Option<StudyArm>)| {
            let (participant, trial, _) = row;
            let count = events(self.outcome, trial)?;
            let (effects, exposure) = (self.effects(row, false), trial.human_presses as f64);
            Some(TrialCount { participant: *participant, effects, count, exposure })
        };
        NegativeBinomialModel::fit(&self.rows.iter().filter_map(count).collect::<Vec<_>>())
    }

    /// The pairs that are compared: every arm with the one without signals, and every other one with the wizard.
    fn pairs(&self) -> Vec<(StudyArm, StudyArm)> {
        let mut pairs = Vec::new();
        for against in [StudyArm::None, StudyArm::Wizard] {
            let others = self.arms.iter().copied().filter(|arm| *arm != against && *arm != StudyArm::None);
            pairs.extend(others.filter(|_| self.arms.contains(&against)).map(|arm| (arm, against)));
        }
        if pairs.is_empty() {
            // Neither is there: the first arm is what the others are compared with.
            pairs.extend(self.arms.iter().skip(1).map(|arm| (*arm, self.arms[0])));
        }
        pairs
    }

    /// Weights of the fixed effects for the difference of two arms.
    fn weights(&self, (arm, against): (StudyArm, StudyArm), size: usize) -> Vec<f64> {
        let mut weights = vec![0.0; size];
        for (place, other) in self.arms.iter().enumerate().skip(1) {
            weights[place] = f64::from(i8::from(*other == arm) - i8::from(*other == against));
        }
        weights
    }

    fn contrasts(&self, model: &LinearMixedModel) -> Vec<ArmContrast> {
        let contrast = |pair: (StudyArm, StudyArm)| {
            let contrast = model.contrast(&self.weights(pair, model.estimates.len()))?;
            let (arm, against) = pair;
            let interval = contrast.interval(LEVEL).map(f64::exp);
            Some(ArmContrast { arm, against, ratio: contrast.estimate.exp(), interval, p_holm: contrast.p, contrast })
        };
        let mut all: Vec<ArmContrast> = self.pairs().into_iter().filter_map(contrast).collect();
        let corrected = holm(&all.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
        all.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
        all
    }

    fn count_comparison(&self) -> Option<CountComparison> {
        let model = self.counts()?;
        let contrast = |pair: (StudyArm, StudyArm)| {
            let contrast = model.contrast(&self.weights(pair, model.estimates.len()))?;
            let (arm, against) = pair;
            Some(CountContrast { arm, against, ratio: contrast.estimate.exp(), p_holm: contrast.p, contrast })
        };
        let mut contrasts: Vec<CountContrast> = self.pairs().into_iter().filter_map(contrast).collect();
        let corrected = holm(&contrasts.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
        contrasts.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
        let size = Some(model.size).filter(|size| size.is_finite());
        Some(CountComparison { between_sd: model.between_sd, size, contrasts })
    }
}

/// Holm's correction: the p values, multiplied from the least on by the number of those that are not smaller.
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

/// Compares the arms of these trials, which must be ordered by participant and period; `None` unless participants have trials in different
/// arms, or where the model cannot be estimated. Outcome and margin are those of the plan.
pub fn compare_arms(trials: &[&Trial]) -> Option<ArmComparison> {
    let aims = trials.iter().find_map(|trial| trial.aims).unwrap_or_default();
    let design = Design::new(trials, aims.outcome);
    if !design.is_within() {
        return None;
    }
    let model = design.linear(false)?;
    let contrasts = design.contrasts(&model);
    let with_carry_over = match design.arms.len() {
        0..=2 => Vec::new(),
        _ => design.linear(true).map_or_else(Vec::new, |model| design.contrasts(&model)),
    };
    let is_assistants = |arm: StudyArm| matches!(arm, StudyArm::TomCom | StudyArm::Tom | StudyArm::Dev);
    let against_wizard = contrasts.iter().filter(|one| one.against == StudyArm::Wizard && is_assistants(one.arm));
    let non_inferiority = against_wizard.map(|one| NonInferiority {
        arm: one.arm,
        against: one.against,
        margin: aims.margin,
        ratio: one.ratio,
        upper: one.interval[1],
        p: one.contrast.p_below(aims.margin.ln()),
        holds: one.interval[1] < aims.margin,
    });
    let outcome_of = |arm: StudyArm| {
        let own = || design.rows.iter().map(|(_, trial, _)| *trial).filter(|trial| trial.study_arm == arm);
        ArmOutcome {
            arm,
            trials: own().count(),
            events: own().filter_map(|trial| events(aims.outcome, trial)).sum(),
            presses: own().map(|trial| trial.human_presses).sum(),
        }
    };
    Some(ArmComparison {
        outcome: aims.outcome,
        participants: design.rows.last().map_or(0, |(participant, ..)| participant + 1),
        trials: design.rows.len(),
        arms: design.arms.iter().copied().map(outcome_of).collect(),
        standard_deviations: [model.between.sqrt(), model.within.sqrt()],
        non_inferiority: non_inferiority.collect(),
        contrasts,
        with_carry_over,
        negative_binomial: design.count_comparison(),
        groups: group_orders(trials),
    })
}
