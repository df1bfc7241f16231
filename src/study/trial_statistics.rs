//! Statistics of trials: those that the analysis keeps in memory for every trial of a study, the details that it keeps
//! in temporary files and reads trial by trial, and sums over both.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Deserializer, Serialize, de};

use crate::analysis::offer_summary::{OfferSummary, OfferTally, TimedOffer};
use crate::analysis::probe_record::{ProbedTrial, ProbedTrialStatistics};
use crate::effect::LEVEL;
use crate::rater_episodes::RaterFalseBeliefAgreement;
use crate::robot_tally::RobotEventSummary;
use crate::roc::{ConceptPreventionCounts, ConceptTotals};
use crate::statistics::{ConfidenceInterval, mean, wilson};
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::measures::matching::{CommunicationEvent, MatchCounts, WINDOW};
use tomcom_core::measures::raters::{BeliefSource, RaterPair};
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::event::TrialEndReason;
use tomcom_session::plan::{ItemOption, QuestionnaireItemKind, StudyAims};
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::settings::{ArmKind, Condition, ParticipantKind, WizardVisibility};
use tomcom_session::study_arm::StudyArm;
use tomcom_session::wall_display::RobotDepiction;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrialStatistics {
    /// Path of the recording's folder, relative to the folder given by the user.
    pub recording: String,
    /// Participant code, with the seed in front if several seeds have simulated participants with the same codes.
    pub participant: String,
    pub seed: u64,
    pub kind: ParticipantKind,
    /// Wall clock time at which the recording started; `None` for simulated trials.
    pub started: Option<String>,
    pub group: Option<String>,
    /// Number of the trial in the participant's series, from 1.
    pub period: Option<u32>,
    pub is_planned: bool,
    pub condition: Condition,
    pub study_arm: StudyArm,
    /// Study arm under which the trial counts: assigned by the plan or, without a plan, by the settings.
    pub planned_arm: StudyArm,
    pub aims: Option<StudyAims>,
    pub wizard_sees: WizardVisibility,
    /// Sender of the signals in a trial without a person as wizard.
    pub acting: SignalSenderWithParameter,
    /// Reason for excluding the trial from the analysis; `None` if the trial is included.
    pub left_out: Option<String>,
    /// Reason for which the trial ended; `None` if the recording is incomplete.
    pub ended: Option<TrialEndReason>,
    pub arm: ArmKind,
    pub robot: RobotEventSummary,
    pub human_presses: u64,
    pub robot_presses: u64,
    pub initiative_presses: u64,
    /// The assistant's model of the human: its name, and what differs from the named model.
    pub human_model: String,
    /// Number of the human's errors; races with the robot do not count as errors.
    pub errors: u64,
    pub races: u64,
    pub unproven: u64,
    /// Statistics of errors from false beliefs; `None` if the human's beliefs are unknown.
    pub beliefs: Option<FalseBeliefErrors>,
    pub orders: u64,
    pub order_s: Option<f64>,
    pub presses_per_order: Option<f64>,
    /// Summed regret of both agents' presses per served order; `None` if no order was served.
    pub additional_presses_per_order: Option<f64>,
    pub press_s: Option<f64>,
    pub signals: u64,
    /// Number of contents told by signals: 1 for a signal, k for a proposal of k presses.
    pub signal_contents: u64,
    /// Number of useful signals, judged by simulating the trial without each signal; `None` where that was not done.
    pub useful_signals: Option<u64>,
    /// How the participant's display showed the robot; `None` without a display.
    pub display_arm: Option<RobotDepiction>,
    /// Losses of the participant's display while the trial ran; `None` without a display.
    pub display_losses: Option<DisplayLosses>,
    pub offers: OfferSummary,
    /// Duration of the trial without pauses, in seconds.
    pub seconds: f64,
    pub answers: Vec<QuestionnaireAnswer>,
    /// Measures of the wizard's performance; `None` in trials without a wizard.
    pub wizard: Option<WizardMeasures>,
    pub wizard_saw_advice: bool,
    /// The two raters with their codes, if these codes or the raters' consensus determine the causes of errors.
    pub raters: Option<RaterPair>,
    pub shared_beliefs: Option<RaterFalseBeliefAgreement>,
    pub settled_by: Option<[String; 2]>,
    /// Why the raters' consensus is not used: a rater's code changed after the raters settled it.
    pub stale_consensus: Option<String>,
    /// Statistics of the trial's freeze probes; `None` without probes.
    pub probes: Option<ProbedTrialStatistics>,
}

/// How often the participant's display was lost while the trial's clock went, and for how long.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DisplayLosses {
    pub times: u64,
    pub seconds: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FalseBeliefErrors {
    pub basis: BeliefSource,
    pub errors: u64,
    pub of_two: u64,
    pub causes: BeliefErrorCounts,
    pub lengths: Vec<u32>,
    pub lengths_any_aspect: Vec<u32>,
    /// From the first error of each ended sequence to the first correct press after its last, in seconds.
    pub recovery_s: Vec<f64>,
    /// Number of false belief episodes with at least one error; `None` if beliefs are known from the estimate alone.
    pub episodes: Option<u64>,
}

/// An item of a questionnaire.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AskedItem {
    pub questionnaire: String,
    pub item: String,
    pub text: String,
    pub about: Option<String>,
    /// Whether agreement with the item's statement counts against the construct.
    pub reversed: bool,
    pub kind: QuestionnaireItemKind,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuestionnaireAnswer {
    #[serde(flatten)]
    pub asked: AskedItem,
    pub answer: Option<AnswerValue>,
    /// Number of points of the item's rating scale; `None` for other kinds of item.
    pub points: Option<u8>,
    pub options: Vec<ItemOption>,
    /// The answer on a scale or slider as a number from 0 to 1, reversed if the item is reverse coded.
    pub share: Option<f64>,
    /// Whether the item was asked before the first trial, rather than after this trial.
    pub before: bool,
    /// Score of the whole questionnaire on this occasion; `None` if the questionnaire has no score.
    pub score: Option<f64>,
}

impl TrialStatistics {
    pub fn counts(&self) -> bool {
        self.left_out.is_none()
    }

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

    pub fn sequence_length(&self) -> Option<f64> {
        mean_length(&self.beliefs.as_ref()?.lengths)
    }

    pub fn recovery_s(&self) -> Option<f64> {
        mean(self.beliefs.as_ref()?.recovery_s.iter().copied())
    }

    pub fn is_assisted(&self) -> bool {
        self.planned_arm != StudyArm::None
    }
}

/// Mean of the lengths of error sequences; `None` without sequences.
pub(crate) fn mean_length(lengths: &[u32]) -> Option<f64> {
    mean(lengths.iter().map(|&length| f64::from(length)))
}

/// Sets participant names, and periods where no study plan defines them, and sorts the trials by participant and
/// period. Without a plan, a live trial is the participant's first or second by wall clock, if exactly two of the
/// participant's trials count.
pub fn arrange(trials: &mut [TrialStatistics]) {
    // In simulated trials every seed uses the same participant codes.
    let simulated = trials.iter().filter(|trial| trial.started.is_none());
    let seeds: BTreeSet<u64> = simulated.map(|trial| trial.seed).collect();
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

/// An alias, since serde's derive borrows a field whose type is written as a reference.
pub type SignalSenderName = &'static str;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalSenderWithParameter {
    /// Name of the sender: `none`, `wizard` or `wizard+advice` (scripted wizard), or a concept.
    #[serde(deserialize_with = "actor")]
    pub concept: SignalSenderName,
    /// Parameter of the concept: cost of communication in presses (ToM-Com), threshold (ToM), or number of proposed
    /// presses (DEV); null for senders that are no concept.
    pub parameter: Option<f64>,
}

impl SignalSenderWithParameter {
    pub fn from_settings(arm: StudyArm, parameter: f64) -> SignalSenderWithParameter {
        let concept = arm.concept();
        SignalSenderWithParameter {
            concept: concept.map_or(arm.name(), ConceptName::name),
            parameter: concept.map(|_| parameter),
        }
    }

    /// Sort key of senders in tables: nobody first, then the wizard, then the concepts by parameter.
    pub(super) fn rank(&self) -> (usize, f64) {
        let rank = StudyArm::ALL.iter().position(|arm| arm.name() == self.concept).unwrap_or(StudyArm::ALL.len());
        (rank, self.parameter.unwrap_or(0.0))
    }
}

fn actor<'de, D: Deserializer<'de>>(input: D) -> Result<SignalSenderName, D::Error> {
    let name = String::deserialize(input)?;
    let arms = StudyArm::ALL.into_iter().map(StudyArm::name);
    let mut known = arms.chain(ConceptName::ALL.into_iter().map(ConceptName::name));
    known.find(|known| *known == name).ok_or_else(|| de::Error::custom(format!("the unknown sender \"{name}\"")))
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialDetails {
    pub offers: Vec<TimedOffer>,
    /// In wizard trials: the communications that were sent, and those that the assistant would have sent.
    pub lanes: Option<[Vec<CommunicationEvent>; 2]>,
    /// Unassisted trials with known beliefs: what each concept would have prevented.
    pub swept: Vec<ConceptPreventionCounts>,
    /// Freeze probes of the trial with their questions and answers; `None` without probes.
    pub probes: Option<ProbedTrial>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TrialTotals {
    pub actions: u64,
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    /// Number of the human's presses that the robot may have overtaken (races), which do not count as errors.
    pub races: u64,
    /// Number of the human's presses whose judgement rests on a cost to go that is not proven to be the least.
    pub unproven: u64,
    /// Errors of the human per press of both agents.
    pub error_rate: Option<f64>,
    /// Errors per press of the human.
    pub error_rate_human: Option<f64>,
    /// Source of the participants' beliefs; null if beliefs are unknown in any trial.
    pub beliefs_from: Option<BeliefSource>,
    /// Number of trials by the source from which the causes of their errors are known; of trials without errors only if
    /// no trial has any.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub belief_sources: BTreeMap<BeliefSource, u64>,
    pub belief_related_errors: Option<u64>,
    pub belief_related_by_kind: Option<BeliefErrorCounts>,
    /// Share of the errors that follow from false beliefs, from 0 to 1.
    pub belief_related_share: Option<f64>,
    pub belief_related_interval: Option<ConfidenceInterval>,
    pub sequences: Option<u64>,
    pub mean_sequence_length: Option<f64>,
    /// Sequences of errors from the same false belief, per 100 presses of the human.
    pub sequences_per_100: Option<f64>,
    /// Errors that follow from false beliefs, per 100 presses of the human.
    pub belief_related_per_100: Option<f64>,
    /// Number of error sequences, whichever false beliefs they follow from.
    pub sequences_any_aspect: Option<u64>,
    /// Mean number of errors in an error sequence, whichever false beliefs it follows from.
    pub mean_sequence_length_any_aspect: Option<f64>,
    /// Mean time from the first error of a sequence to the first correct press after its last error, in seconds.
    pub mean_recovery_s: Option<f64>,
    pub false_belief_episodes: Option<u64>,
    pub signals: u64,
    pub orders_served: u64,
}

impl TrialTotals {
    pub(super) fn from_trials(trials: &[&TrialStatistics]) -> TrialTotals {
        let sum = |of: fn(&TrialStatistics) -> u64| trials.iter().map(|trial| of(trial)).sum::<u64>();
        let (actions, human_actions, errors) =
            (sum(TrialStatistics::presses), sum(|trial| trial.human_presses), sum(|t| t.errors));
        let rate = |presses: u64| (presses > 0).then(|| errors as f64 / presses as f64);
        let totals = TrialTotals {
            actions,
            human_actions,
            robot_actions: sum(|trial| trial.robot_presses),
            errors,
            races: sum(|trial| trial.races),
            unproven: sum(|trial| trial.unproven),
            error_rate: rate(actions),
            error_rate_human: rate(human_actions),
            signals: sum(|trial| trial.signals),
            orders_served: sum(|trial| trial.orders),
            ..TrialTotals::default()
        };
        let beliefs: Option<Vec<&FalseBeliefErrors>> = trials.iter().map(|trial| trial.beliefs.as_ref()).collect();
        let Some(beliefs) = beliefs.filter(|beliefs| !beliefs.is_empty()) else { return totals };
        let related = beliefs.iter().map(|one| one.errors).sum::<u64>();
        let lengths: Vec<u32> = beliefs.iter().flat_map(|one| one.lengths.iter().copied()).collect();
        let any_aspect: Vec<u32> = beliefs.iter().flat_map(|one| one.lengths_any_aspect.iter().copied()).collect();
        let per_100 = |number: u64| (human_actions > 0).then(|| 100.0 * number as f64 / human_actions as f64);
        let interval = wilson(related as f64 / errors as f64, errors as f64, LEVEL);
        TrialTotals {
            beliefs_from: sources(trials).into_keys().max(),
            belief_sources: sources(trials),
            belief_related_errors: Some(related),
            belief_related_by_kind: Some(
                beliefs.iter().fold(BeliefErrorCounts::default(), |sum, one| sum.plus(one.causes)),
            ),
            belief_related_share: interval.map(|interval| interval.estimate),
            belief_related_interval: interval,
            sequences: Some(lengths.len() as u64),
            sequences_per_100: per_100(lengths.len() as u64),
            belief_related_per_100: per_100(related),
            mean_sequence_length: mean_length(&lengths),
            sequences_any_aspect: Some(any_aspect.len() as u64),
            mean_sequence_length_any_aspect: mean_length(&any_aspect),
            mean_recovery_s: mean(beliefs.iter().flat_map(|one| one.recovery_s.iter().copied())),
            false_belief_episodes: beliefs.iter().map(|one| one.episodes).sum(),
            ..totals
        }
    }
}

/// Trials by source. Those without errors count only if all are: there was nothing to find out.
fn sources(trials: &[&TrialStatistics]) -> BTreeMap<BeliefSource, u64> {
    let has_errors = trials.iter().any(|trial| trial.errors > 0 && trial.beliefs.is_some());
    let mut sources = BTreeMap::new();
    for trial in trials.iter().filter(|trial| trial.errors > 0 || !has_errors) {
        if let Some(beliefs) = &trial.beliefs {
            *sources.entry(beliefs.basis).or_default() += 1;
        }
    }
    sources
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WizardAssistantSimilarity {
    pub recording: String,
    pub wizard_saw_advice: bool,
    pub of_n: u64,
    pub with_n: u64,
    /// Number of communications of both senders with the same signal and target (matches).
    pub matched: u64,
    pub recall: Option<f64>,
}

#[derive(Clone, Debug, Default)]
pub struct DetailTotals {
    pub concepts: ConceptTotals,
    /// Of the trials for the comparison of concepts; of several, the least reliable one.
    pub concepts_beliefs_from: Option<BeliefSource>,
    /// Where the wizard saw no recommendations; `None` without such trials.
    pub without_advice: Option<MatchCounts>,
    pub with_advice: Option<MatchCounts>,
    pub similarity_by_trial: Vec<WizardAssistantSimilarity>,
    /// Where wizards send the signals; `None` without an offer.
    pub offers: Option<OfferTally>,
    pub probes: Vec<(String, ProbedTrial)>,
}

impl DetailTotals {
    /// In the order of [`arrange`]; a trial that the analysis does not count changes nothing.
    pub fn add(&mut self, trial: &TrialStatistics, details: TrialDetails) {
        if !trial.counts() {
            return;
        }
        let TrialDetails { offers, lanes, swept, probes } = details;
        if !swept.is_empty() {
            self.concepts.add(&trial.participant, &swept);
            let basis = trial.beliefs.as_ref().map(|beliefs| beliefs.basis);
            self.concepts_beliefs_from = self.concepts_beliefs_from.max(basis);
        }
        if let Some([of, with]) = &lanes {
            let all = if trial.wizard_saw_advice { &mut self.with_advice } else { &mut self.without_advice };
            let mut own = MatchCounts::default();
            for counts in [all.get_or_insert_default(), &mut own] {
                counts.add(of, with, trial.human_presses as u32, WINDOW);
            }
            let similarity = own.similarity();
            self.similarity_by_trial.push(WizardAssistantSimilarity {
                recording: trial.recording.clone(),
                wizard_saw_advice: trial.wizard_saw_advice,
                of_n: similarity.of_n,
                with_n: similarity.with_n,
                matched: similarity.matched,
                recall: similarity.signal.recall,
            });
        }
        if trial.condition == Condition::Wizard {
            offers.iter().for_each(|offer| self.offers.get_or_insert_default().add(offer));
        }
        self.probes.extend(probes.map(|probes| (trial.participant.clone(), probes)));
    }
}
