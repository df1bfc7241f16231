//! Comparison of a study's conditions. Each trial counts in the arm to which the plan assigned it, as randomised. A trial
//! that was carried out otherwise is a deviation; the same comparison by the arms as carried out stands beside.

use serde::Serialize;

use crate::arm_comparison::{StudyArmComparison, compare_arms};
use crate::effect::{AssistanceEffect, StudyMeasure, effect, pairs};
use crate::statistics::mean;
use crate::tables::probe_table::PROBES_WRONG;
use crate::tables::trials::measures;
use crate::trial_statistics::{TrialStatistics, TrialTotals};
use tomcom_session::settings::WizardVisibility;
use tomcom_session::study_arm::StudyArm;

/// A trial that was carried out in another arm than the one to which the plan assigned it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ArmDeviation {
    pub recording: String,
    pub participant: String,
    pub planned: StudyArm,
    pub carried_out: StudyArm,
    /// Whether the wizard was shown during the trial what the assistants would send.
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

    /// The deviation in words.
    pub fn describe(&self) -> String {
        let why = if self.unblinded { ", since the wizard was shown what the assistants would send" } else { "" };
        format!("{}: planned {}, carried out {}{why}", self.recording, self.planned.title(), self.carried_out.title())
    }
}

/// Comparison of the conditions of a study: rates by condition, the effect of assistance, and the comparison of arms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ArmAnalysis {
    pub conditions: Vec<StudyConditionSummary>,
    pub effects: Vec<AssistanceEffect>,
    /// Comparison of the study arms by the plan's primary outcome; null unless participants have trials in different
    /// arms.
    pub arms: Option<StudyArmComparison>,
}

impl ArmAnalysis {
    /// The comparison by planned arms; `trials` must be ordered by participant and period. `seed` seeds the random
    /// permutations.
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
    /// The condition: who sends signals, by which concept, and whether a wizard sees recommendations.
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
    measures().into_iter().filter(move |measure| *measure != PROBES_WRONG || has_probes)
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
