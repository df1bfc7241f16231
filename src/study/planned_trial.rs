//! Trials of a study plan, for each of which one recording counts; copies of recordings, which do not count; and trials
//! without a recording.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::figures::CorrectedRecording;
use crate::frozen_plan::RecordedPlan;
use tomcom_core::base::text::count;
use tomcom_session::study_arm::StudyArm;

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlannedTrialKey {
    plan: String,
    /// Of the participant.
    code: String,
    /// Of a simulated participant, since every seed simulates other people.
    seed: Option<u64>,
    /// Number of the trial, from 1.
    period: u32,
}

impl PlannedTrialKey {
    /// The trial of a recording with this place in a plan; `None` for practice, and for a recording without a plan.
    /// `seed`: that of a simulated participant.
    pub fn new(recorded: &RecordedPlan, seed: Option<u64>) -> Option<PlannedTrialKey> {
        let (plan, _) = recorded.plan.clone()?;
        let period = recorded.place.as_ref()?.period?;
        Some(PlannedTrialKey { plan, code: recorded.participant.clone(), seed, period })
    }

    /// Whether one of these is simulated and the other was recorded live, of one code in one plan: tables would make one
    /// participant of a person and a simulation.
    pub(crate) fn is_mixed_with(&self, other: &PlannedTrialKey) -> bool {
        self.is_of_code_of(other) && self.seed.is_some() != other.seed.is_some()
    }

    pub(crate) fn is_of_code_of(&self, other: &PlannedTrialKey) -> bool {
        (&self.plan, &self.code) == (&other.plan, &other.code)
    }

    /// What is wrong about a simulated recording if `first` is a live one of the same code; and what would be right.
    pub(crate) fn mixed_with(&self, first: &str) -> (String, String) {
        let PlannedTrialKey { plan, code, .. } = self;
        let found =
            format!("a simulated recording of {code} in the plan \"{plan}\", beside {first}, which was recorded live");
        let remedy = "simulated recordings in a folder of their own; or leave the one or the other out: tomcom exclude FOLDER \
                      --code CODE --reason …, or RECORDING --reason …";
        (found, remedy.to_string())
    }

    /// What is wrong if `first` is another recording that counts for this trial; and what would be right.
    pub(crate) fn counted_twice(&self, first: &str) -> (String, String) {
        let PlannedTrialKey { plan, code, seed, period } = self;
        let simulated = seed.map_or(String::new(), |seed| format!(" (simulated, seed {seed})"));
        let found = format!(
            "a second recording of trial {period} of participant {code}{simulated} in the plan \"{plan}\", which {first} is a recording of, too"
        );
        let remedy = "one recording that counts for each trial: leave the other out (tomcom exclude RECORDING --reason …), \
                      or correct a code that was typed wrong (tomcom correct RECORDING --code CODE --reason …)";
        (found, remedy.to_string())
    }
}

/// A recording whose log equals that of another one, or a beginning of it, so that it does not count.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingCopy {
    pub recording: String,
    pub copy_of: String,
    /// Why the copy would be left out anyway, in words; null if it would count.
    pub left_out: Option<String>,
}

/// A recording that is none of the study's, though it lies beside them.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForeignRecording {
    pub reason: ForeignReason,
    pub recording: String,
    /// Why it was excluded, of one that cannot be read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub excluded: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ForeignReason {
    /// Beside recordings of a plan.
    NoPlan,
    /// Beside recordings of people.
    Simulated,
    /// In an export; an analysis reads how far it is.
    Running,
    /// It cannot be read, and is excluded.
    Damaged,
}

impl ForeignReason {
    pub(crate) fn words(self) -> &'static str {
        match self {
            ForeignReason::NoPlan => "of no plan, beside those of a plan",
            ForeignReason::Simulated => "of a simulated participant, beside those of people",
            ForeignReason::Running => "still being written",
            ForeignReason::Damaged => "excluded, and cannot be read",
        }
    }
}

pub fn foreign_in_words(foreign: &[ForeignRecording]) -> Option<String> {
    let group = |group: &[ForeignRecording]| {
        let name = |one: &ForeignRecording| {
            let excluded = one.excluded.as_ref().map_or(String::new(), |reason| format!(" (excluded: {reason})"));
            one.recording.clone() + &excluded
        };
        let names: Vec<String> = group.iter().map(name).collect();
        let are = count(group.len() as u64, "recording is", "recordings are");
        format!("{are} {}, and left out: {}", group[0].reason.words(), named(&names, NAMED))
    };
    let groups: Vec<String> = foreign.chunk_by(|a, b| a.reason == b.reason).map(group).collect();
    (!groups.is_empty()).then(|| groups.join("; "))
}

/// What is wrong if people's and simulated recordings are in one study, of which `first` is the other kind; and what would
/// be right.
pub(crate) fn mixed_kinds(is_simulated: bool, first: &str) -> (String, String) {
    let [own, others] = match is_simulated {
        true => ["a simulated participant", "a person"],
        false => ["a person", "a simulated participant"],
    };
    let remedy = "parts of recordings of people, or of simulated ones";
    (format!("a recording of {own}, beside {first}, which is of {others}"), remedy.to_string())
}

pub fn copies_in_words(copies: &[RecordingCopy]) -> Option<String> {
    let name = |one: &RecordingCopy| {
        let left_out = one.left_out.as_ref().map_or(String::new(), |reason| format!(" ({reason})"));
        format!("{}{left_out} of {}", one.recording, one.copy_of)
    };
    let named: Vec<String> = copies.iter().map(name).collect();
    let are = count(copies.len() as u64, "recording is a copy, and is", "recordings are copies, and are");
    (!copies.is_empty()).then(|| format!("{are} not counted: {}", named.join("; ")))
}

/// Both as lines; empty if there are none.
pub fn left_out_in_words(foreign: &[ForeignRecording], copies: &[RecordingCopy]) -> String {
    let told = foreign_in_words(foreign).into_iter().chain(copies_in_words(copies));
    told.map(|words| words + "\n").collect()
}

/// What is wrong about a copy of `first` beside whose log codes of raters stand that `first` has not, in the file `codes`,
/// or has in another version (`is_there`); and what would be right.
pub(crate) fn copy_with_codes(copy: &str, first: &str, (codes, is_there): (String, bool)) -> (String, String) {
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
pub(crate) fn differing_copy(first: &str) -> (String, String) {
    let found = format!("a copy of {first} that differs: in codes of raters, a correction, or the end of its log");
    let remedy = "both in one analysis without --shard, which says what differs; or leave the copy out (tomcom exclude \
                  RECORDING --reason …), and analyse its part again";
    (found, remedy.to_string())
}

pub(crate) const NAMED: usize = 8;

/// At most so many names, and how many more there are.
pub(crate) fn named<Name: AsRef<str>>(names: &[Name], most: usize) -> String {
    let first: Vec<&str> = names.iter().take(most).map(AsRef::as_ref).collect();
    let more = match names.len().saturating_sub(most) {
        0 => String::new(),
        more => format!(", and {more} more"),
    };
    first.join(", ") + &more
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MissingTrials {
    pub plan: String,
    /// Number of the participant in the plan, from 1; null if no recording was begun for the participant.
    pub participant: Option<u32>,
    /// Code of the participant; `None` if there is no recording of the participant and the codes are no numbers.
    pub code: Option<String>,
    /// Numbers of the participant's trials without a recording, from 1.
    pub trials: Vec<u32>,
}

#[derive(Default)]
struct PlanRecordings<'a> {
    periods: u32,
    /// By code: index in the plan, as far as it is known, and the numbers of the trials with a recording.
    participants: BTreeMap<&'a str, (Option<u32>, BTreeSet<u32>)>,
}

/// A participant's trials in the conditions that the plan has for somebody else, since codes were corrected: which they
/// were, and which were planned, in words. `recordings`: those of the study, each with whether its trial counts.
pub fn other_orders<'a>(recordings: impl Iterator<Item = (&'a RecordedPlan, bool)>) -> Vec<String> {
    // By version of the plan: the conditions by their letters in groups, the groups by code, and the trials by participant.
    let (mut arms, mut groups) = (BTreeMap::new(), BTreeMap::new());
    let mut done: BTreeMap<_, BTreeMap<u32, (&str, StudyArm)>> = BTreeMap::new();
    for (recording, counts) in recordings {
        let (Some(plan), Some(place)) = (&recording.plan, &recording.place) else { continue };
        let (Some(period), Some(arm)) = (place.period, place.arm) else { continue };
        let code = recording.recorded_code();
        groups.insert((plan, code), place.group.as_str());
        arms.extend(letter(&place.group, period).map(|letter| ((plan, letter), arm)));
        if counts {
            done.entry((plan, recording.participant.as_str())).or_default().insert(period, (code, arm));
        }
    }
    let mut told = Vec::new();
    for ((plan, own), trials) in done {
        let others: BTreeSet<&str> = trials.values().map(|(code, _)| *code).filter(|code| *code != own).collect();
        let planned = |period: u32| arms.get(&(plan, letter(groups.get(&(plan, own))?, period)?)).copied();
        if others.is_empty() || trials.iter().all(|(period, (_, arm))| planned(*period) == Some(*arm)) {
            continue;
        }
        let in_words = |arm: &dyn Fn(u32) -> Option<StudyArm>| {
            let one = |period: &u32| format!("trial {period} {}", arm(*period).map_or("not known", StudyArm::title));
            trials.keys().map(one).collect::<Vec<_>>().join(", ")
        };
        let others = others.into_iter().collect::<Vec<_>>().join(" and ");
        let planned = match groups.contains_key(&(plan, own)) {
            true => in_words(&planned),
            false => "not known, since no recording was begun for this code".to_string(),
        };
        let done = in_words(&|period| trials.get(&period).map(|(_, arm)| *arm));
        told.push(format!("{own}, recorded as {others}, had {done}; planned: {planned}"));
    }
    told
}

/// The letter of a trial's condition in the name of a starting group. `period`: from 1.
fn letter(group: &str, period: u32) -> Option<char> {
    group.chars().nth(period.checked_sub(1)? as usize)
}

/// The trials without a recording, by plan and participant. Recordings know their place in the plan, but not the
/// number of its participants: participants after the last with a recording are not found.
pub fn missing_trials(recordings: &[RecordedPlan]) -> Vec<MissingTrials> {
    let mut plans: BTreeMap<&str, PlanRecordings> = BTreeMap::new();
    for recording in recordings {
        let (Some((plan, _)), Some(place)) = (&recording.plan, &recording.place) else { continue };
        let found = plans.entry(plan).or_default();
        found.periods = found.periods.max(place.periods);
        found.participants.entry(recording.recorded_code()).or_default().0 = Some(place.participant);
        found.participants.entry(&recording.participant).or_default().1.extend(place.period);
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
        // Where a plan only counts its participants, their codes are their numbers: P01, P02, …
        let digits = known.values().next().map_or(0, |(code, _)| code.len().saturating_sub(1));
        let numbered = |index: u32| format!("P{:0digits$}", index + 1);
        let are_numbers = known.iter().all(|(index, (code, _))| *code == numbered(*index));
        let in_order = (0..after_last).map(|index| match known.get(&index) {
            Some((code, trials)) => missing(Some(index), Some(code), trials),
            // All recordings of the participant can have been begun with another code.
            None => {
                let code = are_numbers.then(|| numbered(index));
                let there = code.as_deref().and_then(|code| self.participants.get(code));
                missing(Some(index), code.as_deref(), there.map_or(&none, |(_, trials)| trials))
            }
        });
        let is_in_order = |code: &str| are_numbers && (0..after_last).any(|index| numbered(index) == code);
        let others = self.participants.iter().filter(|(code, (index, _))| index.is_none() && !is_in_order(code));
        let others = others.map(|(code, (_, trials))| missing(None, Some(code), trials));
        in_order.chain(others).filter(|missing| !missing.trials.is_empty()).collect()
    }
}

/// With the recordings whose codes were corrected, to which trials that are missing can belong.
pub fn in_words(missing: &[MissingTrials], corrections: &[CorrectedRecording]) -> Option<String> {
    let of_plans: Vec<String> = missing.chunk_by(|a, b| a.plan == b.plan).filter_map(of_plan).collect();
    let is_missing = |code: &String| missing.iter().any(|one| one.code.as_ref() == Some(code));
    let moved =
        corrections.iter().filter(|one| is_missing(&one.correction.before) || is_missing(&one.correction.after));
    let moved: Vec<String> = moved.map(|one| format!("{} ({})", one.recording, one.correction.codes())).collect();
    let moved = match moved.is_empty() {
        true => String::new(),
        false => format!(
            "; codes were corrected of: {}; tomcom correct RECORDING --undo takes a correction back",
            moved.join(", ")
        ),
    };
    (!of_plans.is_empty()).then(|| of_plans.join("; ") + &moved)
}

/// The missing trials of one plan.
fn of_plan(missing: &[MissingTrials]) -> Option<String> {
    let plan = &missing.first()?.plan;
    let number: u64 = missing.iter().map(|one| one.trials.len() as u64).sum();
    let named: Vec<String> = missing.iter().take(NAMED).map(MissingTrials::describe).collect();
    let others = missing.len().saturating_sub(NAMED) as u64;
    let others = match others {
        0 => String::new(),
        _ => format!("; and of {}", count(others, "more participant", "more participants")),
    };
    let (trials, have) = if number == 1 { ("trial", "has") } else { ("trials", "have") };
    let named = named.join("; ");
    (number > 0).then(|| format!("{number} {trials} of the plan \"{plan}\" {have} no recording: {named}{others}"))
}

impl MissingTrials {
    /// The participant with the trials: "P03 trial 2".
    fn describe(&self) -> String {
        let number = || self.participant.map_or(String::new(), |number| format!("the plan's participant {number}"));
        let who = self.code.clone().unwrap_or_else(number);
        let who = match self.participant {
            Some(_) => who,
            None => format!("{who} (a corrected code, perhaps none of the plan)"),
        };
        let trials: Vec<String> = self.trials.iter().map(u32::to_string).collect();
        match &trials[..] {
            [one] => format!("{who} trial {one}"),
            several => format!("{who} trials {}", several.join(", ")),
        }
    }
}
