//! Trials of a study's plan that have no recording: not carried out yet, lost, or of a part that was never simulated.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::preregistration::RecordedPlan;
use tomcom_core::base::text::count;

/// Largest number of participants that are named in a text.
const NAMED: usize = 8;

/// Trials of a participant that have no recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingTrials {
    /// Name of the study plan.
    pub plan: String,
    /// Number of the participant in the plan, from 1; null if only recordings whose code was corrected are there.
    pub participant: Option<u32>,
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
    /// By the code of a participant: index in the plan, as far as it is known, and the numbers of the trials with a
    /// recording.
    participants: BTreeMap<&'a str, (Option<u32>, BTreeSet<u32>)>,
}

/// The trials without a recording, by plan and participant. Recordings know their place in the plan, but not the
/// number of its participants: participants after the last with a recording are not found.
pub fn missing_trials(recordings: &[RecordedPlan]) -> Vec<MissingTrials> {
    let mut plans: BTreeMap<&str, PlanRecordings> = BTreeMap::new();
    for recording in recordings {
        let (Some((plan, _)), Some(place)) = (&recording.plan, recording.place) else { continue };
        let found = plans.entry(plan).or_default();
        found.periods = found.periods.max(place.periods);
        let (index, trials) = found.participants.entry(&recording.participant).or_default();
        *index = index.or(place.participant);
        trials.extend(place.period);
    }
    plans.into_iter().flat_map(|(plan, found)| found.missing(plan)).collect()
}

impl PlanRecordings<'_> {
    fn missing(&self, plan: &str) -> Vec<MissingTrials> {
        let none = BTreeSet::new();
        let missing = |index: Option<u32>, code: Option<&str>, there: &BTreeSet<u32>| MissingTrials {
            plan: plan.to_string(),
            participant: index.map(|index| index + 1),
            code: code.map(str::to_string),
            trials: (1..=self.periods).filter(|trial| !there.contains(trial)).collect(),
        };
        let known: BTreeMap<u32, (&str, &BTreeSet<u32>)> =
            self.participants.iter().filter_map(|(code, (index, trials))| Some(((*index)?, (*code, trials)))).collect();
        let after_last = known.keys().last().map_or(0, |last| last + 1);
        let in_order = (0..after_last).map(|index| match known.get(&index) {
            Some((code, trials)) => missing(Some(index), Some(code), trials),
            None => missing(Some(index), None, &none),
        });
        let others = self.participants.iter().filter(|(_, (index, _))| index.is_none());
        let others = others.map(|(code, (_, trials))| missing(None, Some(code), trials));
        in_order.chain(others).filter(|missing| !missing.trials.is_empty()).collect()
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
        let number = || self.participant.map_or(String::new(), |number| format!("participant {number}"));
        let who = self.code.clone().unwrap_or_else(number);
        let trials: Vec<String> = self.trials.iter().map(u32::to_string).collect();
        match &trials[..] {
            [one] => format!("{who} trial {one}"),
            several => format!("{who} trials {}", several.join(", ")),
        }
    }
}
