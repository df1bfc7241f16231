//! Comparison of any number of arms by one primary outcome: a count of a trial, as a rate per press of the human.
//!
//! The primary model is a linear mixed model of log((count + 0.5) / presses), with the participant as random, arm and period as fixed effects
//! ([`super::linear_mixed_model`]); a mixed negative binomial model with log presses as offset stands beside it. A mixed Poisson model would
//! take errors for independent events, which they are not: they come in runs. Contrasts are ratios of rates; their p values are corrected
//! together (Holm 1979). From three arms on, a model with the effect of the arm before (carry-over) is a sensitivity analysis.

use serde::Serialize;

use super::arm_design::{ArmDesign, ArmTrial, pairs};
use super::effect::LEVEL;
use super::group_orders::{GroupOrder, group_orders};
use super::linear_mixed_model::{Contrast, LinearMixedModel};
use super::negative_binomial_model::WaldContrast;
use super::trial_statistics::Trial;
use crate::session::plan::{PrimaryOutcome, StudyAims};
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

/// Number of the outcome's events in a trial; `None` if it is not known there.
fn events(outcome: PrimaryOutcome, trial: &Trial) -> Option<u64> {
    match outcome {
        PrimaryOutcome::Errors => Some(trial.errors),
        PrimaryOutcome::BeliefRelatedErrors => trial.beliefs.as_ref().map(|beliefs| beliefs.errors),
        PrimaryOutcome::Sequences => trial.beliefs.as_ref().map(|beliefs| beliefs.lengths.len() as u64),
    }
}

/// The trials that have a period and the outcome. A repeated period counts once, by its last trial.
fn counted(trials: &[&Trial], outcome: PrimaryOutcome) -> Vec<ArmTrial> {
    let mut rows: Vec<(&Trial, ArmTrial)> = Vec::new();
    for trial in trials.iter().copied().filter(|trial| trial.human_presses > 0) {
        let (Some(period), Some(events)) = (trial.period, events(outcome, trial)) else { continue };
        let mut participant = 0;
        if let Some((last, row)) = rows.last() {
            participant = row.participant + usize::from(last.participant != trial.participant);
            if participant == row.participant && row.period == period {
                rows.pop();
            }
        }
        let (arm, presses) = (trial.study_arm, trial.human_presses);
        rows.push((trial, ArmTrial { participant, period, arm, events, presses }));
    }
    rows.into_iter().map(|(_, row)| row).collect()
}

/// Contrasts of the primary model with Holm's correction.
fn contrasts(design: &ArmDesign, model: &LinearMixedModel) -> Vec<ArmContrast> {
    let contrast = |pair: (StudyArm, StudyArm)| {
        let contrast = model.contrast(&design.weights(pair, model.estimates.len()))?;
        let (arm, against) = pair;
        let interval = contrast.interval(LEVEL).map(f64::exp);
        Some(ArmContrast { arm, against, ratio: contrast.estimate.exp(), interval, p_holm: contrast.p, contrast })
    };
    let mut all: Vec<ArmContrast> = pairs(design.arms()).into_iter().filter_map(contrast).collect();
    let corrected = holm(&all.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
    all.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
    all
}

fn count_comparison(design: &ArmDesign) -> Option<CountComparison> {
    let model = design.counts()?;
    let contrast = |pair: (StudyArm, StudyArm)| {
        let contrast = model.contrast(&design.weights(pair, model.estimates.len()))?;
        let (arm, against) = pair;
        Some(CountContrast { arm, against, ratio: contrast.estimate.exp(), p_holm: contrast.p, contrast })
    };
    let mut contrasts: Vec<CountContrast> = pairs(design.arms()).into_iter().filter_map(contrast).collect();
    let corrected = holm(&contrasts.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
    contrasts.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
    let size = Some(model.size).filter(|size| size.is_finite());
    Some(CountComparison { between_sd: model.between_sd, size, contrasts })
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

/// Contrasts of the primary model alone, of trials ordered by participant and period; none where it cannot be estimated.
pub fn primary_contrasts(trials: Vec<ArmTrial>) -> Vec<ArmContrast> {
    let design = ArmDesign::new(trials);
    let model = if design.is_within() { design.linear(false) } else { None };
    model.map_or_else(Vec::new, |model| contrasts(&design, &model))
}

/// Compares the arms of these trials, which must be ordered by participant and period; `None` unless participants have trials in different
/// arms, or where the model cannot be estimated. Outcome and margin are those of the plan.
pub fn compare_arms(trials: &[&Trial]) -> Option<ArmComparison> {
    let aims = trials.iter().find_map(|trial| trial.aims).unwrap_or_default();
    let compared = compare_counts(counted(trials, aims.outcome), aims)?;
    Some(ArmComparison { groups: group_orders(trials), ..compared })
}

/// The same of counts of the primary outcome of these aims; without starting groups.
pub fn compare_counts(trials: Vec<ArmTrial>, aims: StudyAims) -> Option<ArmComparison> {
    let design = ArmDesign::new(trials);
    if !design.is_within() {
        return None;
    }
    let model = design.linear(false)?;
    let found = contrasts(&design, &model);
    let with_carry_over = match design.arms().len() {
        0..=2 => Vec::new(),
        _ => design.linear(true).map_or_else(Vec::new, |model| contrasts(&design, &model)),
    };
    let is_assistants = |arm: StudyArm| matches!(arm, StudyArm::TomCom | StudyArm::Tom | StudyArm::Dev);
    let against_wizard = found.iter().filter(|one| one.against == StudyArm::Wizard && is_assistants(one.arm));
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
        let own = || design.trials().iter().filter(|trial| trial.arm == arm);
        ArmOutcome {
            arm,
            trials: own().count(),
            events: own().map(|trial| trial.events).sum(),
            presses: own().map(|trial| trial.presses).sum(),
        }
    };
    Some(ArmComparison {
        outcome: aims.outcome,
        participants: design.trials().last().map_or(0, |trial| trial.participant + 1),
        trials: design.trials().len(),
        arms: design.arms().iter().copied().map(outcome_of).collect(),
        standard_deviations: [model.between.sqrt(), model.within.sqrt()],
        non_inferiority: non_inferiority.collect(),
        contrasts: found,
        with_carry_over,
        negative_binomial: count_comparison(&design),
        groups: Vec::new(),
    })
}
