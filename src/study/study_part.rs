//! A part of a study: what the analysis of a shard of the study's recordings hands to the analysis of all recordings.
//!
//! The analysis has two stages. Stage one needs a recording and the codes beside it, nothing else, and takes nearly all
//! of the time: the replay, estimates, attribution of errors, hypothetical signals of concepts, twins. Stage one
//! reduces a recording to an [`AnalysedRecording`] (counts, medians, lengths of sequences, matched lanes, prevention
//! counts, answers) and its rows of the tables of events, as CSV. Stage two needs the results of all recordings
//! together: codes and periods of participants, every test, interval and picture, the tables of trials and
//! participants, preregistration.
//!
//! A part holds the results of stage one, so stage two over joined parts is stage two over all recordings, to the last
//! byte. Numbers are written so that they are read back exactly (shortest text of a double). Less content would not do:
//! the mixed models and the bootstrap need trials, the kappa of wizard and assistant needs both lanes of signals, the
//! tables of events need their rows.
//!
//! A part is a file of JSON Lines: a [`PartHeader`], [`PartShared`], then for each recording a line with the
//! [`AnalysedRecording`] and a line with the recording's rows (an array of five texts, empty with `--skip events`). The
//! format belongs to the program's version.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::facts::RecordingFacts;
use crate::frozen_plan::{PlanVersions, RecordedPlan};
use crate::pass::reading::{AnalysisScope, RecordedConsent, WaivedPractice};
use crate::planned_trial::{ForeignRecording, PlannedTrialKey, RecordingCopy};
use crate::tables::participants::TutorialQuestionRow;
use crate::trial_statistics::{TrialDetails, TrialStatistics};
use tomcom_session::header::{CodeCorrection, RecordedFile};
use tomcom_session::plan::PlanPosition;

pub(crate) const PART_FORMAT: u32 = 8;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartHeader {
    pub study_part: u32,
    pub program: String,
    /// Number of this part of the study; 1 is the first.
    pub shard: u64,
    pub shards: u64,
    pub recordings: u64,
    /// Names of the recordings that were left out, since they belong to other parts.
    pub left_out: BTreeSet<String>,
    /// Recordings that were left out, since they are copies of others.
    pub copies: BTreeSet<RecordingCopy>,
    /// Recordings that were left out, since they are none of the study's.
    pub foreign: BTreeSet<ForeignRecording>,
    pub analysis: AnalysisScope,
    /// The study plans to which the recordings belong, each with its digest; empty for recordings without a plan.
    pub plans: BTreeSet<(String, String)>,
}

/// The second line of a part's file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartShared {
    /// Layout and recipes of the kitchen; `None` in a part without recordings.
    pub kitchen: Option<[RecordedFile; 2]>,
    pub versions: PlanVersions,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnalysedRecording {
    pub recording: String,
    /// SHA-256 digest of the header of the recording's log, by which copies are known.
    pub digest: String,
    pub plan: RecordedPlan,
    pub correction: Option<CodeCorrection>,
    /// The consent with which the recording begins; `None` if it begins without.
    pub consent: Option<RecordedConsent>,
    pub tutorial: Vec<TutorialQuestionRow>,
    pub waived: Option<WaivedPractice>,
    /// The recording's trial, with its details and with what the report tells about the recording; `None` for practice.
    pub trial: Option<(TrialStatistics, TrialDetails, RecordingFacts)>,
}

impl AnalysedRecording {
    /// Whether this is the analysis of a copy: all results are those of the other recording, but for the names.
    pub(crate) fn is_copy_of(&self, other: &AnalysedRecording) -> bool {
        let mut same = self.clone();
        same.recording = other.recording.clone();
        same.tutorial.iter_mut().for_each(|row| row.recording = other.recording.clone());
        if let Some((trial, ..)) = &mut same.trial {
            trial.recording = other.recording.clone();
        }
        same == *other
    }

    /// Whether the recording counts: it is practice, or has a trial that is not left out.
    pub fn counts(&self) -> bool {
        self.left_out().is_none()
    }

    pub fn left_out(&self) -> Option<&String> {
        self.trial.as_ref().and_then(|(trial, ..)| trial.left_out.as_ref())
    }

    /// The trial of a plan that the recording counts for; `None` if there is none, or the recording does not count.
    pub(crate) fn counted_trial(&self) -> Option<PlannedTrialKey> {
        let (trial, ..) = self.trial.as_ref().filter(|(trial, ..)| trial.counts())?;
        PlannedTrialKey::new(&self.plan, trial.started.is_none().then_some(trial.seed))
    }
}

/// Why the parts of a study, or the shards of a pool, cannot be joined, or why lines make no pool.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShardMismatch {
    pub index: usize,
    pub found: String,
    pub remedy: String,
}

impl ShardMismatch {
    pub(crate) fn new(index: usize, found: String, remedy: &str) -> ShardMismatch {
        ShardMismatch { index, found, remedy: remedy.to_string() }
    }
}

impl PartHeader {
    fn options(&self) -> String {
        let AnalysisScope { concepts, events, raters } = &self.analysis;
        let skipped = [(*concepts, "concepts"), (*events, "events")];
        let skipped: Vec<&str> = skipped.iter().filter(|(is_done, _)| !is_done).map(|(_, what)| *what).collect();
        let skip = (!skipped.is_empty()).then(|| format!("--skip {}", skipped.join(",")));
        let raters = raters.as_ref().map(|raters| format!("--raters {}", raters.join(" ")));
        let all: Vec<String> = [skip, raters].into_iter().flatten().collect();
        if all.is_empty() { "without --skip and --raters".to_string() } else { format!("with {}", all.join(" ")) }
    }
}

/// Checks that these parts make one whole study, analysed with the same options by this version of the program. Errors:
/// a part is of another program, study or number of parts, was analysed with other options, occurs twice, or is
/// missing.
pub(crate) fn check_parts(parts: &[PartHeader]) -> Result<(), ShardMismatch> {
    let Some(first) = parts.first() else {
        return Err(ShardMismatch::new(0, "no part".to_string(), "all parts of a study"));
    };
    let version = env!("CARGO_PKG_VERSION");
    // A part without recordings fits any study.
    let study = parts.iter().find(|part| part.recordings > 0).unwrap_or(first);
    let mut places = BTreeMap::new();
    for (index, part) in parts.iter().enumerate() {
        let wrong = |found: String, remedy: &str| Err(ShardMismatch::new(index, found, remedy));
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
            return wrong(found, "parts of one plan: tomcom study DIR --plan NAME --shard PART/PARTS");
        }
        if places.insert(part.shard, index).is_some() {
            return wrong(format!("part {} of {} for the second time", part.shard, part.shards), "each part once");
        }
    }
    let missing: Vec<String> =
        (1..=first.shards).filter(|shard| !places.contains_key(shard)).map(|one| one.to_string()).collect();
    if !missing.is_empty() {
        let found = format!("{} of {} parts, without {}", parts.len(), first.shards, missing.join(", "));
        return Err(ShardMismatch::new(0, found, "all parts of the study, such as 1/8 to 8/8"));
    }
    Ok(())
}

fn plans(part: &PartHeader) -> String {
    let named: Vec<String> =
        part.plans.iter().map(|(plan, digest)| format!("the plan \"{plan}\" ({digest})")).collect();
    if named.is_empty() { "no plan".to_string() } else { named.join(" and ") }
}

/// Index of a recording's trial, by which the recording belongs to a shard: as `tomcom simulate` counts the trials of a
/// plan, participant by participant; without a plan the number of the trial. Practice has the index of the
/// participant's first trial.
pub(crate) fn trial_index(step: Option<&PlanPosition>, trial: u64) -> u64 {
    step.map_or(trial, |step| {
        let period = step.period.map_or(0, |period| u64::from(period).saturating_sub(1));
        u64::from(step.participant) * u64::from(step.periods) + period
    })
}
