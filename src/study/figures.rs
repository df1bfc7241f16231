//! Summary of a study: the statistics that `tomcom study` prints and that the report shows.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::acceptance::{Acceptance, ItemSummary, ScoreSummary, acceptance, answers_that_count, items, scores};
use crate::analysis::offer_summary::{OfferSummary, OfferTally};
use crate::analysis::probe_figures::ProbeSummary;
use crate::arm_comparison::{ArmAnalysis, ArmDeviation, StudyArmComparison, StudyConditionSummary};
use crate::effect::AssistanceEffect;
use crate::facts::RecordingFacts;
use crate::frozen_plan::PreregistrationCheck;
use crate::live_arms::{SignalSenderResults, live_arms};
use crate::pass::reading::WaivedPractice;
use crate::planned_trial::{ForeignRecording, MissingTrials, RecordingCopy};
use crate::rater_episodes::RaterFalseBeliefAgreement;
use crate::robot_tally::{RobotArmTotals, by_arm};
use crate::roc::{ConceptRocCurve, compare};
use crate::statistics::{Correlation, FTest};
use crate::tables::participants::TutorialSummary;
use crate::trial_statistics::{DetailTotals, TrialStatistics, TrialTotals, WizardAssistantSimilarity};
use tomcom_core::base::text::count;
use tomcom_core::measures::matching::{MatchCounts, Similarity};
use tomcom_core::measures::raters::{AgreementTable, BeliefSource, RaterAgreement, RaterPair};
use tomcom_core::measures::wizard_performance::WizardMeasures;
use tomcom_session::event::TrialEndReason;
use tomcom_session::header::CodeCorrection;
use tomcom_session::plan::PrimaryOutcome;
use tomcom_session::settings::ParticipantKind;

/// Seed of random permutations and bootstrap resamples; fixed, so that the same recordings give the same statistics.
const SEED: u64 = 1;

/// Summary of a study, as `tomcom study` prints it. Unknown values are null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StudySummary {
    pub title: String,
    pub simulated_participants: bool,
    pub trials: u64,
    pub participants: u64,
    #[serde(flatten)]
    pub totals: TrialTotals,
    /// Number of trials by the assistant's model of the human: its name, and what differs from the named model.
    pub human_models: BTreeMap<String, u64>,
    pub ended: BTreeMap<TrialEndReason, u64>,
    pub robot: Vec<RobotArmTotals>,
    /// Agreement of the study with its frozen (preregistered) plan; absent if no frozen plan was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preregistration: Option<PreregistrationCheck>,
    /// Of participants up to the last with a recording; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub missing_trials: Vec<MissingTrials>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub corrections: Vec<CorrectedRecording>,
    /// Of participants whose codes were corrected: conditions of trials that are not those of the plan, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_orders: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub copies: Vec<RecordingCopy>,
    /// Recordings beside those of the study that are not analysed; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub foreign: Vec<ForeignRecording>,
    pub conditions: Vec<StudyConditionSummary>,
    pub primary_outcome: PrimaryOutcome,
    /// Effect of assistance on errors per human press: the interaction of period and starting group.
    pub anova: Option<FTest>,
    pub pearson: Option<Correlation>,
    pub permutation_p: Option<f64>,
    pub effects: Vec<AssistanceEffect>,
    /// By the plan's primary outcome; null unless participants have trials in different arms.
    pub arms: Option<StudyArmComparison>,
    /// Trials that count under another arm than they were carried out in; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub deviations: Vec<ArmDeviation>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_carried_out: Option<ArmAnalysis>,
    pub roc: Vec<ConceptRocCurve>,
    /// Of concepts that sent signals by themselves in the same simulated trials; empty unless arms share trials.
    pub live: Vec<SignalSenderResults>,
    /// Of the trials for the comparison of concepts; of several sources, the least reliable one.
    pub roc_beliefs_from: Option<BeliefSource>,
    pub roc_participants: u64,
    pub roc_trials: u64,
    /// Largest false positive rate that all compared concepts reach.
    pub roc_common_fpr: Option<f64>,
    /// Similarity of the wizard's signals (first lane) and the signals that the assistant would have sent, over trials
    /// in which the wizard did not see the assistant's recommendations; null without such trials.
    pub similarity: Option<Similarity>,
    /// Where the wizard saw recommendations; not part of `similarity`; null without such trials.
    pub similarity_with_advice: Option<Similarity>,
    pub similarity_by_trial: Vec<WizardAssistantSimilarity>,
    pub wizard: Option<WizardMeasures>,
    /// Of the trials with a wizard; of several, the least reliable. Null where `wizard` has no hits.
    pub wizard_beliefs_from: Option<BeliefSource>,
    /// Offers that wizards could see in trials in which they could send signals; null without such offers.
    pub offers: Option<OfferSummary>,
    pub acceptance: Option<Acceptance>,
    pub questionnaires: Vec<ItemSummary>,
    pub questionnaire_scores: Vec<ScoreSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tutorial: Option<TutorialSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probes: Option<ProbeSummary>,
    pub raters: Option<RaterAgreement>,
    /// Trials by the raters ("R1+R2") whose codes or consensus determine the causes of errors.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub rater_pairs: BTreeMap<String, u64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub identical_codes: Vec<IdenticalCodes>,
    /// Recordings of simulated participants whose errors raters coded, by name; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unused_codes: Option<String>,
    pub shared_beliefs: Option<RaterFalseBeliefAgreement>,
    /// Number of trials whose causes of errors are the consensus of two raters, by pair of raters ("R1+R2").
    pub consensus: BTreeMap<String, u64>,
    /// Consensus codes of two raters that are ignored, since a rater changed a code afterwards.
    pub stale_consensus: Vec<StaleConsensus>,
    pub left_out: Vec<ExcludedTrial>,
    pub practice: u64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub waived: Vec<WaivedPractice>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CorrectedRecording {
    pub recording: String,
    #[serde(flatten)]
    pub correction: CodeCorrection,
}

impl CorrectedRecording {
    pub fn in_words(&self) -> String {
        format!("code of the participant corrected: {}: {}", self.recording, self.correction.in_words())
    }
}

/// A trial in which two raters gave the same codes to all errors: perhaps one file with codes is a copy of the other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct IdenticalCodes {
    pub recording: String,
    pub raters: String,
    pub errors: u64,
}

impl IdenticalCodes {
    pub fn in_words(&self) -> String {
        let raters = self.raters.replace('+', " and ");
        format!(
            "{raters} gave the same codes to all {} errors of {}: make sure that one is no copy of the other",
            self.errors, self.recording
        )
    }
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StaleConsensus {
    pub recording: String,
    pub reason: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExcludedTrial {
    pub recording: String,
    pub participant: String,
    pub reason: String,
}

impl StudySummary {
    /// Summarises the trials of a study, which must be ordered by participant, with the sums over their details. What does
    /// not follow from trials (frozen plan, missing trials, copies, corrections, tutorials) is left empty.
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
        let stale = counting.iter().filter_map(|trial| {
            let reason = trial.stale_consensus.clone()?;
            Some(StaleConsensus { recording: trial.recording.clone(), reason })
        });
        StudySummary {
            title: title(facts, simulated_participants),
            simulated_participants,
            trials: counting.len() as u64,
            participants: participants.len() as u64,
            totals: TrialTotals::from_trials(&counting),
            human_models: counts(counting.iter().map(|trial| trial.human_model.clone())),
            ended: counts(counting.iter().filter_map(|trial| trial.ended)),
            robot: by_arm(&counting),
            preregistration: None,
            missing_trials: Vec::new(),
            other_orders: Vec::new(),
            copies: Vec::new(),
            foreign: Vec::new(),
            corrections: Vec::new(),
            conditions,
            primary_outcome: counting.iter().find_map(|trial| trial.aims).unwrap_or_default().outcome,
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
            offers: details.offers.map(OfferTally::summary),
            acceptance: acceptance(&counting),
            questionnaires: items(&answers_that_count(trials)),
            questionnaire_scores: scores(&answers_that_count(trials)),
            tutorial: None,
            probes: ProbeSummary::from_trials(details.probes.iter().map(|(code, probes)| (code.as_str(), probes))),
            raters: agreement(&counting),
            unused_codes: facts.all(RecordingFacts::UNUSED_CODES),
            shared_beliefs: counting.iter().filter_map(|trial| trial.shared_beliefs).reduce(|sum, one| sum.plus(one)),
            rater_pairs: counts(counting.iter().filter_map(|trial| Some(trial.raters.as_ref()?.name()))),
            identical_codes: counting.iter().filter_map(|trial| identical_codes(trial)).collect(),
            consensus: counts(counting.iter().filter_map(|trial| Some(trial.settled_by.as_ref()?.join("+")))),
            stale_consensus: stale.collect(),
            left_out: left_out.collect(),
            practice,
            waived: Vec::new(),
        }
    }
}

fn counts<K: Ord>(all: impl Iterator<Item = K>) -> BTreeMap<K, u64> {
    let mut counts = BTreeMap::new();
    all.for_each(|one| *counts.entry(one).or_default() += 1);
    counts
}

fn least_reliable<'a>(trials: impl Iterator<Item = &'a &'a TrialStatistics>) -> Option<BeliefSource> {
    trials.filter_map(|trial| trial.beliefs.as_ref()).map(|beliefs| beliefs.basis).max()
}

fn title(facts: &RecordingFacts, simulated: bool) -> String {
    let of = if simulated { " of simulated participants" } else { "" };
    match facts.all("kitchen") {
        Some(kitchen) => format!("{kitchen}: a study{of}"),
        None => format!("A study{of}"),
    }
}

/// Pairs of raters in words: "R1 and R2", with their numbers of trials if there are several pairs.
pub(crate) fn pairs_in_words(pairs: &BTreeMap<String, u64>) -> String {
    let word = |(pair, trials): (&String, &u64)| match pairs.len() {
        1 => pair.replace('+', " and "),
        _ => format!("{} in {}", pair.replace('+', " and "), count(*trials, "trial", "trials")),
    };
    pairs.iter().map(word).collect::<Vec<String>>().join("; ")
}

fn identical_codes(trial: &TrialStatistics) -> Option<IdenticalCodes> {
    let pair = trial.raters.as_ref().filter(|pair| pair.is_identical(trial.errors as usize))?;
    Some(IdenticalCodes { recording: trial.recording.clone(), raters: pair.name(), errors: trial.errors })
}

fn agreement(trials: &[&TrialStatistics]) -> Option<RaterAgreement> {
    let mut table = AgreementTable::default();
    let coded: Vec<&RaterPair> = trials.iter().filter_map(|trial| trial.raters.as_ref()).collect();
    coded.iter().for_each(|pair| table.add(&pair.codes[0], &pair.codes[1]));
    (!coded.is_empty()).then(|| table.agreement())
}
