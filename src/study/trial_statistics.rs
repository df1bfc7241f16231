//! Statistics of one trial, which the analysis keeps in memory for every trial of a study. Recordings themselves, and
//! the details of trials ([`super::trial_details`]), are not kept in memory.

use serde::{Deserialize, Serialize};

use super::acting_arm::SignalSenderWithParameter;
use super::known_beliefs::RaterFalseBeliefAgreement;
use super::robot_tally::RobotEventSummary;
use crate::analysis::offer_summary::OfferSummary;
use crate::analysis::probe_record::ProbedTrialStatistics;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_core::measures::raters::RaterPair;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::event::TrialEndReason;
use tomcom_session::plan::{ItemOption, QuestionnaireItemKind, StudyAims};
use tomcom_session::settings::{ArmKind, Condition, ParticipantKind, WizardVisibility};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::wall_display::RobotDepiction;

/// Statistics of one trial of a study: conditions, counts, medians, answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialStatistics {
    /// Path of the recording's folder, relative to the folder given by the user.
    pub recording: String,
    /// Participant code, with the seed in front if several seeds have simulated participants with the same codes.
    pub participant: String,
    /// Seed of the trial's random numbers.
    pub seed: u64,
    /// Kind of participant: a person or a simulation.
    pub kind: ParticipantKind,
    /// Wall clock time at which the recording started; `None` for simulated trials.
    pub started: Option<String>,
    /// Starting group of the participant, if there is a study plan.
    pub group: Option<String>,
    /// Number of the trial in the participant's series, from 1.
    pub period: Option<u32>,
    /// Whether the trial belongs to a study plan, which then says which period the trial is.
    pub is_planned: bool,
    /// Condition of the trial: who could send signals.
    pub condition: Condition,
    /// Study arm of the trial as it was carried out.
    pub study_arm: StudyArm,
    /// Study arm under which the trial counts: assigned by the plan or, without a plan, by the settings.
    pub planned_arm: StudyArm,
    /// Primary outcome and margin that the study's plan sets.
    pub aims: Option<StudyAims>,
    /// Information that the wizard was allowed to see on the console.
    pub wizard_sees: WizardVisibility,
    /// Sender of the signals in a trial without a person as wizard.
    pub acting: SignalSenderWithParameter,
    /// Reason for excluding the trial from the analysis; `None` if the trial is included.
    pub left_out: Option<String>,
    /// Reason for which the trial ended; `None` if the recording is incomplete.
    pub ended: Option<TrialEndReason>,
    /// Kind of the robot's arm in the trial.
    pub arm: ArmKind,
    /// Counts of robot events and of interventions in the robot.
    pub robot: RobotEventSummary,
    /// Number of the human's presses.
    pub human_presses: u64,
    /// Number of the robot's presses.
    pub robot_presses: u64,
    /// Number of the robot's presses that it set out for by its own initiative.
    pub initiative_presses: u64,
    /// The assistant's model of the human: its name, and what differs from the named model.
    pub human_model: String,
    /// Number of the human's errors; races with the robot do not count as errors.
    pub errors: u64,
    /// Number of human presses that the robot may have overtaken (races).
    pub races: u64,
    /// Number of human presses whose judgement rests on a cost to go that is not proven.
    pub unproven: u64,
    /// Statistics of errors from false beliefs; `None` if the human's beliefs are unknown.
    pub beliefs: Option<FalseBeliefErrors>,
    /// Number of orders served in the trial.
    pub orders: u64,
    /// Median time from the appearance of an order to its serving, in seconds.
    pub order_s: Option<f64>,
    /// Median number of presses of both agents per served order.
    pub presses_per_order: Option<f64>,
    /// Summed regret of both agents' presses per served order; `None` if no order was served.
    pub additional_presses_per_order: Option<f64>,
    /// Median time between successive presses of the human, in seconds.
    pub press_s: Option<f64>,
    /// Number of signals shown to the participant.
    pub signals: u64,
    /// Number of contents told by signals: 1 for a signal, k for a proposal of k presses.
    pub signal_contents: u64,
    /// Number of useful signals, judged by simulating the trial without each signal; `None` where that was not done.
    pub useful_signals: Option<u64>,
    /// How the participant's display showed the robot; `None` without a display.
    pub display_arm: Option<RobotDepiction>,
    /// Summary of the offers that a wizard could see.
    pub offers: OfferSummary,
    /// Duration of the trial without pauses, in seconds.
    pub seconds: f64,
    /// Answers to the questionnaires after the trial.
    pub answers: Vec<QuestionnaireAnswer>,
    /// Measures of the wizard's performance; `None` in trials without a wizard.
    pub wizard: Option<WizardMeasures>,
    /// Whether the wizard saw the assistant's recommendations, by the settings or from some time of the trial on.
    pub wizard_saw_advice: bool,
    /// The two raters with their codes, if these codes or the raters' consensus determine the causes of errors.
    pub raters: Option<RaterPair>,
    /// Agreement of the two raters about false beliefs.
    pub shared_beliefs: Option<RaterFalseBeliefAgreement>,
    /// The two raters whose consensus determines the causes of errors.
    pub settled_by: Option<[String; 2]>,
    /// Why the raters' consensus is not used: a rater's code changed after the raters settled it.
    pub stale_consensus: Option<String>,
    /// Statistics of the trial's freeze probes; `None` without probes.
    pub probes: Option<ProbedTrialStatistics>,
}

/// Errors of a trial that follow from false beliefs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FalseBeliefErrors {
    /// Source of what the human believed: recorded beliefs, raters' codes or the belief estimate.
    pub basis: BeliefSource,
    /// Number of errors that follow from false beliefs.
    pub errors: u64,
    /// Number of errors that only two false beliefs together explain.
    pub of_two: u64,
    /// Errors from false beliefs, counted by kind of state aspect.
    pub causes: BeliefErrorCounts,
    /// Length (number of errors) of each error sequence whose errors follow from the same false belief.
    pub lengths: Vec<u32>,
    /// Length (number of errors) of each error sequence, whichever false beliefs its errors follow from.
    pub lengths_any_aspect: Vec<u32>,
    /// For each error sequence that has ended, the time from its first error to the first correct press after its last
    /// error, in seconds.
    pub recovery_s: Vec<f64>,
    /// Number of false belief episodes with at least one error; `None` if beliefs are known from the estimate alone.
    pub episodes: Option<u64>,
}

/// An answer to a questionnaire item.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuestionnaireAnswer {
    /// Name of the questionnaire to which the item belongs.
    pub questionnaire: String,
    /// Identifier of the questionnaire item.
    pub item: String,
    /// Statement of the questionnaire item, as the participant read it.
    pub text: String,
    /// Construct that the item measures, such as acceptance.
    pub about: Option<String>,
    /// Whether agreement with the item's statement counts against the construct.
    pub reversed: bool,
    /// Kind of answer that the item takes.
    pub kind: QuestionnaireItemKind,
    /// The participant's answer; `None` if the participant skipped the item.
    pub answer: Option<AnswerValue>,
    /// Number of points of the item's rating scale; `None` for other kinds of item.
    pub points: Option<u8>,
    /// The answer options of the item: id and text.
    pub options: Vec<ItemOption>,
    /// The answer on a scale or slider as a number from 0 to 1, reversed if the item is reverse coded.
    pub share: Option<f64>,
    /// Whether the item was asked before the first trial, rather than after this trial.
    pub before: bool,
    /// Score of the whole questionnaire on this occasion; `None` if the questionnaire has no score.
    pub score: Option<f64>,
}

impl TrialStatistics {
    /// Whether the analysis includes the trial.
    pub fn counts(&self) -> bool {
        self.left_out.is_none()
    }

    /// Name of the kind of participant (person or simulation) in tables.
    pub fn kind_name(&self) -> &'static str {
        match self.kind {
            ParticipantKind::Simulated => "simulated",
            ParticipantKind::Keyboard => "keyboard",
            ParticipantKind::Display => "display",
        }
    }

    /// Number of presses of both agents in the trial together.
    pub fn presses(&self) -> u64 {
        self.human_presses + self.robot_presses
    }

    /// Errors per human press; `None` without presses.
    pub fn error_rate_human(&self) -> Option<f64> {
        (self.human_presses > 0).then(|| self.errors as f64 / self.human_presses as f64)
    }

    /// Errors of the human per press of both agents; `None` without presses.
    pub fn error_rate(&self) -> Option<f64> {
        (self.presses() > 0).then(|| self.errors as f64 / self.presses() as f64)
    }

    /// Mean number of errors in a sequence of errors from the same false belief.
    pub fn sequence_length(&self) -> Option<f64> {
        mean_length(&self.beliefs.as_ref()?.lengths)
    }

    /// Mean time to recover from an error sequence, in seconds.
    pub fn recovery_s(&self) -> Option<f64> {
        mean(self.beliefs.as_ref()?.recovery_s.iter().copied())
    }

    /// Whether the trial was planned with signals.
    pub fn is_assisted(&self) -> bool {
        self.planned_arm != StudyArm::None
    }
}

/// Mean of the lengths of error sequences; `None` without sequences.
pub fn mean_length(lengths: &[u32]) -> Option<f64> {
    mean(lengths.iter().map(|&length| f64::from(length)))
}

/// Mean of the values; `None` without values.
pub fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// Sets participant names, and periods where no study plan defines them, and sorts the trials by participant and
/// period. Without a plan, a live trial is the participant's first or second by wall clock, if exactly two of the
/// participant's trials count.
pub fn arrange(trials: &mut [TrialStatistics]) {
    let mut seeds: Vec<u64> = simulated(trials).map(|trial| trial.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    for trial in trials.iter_mut().filter(|trial| trial.started.is_none() && seeds.len() > 1) {
        trial.participant = format!("seed{}-{}", trial.seed, trial.participant);
    }
    let key = |trial: &TrialStatistics| {
        (trial.participant.clone(), trial.period, trial.started.clone(), trial.recording.clone())
    };
    trials.sort_by_cached_key(key);
    for of_one in trials.chunk_by_mut(|a, b| a.participant == b.participant) {
        let unplanned = |trial: &TrialStatistics| trial.counts() && !trial.is_planned && trial.started.is_some();
        if of_one.iter().filter(|trial| unplanned(trial)).count() == 2 {
            let mut period = 0;
            for trial in of_one.iter_mut().filter(|trial| unplanned(trial)) {
                period += 1;
                trial.period = Some(period);
            }
        }
    }
}

/// The fully simulated trials among these, in which every seed uses the same participant codes.
fn simulated(trials: &[TrialStatistics]) -> impl Iterator<Item = &TrialStatistics> {
    trials.iter().filter(|trial| trial.started.is_none())
}
