//! Trials of a study plan, for each of which one recording counts; and copies of recordings, which do not count.

use serde::{Deserialize, Serialize};

use super::preregistration::RecordedPlan;
use crate::base::words::count;

/// A counted trial of a participant in a study plan.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlannedTrialKey {
    plan: String,
    /// The participant's code, with the seed in front if the participant is simulated.
    participant: String,
    /// Number of the trial, from 1.
    period: u32,
}

impl PlannedTrialKey {
    /// The trial of a recording with this place in a plan; `None` for practice, and for a recording without a plan.
    /// `seed`: that of a simulated participant, since every seed simulates other people.
    pub fn new(recorded: &RecordedPlan, seed: Option<u64>) -> Option<PlannedTrialKey> {
        let (plan, _) = recorded.plan.clone()?;
        let period = recorded.place?.period?;
        let code = &recorded.participant;
        let participant = seed.map_or_else(|| code.clone(), |seed| format!("seed{seed}-{code}"));
        Some(PlannedTrialKey { plan, participant, period })
    }

    /// What is wrong about a second recording that counts for this trial, where `first` is the other recording; and
    /// what would be right.
    pub fn counted_twice(&self, first: &str) -> (String, String) {
        let PlannedTrialKey { plan, participant, period } = self;
        let found = format!(
            "a second recording of trial {period} of {participant} in the plan \"{plan}\", which {first} is a recording of, too"
        );
        let remedy = "one recording that counts for each trial: leave the other out (tomcom exclude RECORDING --reason …), \
                      or correct a code that was typed wrong (tomcom correct RECORDING --code CODE --why …)";
        (found, remedy.to_string())
    }
}

/// A recording whose log equals that of another one to the last byte, so that it does not count.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingCopy {
    /// The recording that does not count.
    pub recording: String,
    /// The recording that counts.
    pub copy_of: String,
}

/// Copies of recordings in words; `None` if there are none.
pub fn copies_in_words(copies: &[RecordingCopy]) -> Option<String> {
    let named: Vec<String> = copies.iter().map(|one| format!("{} of {}", one.recording, one.copy_of)).collect();
    let are = count(copies.len() as u64, "recording is a copy, and is", "recordings are copies, and are");
    (!copies.is_empty()).then(|| format!("{are} not counted: {}", named.join("; ")))
}

/// What is wrong about a copy of `first` beside whose log other decisions stand; and what would be right.
pub fn differing_copy(first: &str) -> (String, String) {
    let found =
        format!("a copy of {first} with another exclusion, other codes of raters, or another correction beside it");
    (found, "one of the two recordings, with what holds for it; the other one is to be moved elsewhere".to_string())
}
