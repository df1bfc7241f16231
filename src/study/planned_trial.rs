//! Trials of a study plan, for each of which one recording counts; and copies of recordings, which do not count.

use serde::{Deserialize, Serialize};

use super::preregistration::RecordedPlan;
use tomcom_core::base::text::count;

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

/// A recording whose log equals that of another one, or a beginning of it, so that it does not count.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingCopy {
    /// The recording that does not count.
    pub recording: String,
    /// The recording that counts.
    pub copy_of: String,
    /// Why the copy would be left out anyway, in words; null if it would count.
    pub left_out: Option<String>,
}

/// Copies of recordings in words; `None` if there are none.
pub fn copies_in_words(copies: &[RecordingCopy]) -> Option<String> {
    let name = |one: &RecordingCopy| {
        let left_out = one.left_out.as_ref().map_or(String::new(), |reason| format!(" ({reason})"));
        format!("{}{left_out} of {}", one.recording, one.copy_of)
    };
    let named: Vec<String> = copies.iter().map(name).collect();
    let are = count(copies.len() as u64, "recording is a copy, and is", "recordings are copies, and are");
    (!copies.is_empty()).then(|| format!("{are} not counted: {}", named.join("; ")))
}

/// What is wrong about a copy of `first` beside whose log codes of raters stand that `first` has not, in the file `codes`,
/// or has in another version (`is_there`); and what would be right.
pub fn copy_with_codes(copy: &str, first: &str, (codes, is_there): (String, bool)) -> (String, String) {
    let found = match is_there {
        true => format!("a copy of {first} with another {codes}"),
        false => format!("a copy of {first} with {codes}, which is not in {first}"),
    };
    let take = match is_there {
        true => format!("compare the two files, keep what holds in {first}"),
        false => format!("copy that file to {first}"),
    };
    let remedy = format!(
        "all codes in one recording: {take}, or tomcom codes {copy} --export codes.csv, then tomcom codes {first} --import \
         codes.csv; or leave this copy out: tomcom exclude {copy} --reason …"
    );
    (found, remedy)
}

/// What is wrong about a copy of `first` of which another analysis found something else; and what would be right.
pub fn differing_copy(first: &str) -> (String, String) {
    let found = format!("a copy of {first} that differs: in codes of raters, a correction, or the end of its log");
    let remedy = "both in one analysis without --shard, which says what differs; or leave the copy out (tomcom exclude \
                  RECORDING --reason …), and analyse its part again";
    (found, remedy.to_string())
}
