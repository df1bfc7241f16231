//! Recordings that a command reads together: each trial is there once.
//!
//! A folder of recordings can hold copies, such as those that a file manager or a sync program made, and two folders can
//! hold the same trial. Counted twice, a trial would make every figure wrong without a word.

use std::borrow::Cow;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::files::recordings;
use crate::frozen_plan::RecordedPlan;
use crate::planned_trial::{
    ForeignReason, ForeignRecording, NAMED, PlannedTrialKey, RecordingCopy, copy_with_codes, named,
};
use crate::{parallel, standing};
use tomcom_core::base::text::count;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::{LOG_NAME, LogReader, SameLogs, code_files, differing_codes, header_digest, ruling};
use tomcom_session::person_code;
use tomcom_session::settings::ParticipantKind;

#[derive(Clone, Debug, Default)]
pub struct GatheredRecordings {
    /// Paths of the recordings, in the order in which they were named; those of a folder are sorted by name.
    pub paths: Vec<PathBuf>,
    /// In the order of `paths`.
    pub places: Vec<GatheredPlace>,
    pub copies: Vec<RecordingCopy>,
    /// Excluded recordings that cannot be read, and what [`GatheredRecordings::without_foreign`] left out, sorted.
    pub foreign: Vec<ForeignRecording>,
}

/// Whose recording it is, and of which plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GatheredPlace {
    /// Of the participant.
    pub code: String,
    /// A tutorial alone is of the plan that has it.
    pub plan: Option<String>,
    pub is_simulated: bool,
}

/// A log of a recording: its path without symbolic links, and the digest of its header.
type LogPlace = (PathBuf, String);

struct FoundRecording {
    path: PathBuf,
    logs: Vec<LogPlace>,
    place: GatheredPlace,
    /// Whether the folder has the name that the program gave it, as far as that can be seen: it names the participant.
    is_named: bool,
    trial: Option<PlannedTrialKey>,
}

impl GatheredRecordings {
    /// Finds the recordings at these paths: recordings, their logs, or folders of recordings. A recording to which
    /// several paths lead is there once, and so is a recording whose log equals that of another one or a beginning of
    /// it: the longest counts, but none that is excluded before one that is not. Earlier parts of a recording are read
    /// with the last part. An excluded recording that cannot be read is left out. Errors: a path is neither a recording nor
    /// a folder with recordings; a recording has no readable header; two recordings count for one trial of a plan, or a live and a simulated one for
    /// one participant of it; the codes of two participants differ in capital
    /// letters only; or codes of raters, or a correction, stand beside a copy alone.
    pub fn find(paths: &[PathBuf]) -> FileResult<GatheredRecordings> {
        let mut found = Vec::new();
        for path in paths {
            // A recording that is not there is reported when it is opened.
            let is_folder = path.is_dir() && !path.join(LOG_NAME).exists();
            found.extend(if is_folder { recordings::of_folder(path)? } else { vec![path.clone()] });
        }
        let damaged = parallel::each(&found, |path| excluded_and_damaged(path), || ());
        let damaged = damaged.into_iter().collect::<FileResult<Vec<_>>>()?;
        let mut is_whole = damaged.iter().map(Option::is_none);
        found.retain(|_| is_whole.next().unwrap_or(true));
        let foreign = damaged.into_iter().flatten().collect();
        let opened = whole(parallel::each(&found, |path| FoundRecording::open(path), || ()))?;
        // The recording that counts must not depend on the order of the paths.
        let mut order: Vec<usize> = (0..opened.len()).collect();
        order.sort_by_key(|&index| (found[index].file_name(), &found[index]));
        check_codes(&opened)?;
        // By its log: the recording of which a log is the last part, and that of which it is an earlier part.
        let (mut lasts, mut earlier, mut logs) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        for &index in &order {
            for place in opened[index].earlier() {
                earlier.entry(&place.0).or_insert_with(|| {
                    logs.push(place);
                    index
                });
            }
        }
        for &index in &order {
            let place = &opened[index].logs[opened[index].logs.len() - 1];
            if !earlier.contains_key(&place.0) {
                lasts.entry(&place.0).or_insert_with(|| {
                    logs.push(place);
                    index
                });
            }
        }
        let keys: Vec<(&Path, &str)> = logs.iter().map(|(log, header)| (log.as_path(), header.as_str())).collect();
        let mut copies = BTreeMap::new();
        for same in SameLogs::of(&keys)? {
            let all: Vec<&PathBuf> = same.all().map(|log| &logs[log].0).collect();
            let mut recordings: Vec<usize> = all.iter().filter_map(|log| lasts.get(*log).copied()).collect();
            let part = all.iter().find_map(|log| Some((*earlier.get(*log)?, folder(log))));
            if recordings.len() + usize::from(part.is_some()) < 2 {
                continue;
            }
            let mut excluded = BTreeMap::new();
            for &index in &recordings {
                let ruling = ruling(folder(opened[index].log()))?.filter(|ruling| ruling.excluded);
                excluded.insert(index, ruling.map(|ruling| format!("excluded: {}", ruling.reason)));
            }
            let (first, beside) = match part {
                Some(part) => part,
                None => {
                    let is_whole = |index: usize| same.longest.iter().any(|&log| logs[log].0 == *opened[index].log());
                    let mut ranks = BTreeMap::new();
                    for &index in &recordings {
                        let codes = code_files(folder(opened[index].log()))?.len();
                        // Copies are named by whoever made them: "copy", "Copy of seed7-S001".
                        let name = (!opened[index].is_named, folder_name(opened[index].log()).len());
                        ranks.insert(index, (excluded[&index].is_some(), !is_whole(index), Reverse(codes), name));
                    }
                    // The sort is stable, so that the first by name counts among equal ones.
                    recordings.sort_by_key(|index| ranks[index]);
                    let first = recordings.remove(0);
                    (first, folder(opened[first].log()))
                }
            };
            for index in recordings {
                let left_out = excluded.remove(&index).flatten();
                copies.insert(index, opened[index].copy_of(&opened[first], beside, left_out)?);
            }
        }
        let kept: BTreeSet<usize> = lasts.into_values().filter(|index| !copies.contains_key(index)).collect();
        let mut trials = BTreeMap::new();
        for &index in order.iter().filter(|index| kept.contains(index)) {
            if let Some(trial) = &opened[index].trial {
                trials.entry(trial).or_insert_with(Vec::new).push(index);
            }
        }
        for (trial, recordings) in trials.iter().filter(|(_, recordings)| recordings.len() > 1) {
            let mut first: Option<&Path> = None;
            for &index in recordings {
                let path = &opened[index].path;
                if standing::left_out(path)?.is_some() {
                    continue;
                }
                if let Some(first) = first {
                    let (found, remedy) = trial.counted_twice(&first.display().to_string());
                    return Err(FileError::from_finding(path, found, remedy));
                }
                first = Some(path);
            }
        }
        check_kinds(&opened, &trials)?;
        let places = kept.iter().map(|&index| opened[index].place.clone()).collect();
        let paths = kept.into_iter().map(|index| opened[index].path.clone()).collect();
        let copies = order.iter().filter_map(|index| copies.remove(index)).collect();
        Ok(GatheredRecordings { paths, places, copies, foreign })
    }

    /// Without the recordings of no plan beside those of a plan, and without simulated ones beside those of people. `plans`:
    /// names of the plans that are meant; empty: all.
    pub fn without_foreign(self, plans: &[String]) -> GatheredRecordings {
        let GatheredRecordings { paths, places, copies, mut foreign } = self;
        let has_plan = places.iter().any(|place| place.plan.is_some());
        let is_of_plan = |place: &GatheredPlace| match &place.plan {
            Some(plan) => plans.is_empty() || plans.contains(plan),
            None => !has_plan,
        };
        let has_people = places.iter().any(|place| is_of_plan(place) && !place.is_simulated);
        let mut kept = (Vec::new(), Vec::new());
        for (path, place) in paths.into_iter().zip(places) {
            let reason = match (is_of_plan(&place), &place.plan) {
                (true, _) if has_people && place.is_simulated => ForeignReason::Simulated,
                (true, _) => {
                    kept.0.push(path);
                    kept.1.push(place);
                    continue;
                }
                (false, None) => ForeignReason::NoPlan,
                // The user names the plans that are meant.
                (false, Some(_)) => continue,
            };
            foreign.push(ForeignRecording { reason, recording: name(&path), excluded: None });
        }
        foreign.sort();
        GatheredRecordings { paths: kept.0, places: kept.1, copies, foreign }
    }

    /// These, and then the others. Errors: a recording, or a copy of it, is among both.
    pub fn beside(&self, others: &GatheredRecordings) -> FileResult<Vec<PathBuf>> {
        let all = [&self.paths[..], &others.paths].concat();
        let once = GatheredRecordings::find(&all)?;
        match others.paths.iter().chain(&self.paths).find(|path| !once.paths.contains(path)) {
            None => Ok(all),
            Some(path) => {
                let found = "a recording that is named for two purposes".to_string();
                Err(FileError::from_finding(path, found, "each recording once".to_string()))
            }
        }
    }
}

impl FoundRecording {
    fn open(path: &Path) -> FileResult<FoundRecording> {
        let log = LogReader::open(path)?;
        let place = |log: PathBuf| {
            let unreadable = |reason| FileError::unreadable(&log, reason, "a readable recording");
            let digest = header_digest(&log)?;
            Ok((log.canonicalize().map_err(unreadable)?, digest))
        };
        let logs = log.logs().into_iter().map(place).collect::<FileResult<Vec<LogPlace>>>()?;
        let (participant, recorded_code) = (&log.header.session.participant, log.header.recorded_code());
        let seed = log.header.started.is_none().then_some(log.header.session.seed);
        let trial = PlannedTrialKey::new(&RecordedPlan::from_header(&log.header), seed);
        let is_named = logs.last().is_some_and(|(log, _)| folder_name(log).contains(recorded_code));
        let plan = log.header.session.step.as_ref().map(|step| step.plan_of_study().to_string());
        let is_simulated = participant.kind == ParticipantKind::Simulated;
        let place = GatheredPlace { code: participant.code.clone(), plan, is_simulated };
        Ok(FoundRecording { path: path.to_path_buf(), logs, place, is_named, trial })
    }

    fn log(&self) -> &PathBuf {
        &self.logs[self.logs.len() - 1].0
    }

    fn earlier(&self) -> &[LogPlace] {
        &self.logs[..self.logs.len() - 1]
    }

    /// This recording as a copy of another one, or of an earlier part of that; `beside` is the folder of the same log. What
    /// stands beside a copy that is `left_out` does not count either.
    fn copy_of(&self, first: &FoundRecording, beside: &Path, left_out: Option<String>) -> FileResult<RecordingCopy> {
        let [recording, copy_of] = [self, first].map(|one| one.path.display().to_string());
        let wrong = |(found, remedy): (String, String)| Err(FileError::from_finding(&self.path, found, remedy));
        if left_out.is_none() {
            if self.place.code != first.place.code {
                let found = format!(
                    "a copy of {copy_of} that is a recording of {}, not of {}",
                    self.place.code, first.place.code
                );
                let remedy = "one code of both (tomcom correct RECORDING --code CODE --reason …, or --undo); or leave this copy \
                              out: tomcom exclude RECORDING --reason …";
                return wrong((found, remedy.to_string()));
            }
            if let Some(codes) = differing_codes(folder(self.log()), beside)? {
                return wrong(copy_with_codes(&recording, &copy_of, codes));
            }
        }
        Ok(RecordingCopy { recording, copy_of, left_out })
    }
}

/// The recording at this path if it is excluded and cannot be read.
fn excluded_and_damaged(path: &Path) -> FileResult<Option<ForeignRecording>> {
    let beside = if path.is_dir() { path } else { path.parent().unwrap_or(path) };
    let ruling = ruling(beside)?.filter(|ruling| ruling.excluded && standing::left_out(path).is_err());
    let foreign =
        |reason| ForeignRecording { reason: ForeignReason::Damaged, recording: name(path), excluded: Some(reason) };
    Ok(ruling.map(|ruling| foreign(ruling.reason)))
}

/// What was read of recordings. Errors: at least one could not be read; the error names all of these.
pub(crate) fn whole<T>(read: Vec<FileResult<T>>) -> FileResult<Vec<T>> {
    let wrong: Vec<&FileError> = read.iter().filter_map(|one| one.as_ref().err()).collect();
    let [first, _, ..] = wrong[..] else { return read.into_iter().collect() };
    let words: Vec<String> = wrong.iter().map(|error| error.to_string()).collect();
    let found =
        format!("{} with errors: {}", count(wrong.len() as u64, "recording", "recordings"), named(&words, NAMED));
    Err(FileError::from_finding(Path::new("the recordings"), found, first.remedy()))
}

/// The name of a recording's folder.
pub(crate) fn name(recording: &Path) -> String {
    let typed = recording.file_name().map(|name| name.to_string_lossy().into_owned());
    typed.unwrap_or_else(|| recording.display().to_string())
}

fn folder_name(log: &Path) -> Cow<'_, str> {
    folder(log).file_name().unwrap_or_default().to_string_lossy()
}

fn folder(log: &Path) -> &Path {
    log.parent().unwrap_or(Path::new("."))
}

/// In a plan, a code is that of a person or of a simulated participant, not of both. `trials`: indices of the recordings of
/// each trial.
fn check_kinds(opened: &[FoundRecording], trials: &BTreeMap<&PlannedTrialKey, Vec<usize>>) -> FileResult<()> {
    let all: Vec<(&PlannedTrialKey, &FoundRecording)> =
        trials.iter().flat_map(|(trial, found)| found.iter().map(|&index| (*trial, &opened[index]))).collect();
    // The trials of a code in a plan follow one another, those that were recorded live first.
    for of_code in all.chunk_by(|(a, _), (b, _)| a.is_of_code_of(b)) {
        let is_mixed = |one: &(&PlannedTrialKey, &FoundRecording)| one.0.is_mixed_with(of_code[0].0);
        if !of_code.iter().any(is_mixed) {
            continue;
        }
        let counted = |mixed: bool| {
            of_code.iter().filter(|one| is_mixed(one) == mixed).find_map(|one| match standing::left_out(&one.1.path) {
                Ok(Some(_)) => None,
                Ok(None) => Some(Ok(*one)),
                Err(error) => Some(Err(error)),
            })
        };
        if let (Some(live), Some(simulated)) = (counted(false).transpose()?, counted(true).transpose()?) {
            let (found, remedy) = simulated.0.mixed_with(&live.1.path.display().to_string());
            return Err(FileError::from_finding(&simulated.1.path, found, remedy));
        }
    }
    Ok(())
}

/// One of them was probably typed wrong, and other programs would make one person of them, or two.
fn check_codes(opened: &[FoundRecording]) -> FileResult<()> {
    let mut codes: BTreeMap<&str, &Path> = BTreeMap::new();
    for one in opened {
        if let Some(other) = person_code::differing_in_case(&one.place.code, codes.keys().copied()) {
            let first = codes[other].display();
            let found = format!("a recording of {}, beside {first}, which is one of {other}", one.place.code);
            let remedy = "one code of one participant: tomcom correct RECORDING --code CODE --reason …".to_string();
            return Err(FileError::from_finding(&one.path, found, remedy));
        }
        codes.entry(&one.place.code).or_insert(&one.path);
    }
    Ok(())
}
