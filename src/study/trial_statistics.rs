//! Statistics of one trial for the analysis; recordings themselves are not kept in memory.

use serde::{Deserialize, Serialize};

use super::acting_arm::ActingArm;
use super::known_beliefs::SharedBeliefs;
use super::robot_tally::RobotSummary;
use super::roc::SweptTrial;
use crate::analysis::offer_summary::{OfferSummary, TimedOffer};
use crate::analysis::probe_record::ProbedTrial;
use crate::measures::belief_basis::BeliefBasis;
use crate::measures::cause_codes::Codes;
use crate::measures::cause_kinds::CauseKindCounts;
use crate::measures::matching::CommunicationEvent;
use crate::measures::wizard_performance::WizardMeasures;
use crate::session::answer_value::AnswerValue;
use crate::session::event::EndReason;
use crate::session::plan::{ItemKind, ItemOption, StudyAims};
use crate::session::settings::{ArmKind, Condition, ParticipantKind, Visibility};
use crate::session::study_arm::StudyArm;
use crate::session::wall_display::DisplayedArm;

/// Statistics of one trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Path of the recording's folder, relative to the folder given by the user.
    pub recording: String,
    /// Participant code; prefixed by the seed if several seeds have simulated participants with the same codes.
    pub participant: String,
    /// The seed of everything random.
    pub seed: u64,
    /// Who played the human's part.
    pub kind: ParticipantKind,
    /// Start by the wall clock; `None` for simulated trials.
    pub started: Option<String>,
    /// The starting group of a plan.
    pub group: Option<String>,
    /// The number of the trial in the participant's series; 1 is the first.
    pub period: Option<u32>,
    /// Whether the trial belongs to a study plan, which then defines its period.
    pub is_planned: bool,
    /// Who could send signals.
    pub condition: Condition,
    /// The arm of the trial, by what was done in it.
    pub study_arm: StudyArm,
    /// The arm that the plan gave to it, if it belongs to a plan that has arms.
    pub planned_arm: Option<StudyArm>,
    /// What the study asks, by its plan.
    pub aims: Option<StudyAims>,
    /// What the wizard was allowed to see.
    pub wizard_sees: Visibility,
    /// Who sent the signals by itself.
    pub acting: ActingArm,
    /// Reason for excluding the trial; `None` if it counts.
    pub left_out: Option<String>,
    /// Reason of the trial's end; `None` if the recording is incomplete.
    pub ended: Option<EndReason>,
    /// The robot's arm.
    pub arm: ArmKind,
    /// What was counted of the robot.
    pub robot: RobotSummary,
    /// Presses of the human.
    pub human_presses: u64,
    /// Presses of the robot.
    pub robot_presses: u64,
    /// Number of human errors, without races.
    pub errors: u64,
    /// Number of human presses that the robot may have overtaken (races).
    pub races: u64,
    /// Statistics of false beliefs; `None` if the human's beliefs are unknown.
    pub beliefs: Option<BeliefErrors>,
    /// Orders served.
    pub orders: u64,
    /// The median time from the appearance of an order to its serving, in seconds.
    pub order_s: Option<f64>,
    /// Median presses of both agents per order.
    pub presses_per_order: Option<f64>,
    /// Summed regret of both agents' presses per served order; `None` if no order was served.
    pub additional_presses_per_order: Option<f64>,
    /// Median seconds between successive human presses.
    pub press_s: Option<f64>,
    /// Number of signals shown.
    pub signals: u64,
    /// Number of their contents: a proposal of k presses has k.
    pub signal_contents: u64,
    /// Number of these that were useful, judged by twins of simulated trials; `None` where there are none.
    pub useful_signals: Option<u64>,
    /// How the participant's display showed the robot; `None` without a display, and in recordings from before it could.
    pub display_arm: Option<DisplayedArm>,
    /// Offers that a wizard could see; `None` in recordings without offers.
    pub offers: Option<Vec<TimedOffer>>,
    /// Length of the trial without pauses, in seconds.
    pub seconds: f64,
    /// The answers to questionnaires after the trial.
    pub answers: Vec<QuestionnaireAnswer>,
    /// Measures of the wizard; `None` in other conditions.
    pub wizard: Option<WizardMeasures>,
    /// Whether a wizard saw the assistant's recommendations, by the settings or from some time on.
    pub wizard_saw_advice: bool,
    /// In wizard trials: sent communications, and hypothetical ones of the assistant.
    pub lanes: Option<[Vec<CommunicationEvent>; 2]>,
    /// In unassisted trials with known beliefs: prevention counts of the concepts.
    pub swept: Vec<SweptTrial>,
    /// Codes of two raters, if they or their consensus define the causes of errors.
    pub raters: Option<[Codes; 2]>,
    /// How far these two agree on false beliefs.
    pub shared_beliefs: Option<SharedBeliefs>,
    /// The two raters whose consensus defines the causes of errors.
    pub settled_by: Option<[String; 2]>,
    /// Why a consensus is not used: a rater's code that changed after it was settled.
    pub stale_consensus: Option<String>,
    /// The questions of probes and their answers; `None` without probes.
    pub probes: Option<ProbedTrial>,
}

/// Errors that false beliefs caused in a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeliefErrors {
    /// How it is known what the human believed.
    pub basis: BeliefBasis,
    /// Number of belief related errors.
    pub errors: u64,
    /// Number of belief related errors that need two false beliefs as explanation.
    pub of_two: u64,
    /// Belief related errors by kind of aspect.
    pub causes: CauseKindCounts,
    /// Number of errors of each sequence of related errors.
    pub lengths: Vec<u32>,
    /// Number of errors of each sequence whatever the aspect.
    pub lengths_any_aspect: Vec<u32>,
    /// Seconds from the first error of each sequence to the first correct press after its last error, where there is one.
    pub recovery_s: Vec<f64>,
    /// Number of false belief episodes with at least one error; `None` if beliefs are known by the estimate alone.
    pub episodes: Option<u64>,
}

/// An answer to a questionnaire item.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuestionnaireAnswer {
    /// The questionnaire's name.
    pub questionnaire: String,
    /// The item's id.
    pub item: String,
    /// The statement.
    pub text: String,
    /// What the item is about.
    pub about: Option<String>,
    /// Agreement speaks against what it is about.
    pub reversed: bool,
    /// How the item is answered.
    pub kind: ItemKind,
    /// The answer; `None` if the participant skipped the item.
    pub answer: Option<AnswerValue>,
    /// Number of points of the item's scale; `None` if it is answered in another way.
    pub points: Option<u8>,
    /// The options of the item: id and text.
    pub options: Vec<ItemOption>,
    /// The answer from 0 to 1 on a scale or slider, turned round if the item is reversed.
    pub share: Option<f64>,
    /// Whether it was asked before the first trial, rather than after the trial.
    pub before: bool,
    /// Score of the whole questionnaire at this occasion, if it has one.
    pub score: Option<f64>,
}

impl Trial {
    /// Summary of the offers that a wizard could see; `None` in recordings without offers.
    pub fn offer_summary(&self) -> Option<OfferSummary> {
        self.offers.as_ref().map(OfferSummary::from_offers)
    }

    /// Whether the trial counts in the analysis.
    pub fn counts(&self) -> bool {
        self.left_out.is_none()
    }

    /// Name of the participant's kind in tables.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            ParticipantKind::Simulated => "simulated",
            ParticipantKind::Keyboard => "keyboard",
            ParticipantKind::Display => "display",
        }
    }

    /// Number of presses of both agents.
    pub fn presses(&self) -> u64 {
        self.human_presses + self.robot_presses
    }

    /// Errors per human press; `None` without presses.
    pub fn error_rate_human(&self) -> Option<f64> {
        (self.human_presses > 0).then(|| self.errors as f64 / self.human_presses as f64)
    }

    /// Errors per press of both agents; `None` without presses.
    pub fn error_rate(&self) -> Option<f64> {
        (self.presses() > 0).then(|| self.errors as f64 / self.presses() as f64)
    }

    /// Mean number of errors per sequence of related errors.
    pub fn sequence_length(&self) -> Option<f64> {
        mean_length(&self.beliefs.as_ref()?.lengths)
    }

    /// Mean seconds to recover from an error sequence.
    pub fn recovery_s(&self) -> Option<f64> {
        mean(self.beliefs.as_ref()?.recovery_s.iter().copied())
    }

    /// Why the trial is not of the arm that the plan gave to it, in words; `None` if it is.
    pub fn misfit(&self) -> Option<String> {
        let planned = self.planned_arm.filter(|planned| *planned != self.study_arm)?;
        let (planned, done) = (planned.title(), self.study_arm.title());
        Some(format!("planned: {planned}; done: {done}, in which the wizard saw {}", self.wizard_sees.title()))
    }

    /// Whether signals are sent in the trial.
    pub fn is_assisted(&self) -> bool {
        self.condition != Condition::None
    }
}

/// Mean of lengths; `None` without values.
pub fn mean_length(lengths: &[u32]) -> Option<f64> {
    mean(lengths.iter().map(|&length| f64::from(length)))
}

/// Mean of the values; `None` without values.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// Sets participant names, and periods where no study plan defines them, and sorts the trials by participant and period. Without a
/// plan, a live trial is the participant's first or second by wall clock, if exactly two of its trials count.
pub fn arrange(trials: &mut [Trial]) {
    let mut seeds: Vec<u64> = simulated(trials).map(|trial| trial.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    for trial in trials.iter_mut().filter(|trial| trial.started.is_none() && seeds.len() > 1) {
        trial.participant = format!("seed{}-{}", trial.seed, trial.participant);
    }
    let key = |trial: &Trial| (trial.participant.clone(), trial.period, trial.started.clone(), trial.recording.clone());
    trials.sort_by_cached_key(key);
    for of_one in trials.chunk_by_mut(|a, b| a.participant == b.participant) {
        let unplanned = |trial: &Trial| trial.counts() && !trial.is_planned && trial.started.is_some();
        if of_one.iter().filter(|trial| unplanned(trial)).count() == 2 {
            let mut period = 0;
            for trial in of_one.iter_mut().filter(|trial| unplanned(trial)) {
                period += 1;
                trial.period = Some(period);
            }
        }
    }
}

/// Fully simulated trials, in which every seed reuses the same participant codes.
fn simulated(trials: &[Trial]) -> impl Iterator<Item = &Trial> {
    trials.iter().filter(|trial| trial.started.is_none())
}
