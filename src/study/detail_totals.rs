//! Sums over the details of a study's trials, which are read one trial after another.

use serde::Serialize;

use super::concept_totals::ConceptTotals;
use super::trial_details::TrialDetails;
use super::trial_statistics::TrialStatistics;
use crate::analysis::offer_summary::OfferTally;
use crate::analysis::probe_record::ProbedTrial;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::matching::{MatchCounts, Similarity, WINDOW};
use tomcom_session::settings::Condition;

/// Similarity of wizard and assistant in one trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WizardAssistantSimilarity {
    /// Folder of the trial's recording.
    pub recording: String,
    /// Whether the wizard saw the assistant's recommendations.
    pub wizard_saw_advice: bool,
    /// Number of signals that the wizard sent in the trial.
    pub of_n: u64,
    /// Number of communications that the assistant would have sent in the trial.
    pub with_n: u64,
    /// Number of communications of both senders with the same signal and target (matches).
    pub matched: u64,
    /// The share of the wizard's signals that have a match.
    pub recall: Option<f64>,
}

/// Sums over the details of the trials that the analysis counts.
#[derive(Clone, Debug, Default)]
pub struct DetailTotals {
    /// What concepts would have prevented in unassisted trials.
    pub concepts: ConceptTotals,
    /// Source of what participants believed in the trials for the comparison of concepts; of several sources, the least
    /// reliable one.
    pub concepts_beliefs_from: Option<BeliefSource>,
    /// Matches of the wizard's signals with those of the assistant, in trials in which the wizard saw no
    /// recommendations; `None` without such trials.
    pub without_advice: Option<MatchCounts>,
    /// The same matches, in trials in which the wizard saw recommendations.
    pub with_advice: Option<MatchCounts>,
    /// Similarity of wizard and assistant in each trial.
    pub similarity_by_trial: Vec<WizardAssistantSimilarity>,
    /// Offers in trials in which the wizard could send signals.
    pub offers: OfferTally,
    /// Freeze probes of each trial, with the participant's code.
    pub probes: Vec<(String, ProbedTrial)>,
}

impl DetailTotals {
    /// Adds the details of a trial. Trials must be added in the order of [`super::trial_statistics::arrange`]; a trial
    /// that the analysis does not count changes nothing.
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
            self.similarity_by_trial.push(of_trial(trial, &own.similarity()));
        }
        if trial.condition == Condition::Wizard {
            offers.iter().for_each(|offer| self.offers.add(offer));
        }
        self.probes.extend(probes.map(|probes| (trial.participant.clone(), probes)));
    }
}

fn of_trial(trial: &TrialStatistics, similarity: &Similarity) -> WizardAssistantSimilarity {
    WizardAssistantSimilarity {
        recording: trial.recording.clone(),
        wizard_saw_advice: trial.wizard_saw_advice,
        of_n: similarity.of_n,
        with_n: similarity.with_n,
        matched: similarity.matched,
        recall: similarity.signal.recall,
    }
}
