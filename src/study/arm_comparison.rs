//! Comparison of any number of study arms by one primary outcome: the count of an event in a trial, as a rate per press
//! of the human.
//!
//! The primary model is a linear mixed model of log((count + 0.5) / presses), with the participant as random effect,
//! and arm and period as fixed effects ([`super::linear_mixed_model`]). A mixed negative binomial model with log
//! presses as offset is reported beside it. A mixed Poisson model would assume that errors are independent, but errors
//! come in runs. Contrasts are ratios of rates; their p values are corrected together (Holm 1979). With three or more
//! arms, a model with the effect of the previous arm (carry-over) is a sensitivity analysis.

use serde::Serialize;

use super::arm_design::{ArmComparisonDesign, StudyArmTrial, pairs};
use super::effect::{LEVEL, LeftOutParticipant};
use super::group_orders::{GroupOrder, group_orders};
use super::linear_mixed_model::{LinearMixedModel, MixedModelContrast};
use super::negative_binomial_model::WaldContrast;
use super::trial_statistics::TrialStatistics;
use tomcom_session::plan::{PrimaryOutcome, StudyAims};
use tomcom_session::study_arm::StudyArm;

/// Comparison of the arms of a study by the primary outcome.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudyArmComparison {
    /// Primary outcome: the event whose rate is compared between study arms.
    pub outcome: PrimaryOutcome,
    /// Number of participants in the comparison of arms.
    pub participants: usize,
    /// Number of trials in the comparison of arms.
    pub trials: usize,
    /// Participants with recordings whom the comparison leaves out.
    pub left_out: Vec<LeftOutParticipant>,
    /// Numbers of trials, events and presses of each arm, in the order of tables.
    pub arms: Vec<StudyArmCounts>,
    /// Standard deviations of log rates: between participants, and residual (within participants).
    pub standard_deviations: [f64; 2],
    /// Contrasts of the primary model: arms against the arm without signals and against the wizard.
    pub contrasts: Vec<StudyArmContrast>,
    /// Contrasts of the model that includes the effect of the previous arm (carry-over); empty with fewer than three
    /// arms, or where the model cannot be estimated.
    pub with_carry_over: Vec<StudyArmContrast>,
    /// Comparison by the mixed negative binomial model; null where the model cannot be estimated.
    pub negative_binomial: Option<NegativeBinomialComparison>,
    /// Non-inferiority of the assistant's arms to the wizard's.
    pub non_inferiority: Vec<NonInferiority>,
    /// Starting groups with their orders of conditions.
    pub groups: Vec<GroupOrder>,
}

/// Counts of trials, events and presses of one study arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyArmCounts {
    /// Study arm of the counts.
    pub arm: StudyArm,
    /// Number of trials in this study arm.
    pub trials: usize,
    /// Number of events of the primary outcome in this study arm.
    pub events: u64,
    /// Number of the human's presses in this study arm.
    pub presses: u64,
}

impl StudyArmCounts {
    /// Events of the primary outcome per 100 presses of the human, over all trials of the arm together.
    pub fn per_100(&self) -> f64 {
        100.0 * self.events as f64 / self.presses as f64
    }
}

/// Comparison of one study arm with another in the primary model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StudyArmContrast {
    /// Study arm that is compared.
    pub arm: StudyArm,
    /// Study arm with which `arm` is compared.
    pub against: StudyArm,
    /// Ratio of the rate in `arm` to the rate in `against`.
    pub ratio: f64,
    /// 95 % confidence interval of the ratio of rates.
    pub interval: [f64; 2],
    /// p value after Holm's correction over all contrasts.
    pub p_holm: f64,
    /// Contrast (difference) of the log rates, with its t test.
    #[serde(flatten)]
    pub contrast: MixedModelContrast,
}

/// Comparison of study arms by the mixed negative binomial model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NegativeBinomialComparison {
    /// Standard deviation of log rates between participants.
    pub between_sd: f64,
    /// Size parameter of the negative binomial distribution: the variance of a count is mu + mu^2 / size; null where
    /// counts vary no more than under a Poisson distribution.
    pub size: Option<f64>,
    /// Contrasts between the same arms as in the primary model.
    pub contrasts: Vec<NegativeBinomialContrast>,
}

/// Comparison of one study arm with another in the negative binomial model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NegativeBinomialContrast {
    /// Study arm that is compared.
    pub arm: StudyArm,
    /// Study arm with which `arm` is compared.
    pub against: StudyArm,
    /// Ratio of the rate in `arm` to the rate in `against`.
    pub ratio: f64,
    /// p value after Holm's correction over all contrasts of the negative binomial model.
    pub p_holm: f64,
    /// Contrast (difference) of the log rates, with its Wald test.
    #[serde(flatten)]
    pub contrast: WaldContrast,
}

/// Test whether an arm of the assistant is not worse than the wizard (non-inferiority).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NonInferiority {
    /// Study arm of the assistant.
    pub arm: StudyArm,
    /// Study arm of the wizard, with which the assistant's arm is compared.
    pub against: StudyArm,
    /// Largest ratio of rates that is acceptable (non-inferiority margin).
    pub margin: f64,
    /// Ratio of the assistant's rate of the primary outcome to the wizard's.
    pub ratio: f64,
    /// Upper end of the one-sided 97.5 % confidence interval of the ratio of rates.
    pub upper: f64,
    /// One-sided p value of the hypothesis that the ratio is at or above the margin.
    pub p: f64,
    /// Whether non-inferiority is shown: the upper end of the interval is below the margin.
    pub holds: bool,
}

/// Number of events of the primary outcome in a trial; `None` if that number is unknown for the trial.
fn events(outcome: PrimaryOutcome, trial: &TrialStatistics) -> Option<u64> {
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

/// The trials that the comparison uses, and the participants without such a trial. If a participant repeated a period,
/// its last trial counts.
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

/// Contrasts of the primary model, with Holm's correction.
fn contrasts(design: &ArmComparisonDesign, model: &LinearMixedModel) -> Vec<StudyArmContrast> {
    let contrast = |pair: (StudyArm, StudyArm)| {
        let contrast = model.contrast(&design.weights(pair, model.estimates.len()))?;
        let (arm, against) = pair;
        let interval = contrast.interval(LEVEL).map(f64::exp);
        Some(StudyArmContrast { arm, against, ratio: contrast.estimate.exp(), interval, p_holm: contrast.p, contrast })
    };
    let mut all: Vec<StudyArmContrast> = pairs(design.arms()).into_iter().filter_map(contrast).collect();
    let corrected = holm(&all.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
    all.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
    all
}

fn count_comparison(design: &ArmComparisonDesign) -> Option<NegativeBinomialComparison> {
    let model = design.counts()?;
    let contrast = |pair: (StudyArm, StudyArm)| {
        let contrast = model.contrast(&design.weights(pair, model.estimates.len()))?;
        let (arm, against) = pair;
        Some(NegativeBinomialContrast { arm, against, ratio: contrast.estimate.exp(), p_holm: contrast.p, contrast })
    };
    let mut contrasts: Vec<NegativeBinomialContrast> = pairs(design.arms()).into_iter().filter_map(contrast).collect();
    let corrected = holm(&contrasts.iter().map(|one| one.contrast.p).collect::<Vec<_>>());
    contrasts.iter_mut().zip(corrected).for_each(|(one, p)| one.p_holm = p);
    let size = Some(model.size).filter(|size| size.is_finite());
    Some(NegativeBinomialComparison { between_sd: model.between_sd, size, contrasts })
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

/// Contrasts of the primary model alone, for trials ordered by participant and period; empty where the model cannot be
/// estimated.
pub fn primary_contrasts(trials: Vec<StudyArmTrial>) -> Vec<StudyArmContrast> {
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

/// Compares arms by counts of the primary outcome that `aims` sets; the result has no starting groups, and
/// leaves nobody out.
pub fn compare_counts(trials: Vec<StudyArmTrial>, aims: StudyAims) -> Option<StudyArmComparison> {
    let design = ArmComparisonDesign::new(trials);
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
        StudyArmCounts {
            arm,
            trials: own().count(),
            events: own().map(|trial| trial.events).sum(),
            presses: own().map(|trial| trial.presses).sum(),
        }
    };
    Some(StudyArmComparison {
        outcome: aims.outcome,
        participants: design.trials().last().map_or(0, |trial| trial.participant + 1),
        trials: design.trials().len(),
        left_out: Vec::new(),
        arms: design.arms().iter().copied().map(outcome_of).collect(),
        standard_deviations: [model.between.sqrt(), model.within.sqrt()],
        non_inferiority: non_inferiority.collect(),
        contrasts: found,
        with_carry_over,
        negative_binomial: count_comparison(&design),
        groups: Vec::new(),
    })
}
