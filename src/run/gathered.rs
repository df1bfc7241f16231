//! Recordings that a command reads together: each trial is there once.
//!
//! A folder of recordings can hold copies, such as those that a file manager or a sync program made, and two folders can
//! hold the same trial. Counted twice, a trial would make every figure wrong without a word.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::{parallel, standing};
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::{LOG_NAME, LogReader, decisions, log_digest};
use crate::edge::recordings;
use crate::session::{LogHeader, person_code};
use crate::study::planned_trial::{PlannedTrialKey, RecordingCopy, differing_copy};
use crate::study::preregistration::RecordedPlan;

/// Recordings without copies, of which no two count for one trial of a plan.
#[derive(Clone, Debug, Default)]
pub struct GatheredRecordings {
    /// Paths of the recordings, in the order in which they were named; those of a folder are sorted by name.
    pub paths: Vec<PathBuf>,
    /// Recordings that were left out, since they are copies.
    pub copies: Vec<RecordingCopy>,
}

/// A log of a recording: its path without symbolic links, and its length in bytes.
type LogPlace = (PathBuf, u64);

/// What is known about a recording before its events are read.
struct FoundRecording {
    path: PathBuf,
    /// Logs of the recording's parts, the last part last.
    logs: Vec<LogPlace>,
    /// The participant's code.
    code: String,
    trial: Option<PlannedTrialKey>,
}

impl GatheredRecordings {
    /// Finds the recordings at these paths: recordings, their logs, or folders of recordings. A recording to which
    /// several paths lead is there once, and so is a recording whose log equals that of another one. Earlier parts of a
    /// recording are read with the last part.
    ///
    /// # Errors
    /// A path is neither a recording nor a folder with recordings; a recording has no readable header; two recordings
    /// count for one trial of a plan; the codes of two participants differ in capital letters only; or a copy has other
    /// decisions beside its log.
    pub fn find(paths: &[PathBuf]) -> FileResult<GatheredRecordings> {
        let mut found = Vec::new();
        for path in paths {
            // A recording that is not there is reported when it is opened.
            let is_folder = path.is_dir() && !path.join(LOG_NAME).exists();
            found.extend(if is_folder { recordings::of_folder(path)? } else { vec![path.clone()] });
        }
        let opened = parallel::each(&found, |path| FoundRecording::open(path), || ());
        let opened = opened.into_iter().collect::<FileResult<Vec<_>>>()?;
        // The recording that counts must not depend on the order of the paths.
        let mut order: Vec<usize> = (0..opened.len()).collect();
        order.sort_by_key(|&index| (found[index].file_name(), &found[index]));
        let digests = digests(&opened)?;
        let earlier: BTreeSet<&PathBuf> = opened.iter().flat_map(FoundRecording::earlier).map(|(log, _)| log).collect();
        // By the digest of a log: the recording that the log is the last part of, or an earlier part, and its folder.
        let mut logs: BTreeMap<&String, (usize, &Path)> = BTreeMap::new();
        for (index, one) in opened.iter().enumerate() {
            let alike = one.earlier().iter().filter_map(|(log, _)| Some((digests.get(log)?, folder(log))));
            logs.extend(alike.map(|(digest, folder)| (digest, (index, folder))));
        }
        check_codes(&opened)?;
        let (mut places, mut trials) = (BTreeSet::new(), BTreeMap::new());
        let (mut kept, mut copies) = (BTreeSet::new(), Vec::new());
        for index in order {
            let one = &opened[index];
            if !places.insert(one.log()) || earlier.contains(one.log()) {
                continue;
            }
            if let Some(digest) = digests.get(one.log()) {
                if let Some(&(first, beside)) = logs.get(digest) {
                    copies.push(one.copy_of(&opened[first], beside)?);
                    continue;
                }
                logs.insert(digest, (index, folder(one.log())));
            }
            kept.insert(index);
            if let Some(trial) = &one.trial {
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
        let paths = kept.into_iter().map(|index| opened[index].path.clone()).collect();
        Ok(GatheredRecordings { paths, copies })
    }

    /// These recordings, and then the others, of which none may be among these.
    ///
    /// # Errors
    /// A recording, or a copy of it, is among both.
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
            let length = fs::metadata(&log).map_err(unreadable)?.len();
            Ok((log.canonicalize().map_err(unreadable)?, length))
        };
        let logs = log.logs().into_iter().map(place).collect::<FileResult<Vec<LogPlace>>>()?;
        let code = log.header.session.participant.code.clone();
        Ok(FoundRecording { path: path.to_path_buf(), logs, code, trial: planned_trial(&log.header) })
    }

    /// The log of the recording's last part.
    fn log(&self) -> &PathBuf {
        &self.logs[self.logs.len() - 1].0
    }

    /// The logs of the parts before the last one.
    fn earlier(&self) -> &[LogPlace] {
        &self.logs[..self.logs.len() - 1]
    }

    /// This recording as a copy of another one, or of an earlier part of that; `beside` is the folder of the same log.
    fn copy_of(&self, first: &FoundRecording, beside: &Path) -> FileResult<RecordingCopy> {
        let [recording, copy_of] = [self, first].map(|one| one.path.display().to_string());
        if decisions(folder(self.log()))? != decisions(beside)? {
            let (found, remedy) = differing_copy(&copy_of);
            return Err(FileError::from_finding(&self.path, found, remedy));
        }
        Ok(RecordingCopy { recording, copy_of })
    }
}

fn folder(log: &Path) -> &Path {
    log.parent().unwrap_or(Path::new("."))
}

/// The trial of a plan of which a log with this header is a recording.
pub(super) fn planned_trial(header: &LogHeader) -> Option<PlannedTrialKey> {
    let seed = header.started.is_none().then_some(header.session.seed);
    PlannedTrialKey::new(&RecordedPlan::from_header(header), seed)
}

/// Checks that no two codes differ in capital letters only: one of them was probably typed wrong, and other programs
/// would make one person of them, or two.
fn check_codes(opened: &[FoundRecording]) -> FileResult<()> {
    let mut codes: BTreeMap<&str, &Path> = BTreeMap::new();
    for one in opened {
        if let Some(other) = person_code::differing_in_case(&one.code, codes.keys().copied()) {
            let first = codes[other].display();
            let found = format!("a recording of {}, beside {first}, which is one of {other}", one.code);
            let remedy = "one code of one participant: tomcom correct RECORDING --code CODE --why …".to_string();
            return Err(FileError::from_finding(&one.path, found, remedy));
        }
        codes.entry(&one.code).or_insert(&one.path);
    }
    Ok(())
}

/// Digests of the logs that are as long as another log; no other log can equal another one.
fn digests(opened: &[FoundRecording]) -> FileResult<BTreeMap<PathBuf, String>> {
    let all: BTreeSet<&LogPlace> = opened.iter().flat_map(|one| &one.logs).collect();
    let mut lengths: BTreeMap<u64, usize> = BTreeMap::new();
    all.iter().for_each(|(_, length)| *lengths.entry(*length).or_default() += 1);
    let alike: Vec<&PathBuf> = all.iter().filter(|(_, length)| lengths[length] > 1).map(|(log, _)| log).collect();
    let read = parallel::each(&alike, |log| Ok(((*log).clone(), log_digest(log)?)), || ());
    read.into_iter().collect()
}
