//! A part of a study: what the analysis of a shard of its recordings hands to the analysis of all.
//!
//! The analysis has two stages. Stage one needs a recording and the codes beside it, nothing else, and takes nearly all of the time: the replay,
//! estimates, attribution of errors, hypothetical signals of concepts, twins. It reduces a recording to an [`AnalysedRecording`] (counts, medians,
//! lengths of sequences, matched lanes, prevention counts, answers) and its rows of the tables of events, as CSV. Stage two needs all of these
//! together: codes and periods of participants, every test, interval and picture, the tables of trials and participants, preregistration.
//!
//! A part holds the results of stage one, so stage two over joined parts is stage two over all recordings, to the last byte. Numbers are written
//! so that they are read back exactly (shortest text of a double). Nothing smaller would do: the mixed models and the bootstrap need trials, the
//! kappa of wizard and assistant needs both lanes of signals, the tables of events need their rows.
//!
//! A part is a file of JSON Lines: a [`PartHeader`], the [`PartKitchen`], then for each recording a line with the [`AnalysedRecording`] and a line
//! with its rows (an array of five texts, empty with `--skip events`). The format belongs to the program's version.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::facts::RecordingFacts;
use super::preregistration::RecordedPlan;
use super::recorded_consent::RecordedConsent;
use super::tables::tutorial_answers::TutorialAnswer;
use super::trial_statistics::TrialStatistics;
use crate::session::header::RecordedFile;
use crate::session::plan::StepSpec;

/// Version of the format.
pub const PART_FORMAT: u32 = 1;

/// The first line of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartHeader {
    /// Version of the format.
    pub study_part: u32,
    /// Version of the program that analysed the recordings.
    pub program: String,
    /// Which part this is; 1 is the first.
    pub shard: u64,
    /// Number of parts.
    pub shards: u64,
    /// Number of recordings in the part.
    pub recordings: u64,
    /// How the recordings were analysed.
    pub analysis: PartAnalysis,
    /// The plans that the recordings belong to, each with its digest; empty for recordings of no plan.
    pub plans: BTreeSet<(String, String)>,
}

/// The second line of a part: layout and recipes of the kitchen; `None` in a part without recordings.
pub type PartKitchen = Option<[RecordedFile; 2]>;

/// The options of an analysis that change the results of a recording.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartAnalysis {
    /// Whether the signals of communication concepts are computed.
    pub concepts: bool,
    /// Whether the rows of the tables of events are made.
    pub events: bool,
    /// The two raters whose codes are taken, if they were named.
    pub raters: Option<[String; 2]>,
}

/// What the analysis of one recording hands to that of the study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalysedRecording {
    /// The recording's name in tables.
    pub recording: String,
    /// The plan that it belongs to.
    pub plan: RecordedPlan,
    /// The consent that it begins with.
    pub consent: Option<RecordedConsent>,
    /// The answers to the questions of its tutorial.
    pub tutorial: Vec<TutorialAnswer>,
    /// The trial, with what the report tells about the recording; `None` for practice.
    pub trial: Option<(TrialStatistics, RecordingFacts)>,
}

/// What is wrong with parts that are joined.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartMismatch {
    /// Index of the part.
    pub index: usize,
    /// What was found.
    pub found: String,
    /// What would be right.
    pub remedy: String,
}

impl PartMismatch {
    fn new(index: usize, found: String, remedy: &str) -> PartMismatch {
        PartMismatch { index, found, remedy: remedy.to_string() }
    }
}

impl PartHeader {
    /// Whether this is the same part of as many, whatever was analysed.
    pub fn is_place_of(&self, other: &PartHeader) -> bool {
        (self.shard, self.shards) == (other.shard, other.shards)
    }

    /// The options in words.
    fn options(&self) -> String {
        let PartAnalysis { concepts, events, raters } = &self.analysis;
        let skipped = [(*concepts, "concepts"), (*events, "events")];
        let skipped: Vec<&str> = skipped.iter().filter(|(is_done, _)| !is_done).map(|(_, what)| *what).collect();
        let skip =
            Some(skipped).filter(|skipped| !skipped.is_empty()).map(|skipped| format!("--skip {}", skipped.join(",")));
        let raters = raters.as_ref().map(|raters| format!("--raters {}", raters.join(" ")));
        let all: Vec<String> = [skip, raters].into_iter().flatten().collect();
        if all.is_empty() { "without --skip and --raters".to_string() } else { format!("with {}", all.join(" ")) }
    }
}

/// Checks that these parts make the whole of one study, analysed in one way by this version of the program.
///
/// # Errors
/// A part is of another program, study or number of parts, was analysed with other options, is there twice, or is missing.
pub fn check_parts(parts: &[PartHeader]) -> Result<(), PartMismatch> {
    let Some(first) = parts.first() else {
        return Err(PartMismatch::new(0, "no part".to_string(), "all parts of a study"));
    };
    let version = env!("CARGO_PKG_VERSION");
    // A part without recordings is of any study.
    let study = parts.iter().find(|part| part.recordings > 0).unwrap_or(first);
    let mut places = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        let wrong = |found: String, remedy: &str| Err(PartMismatch::new(index, found, remedy));
        if part.program != version {
            let remedy = format!("parts of version {version}, which joins them; or the program that made them");
            return wrong(format!("a part of version {} of the program", part.program), &remedy);
        }
        if part.shards != first.shards {
            let found = format!("part {} of {}, beside parts of {}", part.shard, part.shards, first.shards);
            return wrong(found, "parts of one study, all with the same number of parts");
        }
        if part.analysis != first.analysis {
            let found =
                format!("a part that was analysed {}, where the first file was {}", part.options(), first.options());
            return wrong(found, "parts that were analysed with the same options");
        }
        if part.recordings > 0 && part.plans != study.plans {
            let found = format!("a part of {}, beside a part of {}", plans(part), plans(study));
            return wrong(
                found,
                "parts of one study; recordings of several plans are analysed together without --shard",
            );
        }
        if places.insert(part.shard, index).is_some() {
            return wrong(format!("part {} of {} for the second time", part.shard, part.shards), "each part once");
        }
    }
    let missing: Vec<String> =
        (1..=first.shards).filter(|shard| !places.contains_key(shard)).map(|one| one.to_string()).collect();
    if !missing.is_empty() {
        let found = format!("{} of {} parts, without {}", parts.len(), first.shards, missing.join(", "));
        return Err(PartMismatch::new(0, found, "all parts of the study, such as 1/8 to 8/8"));
    }
    Ok(())
}

/// The plans of a part in words.
fn plans(part: &PartHeader) -> String {
    let named: Vec<String> =
        part.plans.iter().map(|(plan, digest)| format!("the plan \"{plan}\" ({digest})")).collect();
    if named.is_empty() { "no plan".to_string() } else { named.join(" and ") }
}

/// Index of a recording's trial, by which it belongs to a shard: as `tomcom simulate` counts the trials of a plan, participant by participant;
/// without a plan the number of the trial. Practice goes with the participant's first trial.
pub fn trial_index(step: Option<&StepSpec>, trial: u64) -> u64 {
    step.map_or(trial, |step| {
        let period = step.period.map_or(0, |period| u64::from(period).saturating_sub(1));
        u64::from(step.participant) * u64::from(step.periods) + period
    })
}
