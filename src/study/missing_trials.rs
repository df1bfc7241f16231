//! Trials of a study's plan that have no recording: not carried out yet, lost, or of a part that was never simulated.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::preregistration::RecordedPlan;
use crate::base::words::count;

/// Largest number of participants that are named in a text.
const NAMED: usize = 8;

/// Trials of a participant that have no recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingTrials {
    /// Name of the study plan.
    pub plan: String,
    /// Number of the participant in the plan, from 1.
    pub participant: u32,
    /// Code of the participant; `None` if there is no recording of the participant.
    pub code: Option<String>,
    /// Numbers of the participant's trials without a recording, from 1.
    pub trials: Vec<u32>,
}

/// Participants of a plan up to the last with a recording.
#[derive(Default)]
struct PlanRecordings<'a> {
    /// Largest number of counted trials per participant.
    periods: u32,
    /// By the index of a participant: code, and the numbers of the trials with a recording.
    participants: BTreeMap<u32, (&'a str, BTreeSet<u32>)>,
}

/// The trials without a recording, by plan and participant. Recordings know their place in the plan, but not the
/// number of its participants: participants after the last with a recording are not found.
pub fn missing_trials(recordings: &[RecordedPlan]) -> Vec<MissingTrials> {
    let mut plans: BTreeMap<&str, PlanRecordings> = BTreeMap::new();
    for recording in recordings {
        let (Some((plan, _)), Some(place)) = (&recording.plan, recording.place) else { continue };
        let found = plans.entry(plan).or_default();
        found.periods = found.periods.max(place.periods);
        let (_, trials) =
            found.participants.entry(place.participant).or_insert((&recording.participant, BTreeSet::new()));
        trials.extend(place.period);
    }
    plans.into_iter().flat_map(|(plan, found)| found.missing(plan)).collect()
}

impl PlanRecordings<'_> {
    fn missing(&self, plan: &str) -> Vec<MissingTrials> {
        let last = self.participants.keys().last().copied().unwrap_or(0);
        let of_participant = |index: u32| {
            let found = self.participants.get(&index);
            let is_missing = |trial: &u32| found.is_none_or(|(_, trials)| !trials.contains(trial));
            MissingTrials {
                plan: plan.to_string(),
                participant: index + 1,
                code: found.map(|(code, _)| (*code).to_string()),
                trials: (1..=self.periods).filter(is_missing).collect(),
            }
        };
        (0..=last).map(of_participant).filter(|missing| !missing.trials.is_empty()).collect()
    }
}

/// The trials without a recording in words; `None` if there are none.
pub fn in_words(missing: &[MissingTrials]) -> Option<String> {
    let number: u64 = missing.iter().map(|one| one.trials.len() as u64).sum();
    let named: Vec<String> = missing.iter().take(NAMED).map(MissingTrials::describe).collect();
    let others = missing.len().saturating_sub(NAMED) as u64;
    let others = match others {
        0 => String::new(),
        _ => format!("; and of {}", count(others, "more participant", "more participants")),
    };
    let what = if number == 1 { "trial of the plan has" } else { "trials of the plan have" };
    (number > 0).then(|| format!("{number} {what} no recording: {}{others}", named.join("; ")))
}

impl MissingTrials {
    /// The participant with the trials: "P03 trial 2".
    fn describe(&self) -> String {
        let who = self.code.clone().unwrap_or_else(|| format!("participant {}", self.participant));
        let trials: Vec<String> = self.trials.iter().map(u32::to_string).collect();
        match &trials[..] {
            [one] => format!("{who} trial {one}"),
            several => format!("{who} trials {}", several.join(", ")),
        }
    }
}
