//! Sums of prevention counts over the unassisted trials of a study, for the comparison of communication concepts.
//!
//! The bootstrap needs the counts of every participant. Only the counts from which rates follow are kept for each
//! participant, so that a large study needs little memory.

use serde::{Deserialize, Serialize};

use super::prevention::PreventionCounts;
use tomcom_core::communication::concept::ConceptName;

/// Prevention counts of a concept with one parameter value in one unassisted trial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConceptPreventionCounts {
    /// Communication concept that would have sent the signals.
    pub concept: ConceptName,
    /// Value of the concept's parameter, such as the cost of communication.
    pub parameter: f64,
    /// Errors that the concept would have prevented, and signals that the concept would have sent.
    pub count: PreventionCounts,
}

/// Counts from which the rates of a concept with one parameter value follow, over the trials of one participant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct RateCounts {
    presses: u32,
    signals: u32,
    related: u32,
    prevented: u32,
    useless: u32,
}

impl RateCounts {
    fn add(&mut self, count: &PreventionCounts) {
        let counts = [
            (&mut self.presses, count.presses),
            (&mut self.signals, count.signals),
            (&mut self.related, count.related),
            (&mut self.prevented, count.prevented),
            (&mut self.useless, count.useless),
        ];
        for (sum, one) in counts {
            *sum = sum.saturating_add(u32::try_from(one).unwrap_or(u32::MAX));
        }
    }

    /// The counts of `times` copies of the participant; counts that are not in the rates are 0.
    fn repeated(&self, times: u32) -> PreventionCounts {
        let all = |count: u32| u64::from(count) * u64::from(times);
        PreventionCounts {
            presses: all(self.presses),
            signals: all(self.signals),
            related: all(self.related),
            prevented: all(self.prevented),
            useless: all(self.useless),
            ..PreventionCounts::default()
        }
    }
}

/// Prevention counts of every concept and parameter value, over all unassisted trials and for each participant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConceptTotals {
    trials: u64,
    sum: Vec<ConceptPreventionCounts>,
    /// For each participant, the counts in the order of `sum`.
    participants: Vec<Vec<RateCounts>>,
    /// Code of the participant whose trials were added last.
    last: Option<String>,
}

impl ConceptTotals {
    /// Adds the counts of an unassisted trial of this participant, for the same concepts and parameter values in every
    /// trial. The trials of a participant must be added one after another.
    pub fn add(&mut self, participant: &str, swept: &[ConceptPreventionCounts]) {
        if self.sum.is_empty() {
            self.sum = emptied(swept);
        }
        if self.last.as_deref() != Some(participant) {
            self.last = Some(participant.to_string());
            self.participants.push(vec![RateCounts::default(); self.sum.len()]);
        }
        self.trials += 1;
        for (sum, one) in self.sum.iter_mut().zip(swept) {
            sum.count = sum.count.plus(&one.count);
        }
        let of_one = self.participants.last_mut().into_iter().flatten();
        of_one.zip(swept).for_each(|(sum, one)| sum.add(&one.count));
    }

    /// Number of unassisted trials.
    pub fn trials(&self) -> u64 {
        self.trials
    }

    /// Number of participants with unassisted trials.
    pub fn participants(&self) -> usize {
        self.participants.len()
    }

    /// Sum over all trials for every concept and parameter value; empty without trials.
    pub fn sum(&self) -> &[ConceptPreventionCounts] {
        &self.sum
    }

    /// Sum over participants, each of whom counts as often as `times` says; only counts that are in the rates are
    /// summed.
    pub fn resampled(&self, times: &[u32]) -> Vec<ConceptPreventionCounts> {
        let mut sum = emptied(&self.sum);
        for (participant, &times) in self.participants.iter().zip(times) {
            for (sum, one) in sum.iter_mut().zip(participant) {
                sum.count = sum.count.plus(&one.repeated(times));
            }
        }
        sum
    }
}

/// The same concepts and parameter values, with counts of 0.
fn emptied(counts: &[ConceptPreventionCounts]) -> Vec<ConceptPreventionCounts> {
    counts.iter().map(|one| ConceptPreventionCounts { count: PreventionCounts::default(), ..*one }).collect()
}
