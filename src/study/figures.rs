//! Summary of a study: the statistics that `tomcom study` prints and that the report shows.

use std::collections::BTreeMap;

use serde::Serialize;

use super::acceptance::{Acceptance, ItemSummary, ScoreSummary, acceptance, items, scores};
use super::arm_analysis::{ArmAnalysis, ArmDeviation, StudyConditionSummary};
use super::arm_comparison::StudyArmComparison;
use super::arm_group::{RobotArmTotals, by_arm};
use super::detail_totals::{DetailTotals, WizardAssistantSimilarity};
use super::effect::AssistanceEffect;
use super::facts::RecordingFacts;
use super::known_beliefs::RaterFalseBeliefAgreement;
use super::live_arms::{SignalSenderResults, live_arms};
use super::missing_trials::MissingTrials;
use super::planned_trial::RecordingCopy;
use super::preregistration::PreregistrationCheck;
use super::roc::{ConceptRocCurve, compare};
use super::statistics::{Correlation, FTest};
use super::tables::tutorial_answers::TutorialQuestionRow;
use super::trial_statistics::TrialStatistics;
use super::trial_totals::TrialTotals;
use super::tutorial_summary::TutorialSummary;
use crate::analysis::offer_summary::OfferSummary;
use crate::analysis::probe_figures::ProbeSummary;
use tomcom_core::base::text::count;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::raters::{AgreementTable, RaterAgreement};
use tomcom_core::measures::matching::{MatchCounts, Similarity};
use tomcom_core::measures::raters::RaterPair;
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::header::CodeCorrection;
use tomcom_session::event::TrialEndReason;
use tomcom_session::settings::ParticipantKind;

/// Seed of random permutations and bootstrap resamples; fixed, so that the same recordings give the same statistics.
const SEED: u64 = 1;

/// Summary of a study, as `tomcom study` prints it. Unknown values are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudySummary {
    /// Title of the study report.
    pub title: String,
    /// Whether any participant was simulated.
    pub simulated_participants: bool,
    /// Number of trials that the analysis counts.
    pub trials: u64,
    /// Number of participants with at least one trial in the analysis.
    pub participants: u64,
    /// Sums and means over all trials in the analysis.
    #[serde(flatten)]
    pub totals: TrialTotals,
    /// Number of trials by the assistant's model of the human: its name, and what differs from the named model.
    pub human_models: BTreeMap<String, u64>,
    /// Number of trials by the reason why they ended.
    pub ended: BTreeMap<TrialEndReason, u64>,
    /// Counts of robot events, by kind of robot arm.
    pub robot: Vec<RobotArmTotals>,
    /// Agreement of the study with its frozen (preregistered) plan; absent if no frozen plan was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preregistration: Option<PreregistrationCheck>,
    /// Trials of the plan without a recording, of participants up to the last with a recording; absent if there are
    /// none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub missing_trials: Vec<MissingTrials>,
    /// Recordings whose participant's code was corrected afterwards; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub corrections: Vec<CorrectedRecording>,
    /// Recordings that are copies of others, and are not counted; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub copies: Vec<RecordingCopy>,
    /// Summary of the trials in each condition.
    pub conditions: Vec<StudyConditionSummary>,
    /// Effect of assistance on errors per human press: the interaction of period and starting group.
    pub anova: Option<FTest>,
    /// Correlation of the starting group with the improvement in errors per press of the human.
    pub pearson: Option<Correlation>,
    /// Two-sided p value of a permutation test that compares the improvement in errors between the starting groups.
    pub permutation_p: Option<f64>,
    /// Effects of assistance on all compared measures, starting with errors per press.
    pub effects: Vec<AssistanceEffect>,
    /// Comparison of the study arms by the plan's primary outcome; null unless participants have trials in different
    /// arms.
    pub arms: Option<StudyArmComparison>,
    /// Trials that were carried out in another arm than the planned one, under which they count; absent if there are
    /// none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deviations: Vec<ArmDeviation>,
    /// The same analysis with each trial in the arm in which it was carried out; absent without deviations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_carried_out: Option<ArmAnalysis>,
    /// The receiver operating characteristic (ROC) of each communication concept.
    pub roc: Vec<ConceptRocCurve>,
    /// Results of concepts that sent signals by themselves in the same simulated trials; empty unless several arms
    /// share trials.
    pub live: Vec<SignalSenderResults>,
    /// Source of what participants believed in the trials for the comparison of concepts; of several sources, the least
    /// reliable one.
    pub roc_beliefs_from: Option<BeliefSource>,
    /// Number of participants in the comparison of concepts.
    pub roc_participants: u64,
    /// Number of unassisted trials in the comparison of concepts.
    pub roc_trials: u64,
    /// Largest false positive rate that all compared concepts reach.
    pub roc_common_fpr: Option<f64>,
    /// Similarity of the wizard's signals (first lane) and the signals that the assistant would have sent, over trials
    /// in which the wizard did not see the assistant's recommendations; null without such trials.
    pub similarity: Option<Similarity>,
    /// Similarity over trials in which the wizard saw the assistant's recommendations, which are not part of
    /// `similarity`; null without such trials.
    pub similarity_with_advice: Option<Similarity>,
    /// Similarity of wizard and assistant in each trial.
    pub similarity_by_trial: Vec<WizardAssistantSimilarity>,
    /// Performance of the wizards, over all trials with a wizard.
    pub wizard: Option<WizardMeasures>,
    /// Source of what participants believed in the trials with a wizard; of several sources, the least reliable one.
    /// Null where `wizard` has no hits.
    pub wizard_beliefs_from: Option<BeliefSource>,
    /// Offers that wizards could see in trials in which they could send signals; null without such offers.
    pub offers: Option<OfferSummary>,
    /// Acceptance of the assistance by participants.
    pub acceptance: Option<Acceptance>,
    /// Answers to questionnaires, by item and condition.
    pub questionnaires: Vec<ItemSummary>,
    /// Scores of the questionnaires that define a score, by condition.
    pub questionnaire_scores: Vec<ScoreSummary>,
    /// Answers to the questions of tutorials; absent if no question was answered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tutorial: Option<TutorialSummary>,
    /// Results of freeze probes: what participants knew, and the accuracy of the estimate; absent without answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probes: Option<ProbeSummary>,
    /// Agreement of two raters, where causes of errors are known from their codes.
    pub raters: Option<RaterAgreement>,
    /// Number of trials by the pair of raters ("R1+R2") whose codes or consensus determine the causes of errors; absent
    /// without raters.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub rater_pairs: BTreeMap<String, u64>,
    /// Trials in which both raters gave the same codes to all errors; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub identical_codes: Vec<IdenticalCodes>,
    /// Agreement of the two raters about the false beliefs from which episodes follow.
    pub shared_beliefs: Option<RaterFalseBeliefAgreement>,
    /// Number of trials whose causes of errors are the consensus of two raters, by pair of raters ("R1+R2").
    pub consensus: BTreeMap<String, u64>,
    /// Consensus codes of two raters that are ignored, since a rater changed a code afterwards.
    pub stale_consensus: Vec<StaleConsensus>,
    /// Trials that are excluded from the analysis, each with the reason.
    pub left_out: Vec<ExcludedTrial>,
    /// Number of practice recordings (familiarisations), which are not analysed as trials.
    pub practice: u64,
}

/// A recording whose participant's code was corrected after it was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrectedRecording {
    /// The recording's name in tables.
    pub recording: String,
    /// The correction of the participant's code.
    #[serde(flatten)]
    pub correction: CodeCorrection,
}

impl CorrectedRecording {
    /// The corrected recording in words.
    pub fn in_words(&self) -> String {
        format!("code of the participant corrected: {}: {}", self.recording, self.correction.in_words())
    }
}

/// A trial in which two raters gave the same codes to all errors: perhaps one file with codes is a copy of the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct IdenticalCodes {
    /// The recording's name in tables.
    pub recording: String,
    /// The two raters: "R1+R2".
    pub raters: String,
    /// Number of errors that both coded alike.
    pub errors: u64,
}

impl IdenticalCodes {
    /// The warning of identical codes in words.
    pub fn in_words(&self) -> String {
        let raters = self.raters.replace('+', " and ");
        format!(
            "{raters} gave the same codes to all {} errors of {}: make sure that one is no copy of the other",
            self.errors, self.recording
        )
    }
}

/// A consensus of two raters that no longer holds, since one of them changed a code.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaleConsensus {
    /// Folder of the recording.
    pub recording: String,
    /// Which rater's code changed, in words.
    pub reason: String,
}

/// A trial that is excluded from the analysis, with the reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExcludedTrial {
    /// Folder of the excluded trial's recording.
    pub recording: String,
    /// The participant's code.
    pub participant: String,
    /// Reason for excluding the trial.
    pub reason: String,
}

impl StudySummary {
    /// Summarises the trials of a study, which must be ordered by participant, with the sums over their details.
    pub fn from_trials(
        trials: &[TrialStatistics],
        details: DetailTotals,
        facts: &RecordingFacts,
        practice: u64,
    ) -> StudySummary {
        let counting: Vec<&TrialStatistics> = trials.iter().filter(|trial| trial.counts()).collect();
        let simulated_participants = trials.iter().any(|trial| trial.kind == ParticipantKind::Simulated);
        let ArmAnalysis { conditions, effects, arms } = ArmAnalysis::from_trials(trials, SEED);
        let deviations: Vec<ArmDeviation> =
            counting.iter().filter_map(|trial| ArmDeviation::from_trial(trial)).collect();
        let comparison = compare(&details.concepts, SEED);
        let mut participants: Vec<&str> = counting.iter().map(|trial| trial.participant.as_str()).collect();
        participants.dedup();
        let wizards: Vec<&WizardMeasures> = counting.iter().filter_map(|trial| trial.wizard.as_ref()).collect();
        let wizard = (!wizards.is_empty()).then(|| WizardMeasures::sum(wizards));
        let left_out = trials.iter().filter_map(|trial| {
            let (recording, participant) = (trial.recording.clone(), trial.participant.clone());
            Some(ExcludedTrial { recording, participant, reason: trial.left_out.clone()? })
        });
        StudySummary {
            title: title(facts, trials, simulated_participants),
            simulated_participants,
            trials: counting.len() as u64,
            participants: participants.len() as u64,
            totals: TrialTotals::from_trials(&counting),
            human_models: human_models(&counting),
            ended: ended(&counting),
            robot: by_arm(&counting),
            preregistration: None,
            missing_trials: Vec::new(),
            copies: Vec::new(),
            corrections: Vec::new(),
            conditions,
            anova: effects[0].assistance(),
            pearson: effects[0].pearson,
            permutation_p: effects[0].permutation_p,
            effects,
            arms,
            as_carried_out: (!deviations.is_empty()).then(|| ArmAnalysis::as_carried_out(trials, SEED)),
            deviations,
            live: live_arms(&counting, &comparison.concepts),
            roc: comparison.concepts,
            roc_beliefs_from: details.concepts_beliefs_from,
            roc_participants: comparison.participants,
            roc_trials: comparison.trials,
            roc_common_fpr: comparison.common_fpr,
            similarity: details.without_advice.as_ref().map(MatchCounts::similarity),
            similarity_with_advice: details.with_advice.as_ref().map(MatchCounts::similarity),
            similarity_by_trial: details.similarity_by_trial,
            wizard_beliefs_from: wizard
                .as_ref()
                .and_then(|wizard| wizard.hits)
                .and_then(|_| least_reliable(counting.iter().filter(|trial| trial.wizard.is_some()))),
            wizard,
            offers: (!details.offers.is_empty()).then(|| details.offers.summary()),
            acceptance: acceptance(&counting),
            questionnaires: items(&counting),
            questionnaire_scores: scores(&counting),
            tutorial: None,
            probes: ProbeSummary::from_trials(details.probes.iter().map(|(code, probes)| (code.as_str(), probes))),
            raters: agreement(&counting),
            shared_beliefs: counting.iter().filter_map(|trial| trial.shared_beliefs).reduce(|sum, one| sum.plus(one)),
            rater_pairs: rater_pairs(&counting),
            identical_codes: counting.iter().filter_map(|trial| identical_codes(trial)).collect(),
            consensus: consensus(&counting),
            stale_consensus: counting.iter().filter_map(|trial| stale(trial)).collect(),
            left_out: left_out.collect(),
            practice,
        }
    }

    /// Adds the study's agreement with its frozen plan, if a frozen plan was given.
    pub fn with_preregistration(self, preregistration: Option<PreregistrationCheck>) -> StudySummary {
        StudySummary { preregistration, ..self }
    }

    /// Adds the trials of the plan that have no recording.
    pub fn with_missing_trials(self, missing_trials: Vec<MissingTrials>) -> StudySummary {
        StudySummary { missing_trials, ..self }
    }

    /// The summary with the recordings whose participant's code was corrected.
    pub fn with_corrections(self, corrections: Vec<CorrectedRecording>) -> StudySummary {
        StudySummary { corrections, ..self }
    }

    /// The summary with the recordings that were left out, since they are copies of others.
    pub fn with_copies(self, copies: Vec<RecordingCopy>) -> StudySummary {
        StudySummary { copies, ..self }
    }

    /// Adds the answers to the questions of tutorials, which must be ordered by participant.
    pub fn with_tutorials(self, answers: &[TutorialQuestionRow]) -> StudySummary {
        StudySummary { tutorial: TutorialSummary::from_answers(answers), ..self }
    }
}

fn human_models(trials: &[&TrialStatistics]) -> BTreeMap<String, u64> {
    let mut models = BTreeMap::new();
    trials.iter().for_each(|trial| *models.entry(trial.human_model.clone()).or_default() += 1);
    models
}

/// Number of trials by the reason why they ended.
fn ended(trials: &[&TrialStatistics]) -> BTreeMap<TrialEndReason, u64> {
    let mut ended = BTreeMap::new();
    trials.iter().filter_map(|trial| trial.ended).for_each(|reason| *ended.entry(reason).or_default() += 1);
    ended
}

/// The least reliable source of participants' beliefs among these trials.
fn least_reliable<'a>(trials: impl Iterator<Item = &'a &'a TrialStatistics>) -> Option<BeliefSource> {
    trials.filter_map(|trial| trial.beliefs.as_ref()).map(|beliefs| beliefs.basis).max()
}

fn title(facts: &RecordingFacts, trials: &[TrialStatistics], simulated: bool) -> String {
    let kitchen = facts.all("kitchen").unwrap_or_else(|| "No kitchen".to_string());
    let people = trials.iter().any(|trial| trial.kind != ParticipantKind::Simulated);
    match (simulated, people) {
        (true, false) => format!("{kitchen}: a study of simulated participants"),
        (true, true) => format!("{kitchen}: a study of people and simulated participants"),
        (false, _) => format!("{kitchen}: a study"),
    }
}

/// Number of trials that use the consensus of two raters, by pair of raters.
fn consensus(trials: &[&TrialStatistics]) -> BTreeMap<String, u64> {
    let mut settled = BTreeMap::new();
    for raters in trials.iter().filter_map(|trial| trial.settled_by.as_ref()) {
        *settled.entry(raters.join("+")).or_default() += 1;
    }
    settled
}

/// Pairs of raters in words: "R1 and R2", with their numbers of trials if there are several pairs.
pub fn pairs_in_words(pairs: &BTreeMap<String, u64>) -> String {
    let word = |(pair, trials): (&String, &u64)| match pairs.len() {
        1 => pair.replace('+', " and "),
        _ => format!("{} in {}", pair.replace('+', " and "), count(*trials, "trial", "trials")),
    };
    pairs.iter().map(word).collect::<Vec<String>>().join("; ")
}

fn stale(trial: &TrialStatistics) -> Option<StaleConsensus> {
    let reason = trial.stale_consensus.clone()?;
    Some(StaleConsensus { recording: trial.recording.clone(), reason })
}

/// Number of trials by the pair of raters whose codes or consensus determine the causes of errors.
fn rater_pairs(trials: &[&TrialStatistics]) -> BTreeMap<String, u64> {
    let mut pairs = BTreeMap::new();
    for pair in trials.iter().filter_map(|trial| trial.raters.as_ref()) {
        *pairs.entry(pair.name()).or_default() += 1;
    }
    pairs
}

fn identical_codes(trial: &TrialStatistics) -> Option<IdenticalCodes> {
    let pair = trial.raters.as_ref().filter(|pair| pair.is_identical(trial.errors as usize))?;
    Some(IdenticalCodes { recording: trial.recording.clone(), raters: pair.name(), errors: trial.errors })
}

/// Agreement of the raters' codes over all trials.
fn agreement(trials: &[&TrialStatistics]) -> Option<RaterAgreement> {
    let mut table = AgreementTable::default();
    let coded: Vec<&RaterPair> = trials.iter().filter_map(|trial| trial.raters.as_ref()).collect();
    coded.iter().for_each(|pair| table.add(&pair.codes[0], &pair.codes[1]));
    (!coded.is_empty()).then(|| table.agreement())
}
