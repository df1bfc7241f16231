//! Comparison of a study with the plan that was frozen before it began.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::frozen_plan::FrozenPlan;
use tomcom_core::base::text::count;
use tomcom_session::LogHeader;

/// The study plan to which a recording belongs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordedPlan {
    /// The code of the recording's participant.
    pub participant: String,
    /// Name and digest of the recording's study plan; `None` for a recording without a plan.
    pub plan: Option<(String, String)>,
    /// Place of the recording in its plan; `None` for a recording without a plan.
    pub place: Option<PlaceInPlan>,
}

impl RecordedPlan {
    /// The study plan to which the recording with this header belongs.
    pub fn from_header(header: &LogHeader) -> RecordedPlan {
        let spec = &header.session;
        let plan = spec.step.as_ref().map(|step| (step.plan.clone(), step.digest.clone()));
        let place = spec.step.as_ref().map(|step| PlaceInPlan {
            participant: header.correction.is_none().then_some(step.participant),
            period: step.period,
            periods: step.periods,
        });
        RecordedPlan { participant: spec.participant.code.clone(), plan, place }
    }
}

/// Place of a recording in its study plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaceInPlan {
    /// Index of the participant in the plan, from 0; `None` if the participant's code was corrected, since the log has
    /// the index of another one.
    pub participant: Option<u32>,
    /// Number of the trial, from 1; `None` for practice.
    pub period: Option<u32>,
    /// Number of counted trials per participant; 0 for a recording of the tutorial alone.
    pub periods: u32,
}

/// Result of comparing a study with its frozen plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PreregistrationCheck {
    /// SHA-256 digest of the frozen plan, in hexadecimal.
    pub digest: String,
    /// Name of the study plan.
    pub plan: String,
    /// Number of recordings of the plan that existed when the plan was frozen.
    pub recordings_before: u64,
    /// Differences between study and frozen plan, in words; empty if there are none.
    pub differences: Vec<String>,
}

impl PreregistrationCheck {
    /// Compares the recordings of an analysis, and the definitions of this version of the program, with the frozen plan
    /// that has this digest.
    pub fn new(digest: String, frozen: &FrozenPlan, recordings: &[RecordedPlan]) -> PreregistrationCheck {
        let mut differences = frozen.differs_from_program();
        let mut others: BTreeMap<String, u64> = BTreeMap::new();
        for recording in recordings {
            let what = match &recording.plan {
                None => "of no plan".to_string(),
                Some((plan, _)) if *plan != frozen.plan => format!("of the plan \"{plan}\""),
                Some((_, digest)) if *digest != frozen.plan_digest => {
                    format!("of another version of the plan ({digest}, frozen: {})", frozen.plan_digest)
                }
                Some(_) => continue,
            };
            *others.entry(what).or_default() += 1;
        }
        differences.extend(
            others.iter().map(|(what, number)| format!("{} {what}", count(*number, "recording is", "recordings are"))),
        );
        let there: BTreeSet<&str> = recordings.iter().map(|recording| recording.participant.as_str()).collect();
        let is_planned = |code: &&&str| frozen.participants.iter().any(|planned| planned == **code);
        let strangers: Vec<&str> = there.iter().filter(|code| !is_planned(code)).copied().collect();
        let missing = frozen.participants.iter().map(String::as_str).filter(|code| !there.contains(code));
        for (who, codes) in [("without a recording", missing.collect()), ("not in the frozen plan", strangers)] {
            differences.extend(named(who, &codes));
        }
        let (plan, recordings_before) = (frozen.plan.clone(), frozen.recordings_before);
        PreregistrationCheck { digest, plan, recordings_before, differences }
    }

    /// The result of the comparison in words: that the study is preregistered, or what differs.
    pub fn words(&self) -> String {
        let before = match self.recordings_before {
            0 => "when no recording of it was there".to_string(),
            number => format!("when {} of it there", count(number, "recording was", "recordings were")),
        };
        let frozen = format!("the plan \"{}\" was frozen {before}, SHA-256 {}", self.plan, self.digest);
        match &self.differences[..] {
            [] => format!("Preregistered: {frozen}; plan, definitions and analysis are those."),
            several => format!("Not as preregistered: {frozen}; differences: {}.", several.join("; ")),
        }
    }
}

/// List of participants in words; `None` if the list is empty.
fn named(who: &str, codes: &[&str]) -> Option<String> {
    let number = count(codes.len() as u64, "participant is", "participants are");
    (!codes.is_empty()).then(|| format!("{number} {who}: {}", codes.join(", ")))
}
