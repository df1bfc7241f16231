//! Design matrix of a comparison of study arms: the effects of arm, period and previous arm for each trial.

use super::linear_mixed_model::{LinearMixedModel, MixedModelMeasurement};
use super::negative_binomial_model::{CountObservation, NegativeBinomialModel};
use tomcom_session::study_arm::StudyArm;

/// A trial in the comparison of arms: participant, period, arm, and counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StudyArmTrial {
    /// Index of the participant.
    pub participant: usize,
    /// Number of the trial in the participant's series, from 1.
    pub period: u32,
    /// Study arm of the trial.
    pub arm: StudyArm,
    /// Number of events of the primary outcome.
    pub events: u64,
    /// Number of the human's presses in the trial; above 0.
    pub presses: u64,
}

impl StudyArmTrial {
    /// Dependent variable of the primary model: log((events + 0.5) / presses).
    pub fn log_rate(&self) -> f64 {
        ((self.events as f64 + 0.5) / self.presses as f64).ln()
    }
}

/// Design of a comparison of arms: one row of effects per trial.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmComparisonDesign {
    trials: Vec<StudyArmTrial>,
    arms: Vec<StudyArm>,
    periods: Vec<u32>,
}

/// The pairs of study arms that are compared: every arm with the one without signals, and every other one with the
/// wizard's. If neither exists, all others are compared with the first arm.
pub fn pairs(arms: &[StudyArm]) -> Vec<(StudyArm, StudyArm)> {
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
    pub fn new(trials: Vec<StudyArmTrial>) -> ArmComparisonDesign {
        let has = |arm: &StudyArm| trials.iter().any(|trial| trial.arm == *arm);
        let arms = StudyArm::ALL.into_iter().filter(has).collect();
        let mut periods: Vec<u32> = trials.iter().map(|trial| trial.period).collect();
        periods.sort_unstable();
        periods.dedup();
        ArmComparisonDesign { trials, arms, periods }
    }

    /// The trials of the comparison, ordered by participant and period.
    pub fn trials(&self) -> &[StudyArmTrial] {
        &self.trials
    }

    /// The study arms that occur in the trials, in the order of tables.
    pub fn arms(&self) -> &[StudyArm] {
        &self.arms
    }

    /// Whether any participant has trials in different arms, so that arms can be compared within participants.
    pub fn is_within(&self) -> bool {
        self.arms.len() > 1 && self.trials.windows(2).any(|pair| pair[0].participant == pair[1].participant)
    }

    /// The study arm of the participant's trial before the one with this index.
    fn before(&self, index: usize) -> Option<StudyArm> {
        let before = self.trials.get(index.checked_sub(1)?)?;
        (before.participant == self.trials[index].participant).then_some(before.arm)
    }

    /// Row of fixed effects of a trial in the design matrix: intercept, arms without the first, periods without the
    /// first and, with `carry_over`, previous arms without the first.
    fn effects(&self, index: usize, carry_over: bool) -> Vec<f64> {
        let (trial, before) = (&self.trials[index], self.before(index));
        let is = |holds: bool| f64::from(u8::from(holds));
        let arms = self.arms.iter().skip(1).map(|arm| is(trial.arm == *arm));
        let periods = self.periods.iter().skip(1).map(|period| is(trial.period == *period));
        let carried = self.arms.iter().skip(1).filter(|_| carry_over).map(|arm| is(before == Some(*arm)));
        std::iter::once(1.0).chain(arms).chain(periods).chain(carried).collect()
    }

    /// The primary (linear mixed) model, with `carry_over` including the effect of the previous arm; `None` where the
    /// model cannot be estimated.
    pub fn linear(&self, carry_over: bool) -> Option<LinearMixedModel> {
        let measurement = |(index, trial): (usize, &StudyArmTrial)| MixedModelMeasurement {
            participant: trial.participant,
            effects: self.effects(index, carry_over),
            value: trial.log_rate(),
        };
        LinearMixedModel::fit(&self.trials.iter().enumerate().map(measurement).collect::<Vec<_>>())
    }

    /// The negative binomial model of counts; `None` where the model cannot be estimated.
    pub fn counts(&self) -> Option<NegativeBinomialModel> {
        let count = |(index, trial): (usize, &StudyArmTrial)| CountObservation {
            participant: trial.participant,
            effects: self.effects(index, false),
            count: trial.events,
            exposure: trial.presses as f64,
        };
        NegativeBinomialModel::fit(&self.trials.iter().enumerate().map(count).collect::<Vec<_>>())
    }

    /// Weights of the fixed effects for the difference between two arms, in a model with `size` effects.
    pub fn weights(&self, (arm, against): (StudyArm, StudyArm), size: usize) -> Vec<f64> {
        let mut weights = vec![0.0; size];
        for (place, other) in self.arms.iter().enumerate().skip(1) {
            weights[place] = f64::from(i8::from(*other == arm) - i8::from(*other == against));
        }
        weights
    }
}
