//! Lists the recordings of a folder. Numbers about closed recordings are kept for the next list
//! ([`crate::edge::list_cache`]).

use std::path::{Path, PathBuf};

use crate::edge::list_cache::{CachedRecordingNumbers, ClosedLogHeader, ListCache};
use tomcom_core::measures::errors::PressJudge;
use tomcom_session::apply;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::{LogEnding, LogReader};
use tomcom_study::analysis::recording_summary::{ExclusionStatus, ListedRecording, RecordingList, RecordingState};
use tomcom_study::files::recordings;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::{parallel, standing};

/// Which information a list of recordings contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingListDetail {
    /// The list has everything but the number of errors, which takes longest to compute.
    Quick,
    /// The list has everything, including the number of errors.
    WithErrors,
}

/// List of the recordings at a path, which [`recordings::of_folder`] finds. Recordings that cannot be read are listed
/// as unreadable. `done` is called after each recording.
///
/// # Errors
/// The folder cannot be read, or there is no recording.
pub fn list(
    folder: &Path,
    depth: RecordingListDetail,
    begun: impl FnOnce(usize),
    done: impl Fn() + Sync,
) -> FileResult<(RecordingList, Vec<PathBuf>)> {
    let found = recordings::of_folder(folder)?;
    begun(found.len());
    let cache = ListCache::open();
    let read =
        parallel::each_with(&found, KeptCost::default, |cost, path| read_or_tell(path, depth, cost, &cache), done);
    let (rows, new): (Vec<ListedRecording>, Vec<_>) = read.into_iter().unzip();
    cache.keep(new.into_iter().flatten());
    let list = RecordingList::new(folder.display().to_string(), rows);
    let is_named = |path: &PathBuf, row: &ListedRecording| name(path) == row.recording;
    let path = |row| found.iter().find(|path| is_named(path, row)).cloned().unwrap_or_else(|| folder.to_path_buf());
    let paths = list.recordings.iter().map(path).collect();
    Ok((list, paths))
}

/// Name of a recording's folder: the last part of its path.
fn name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// Numbers about a recording that the cache does not have yet, with the digest of the recording's log.
type NewFigures = Option<(String, CachedRecordingNumbers)>;

fn read_or_tell(
    path: &Path,
    depth: RecordingListDetail,
    cost: &mut KeptCost,
    cache: &ListCache,
) -> (ListedRecording, NewFigures) {
    let unreadable = |error: FileError| ListedRecording {
        recording: name(path),
        code: None,
        condition: None,
        arm: None,
        date: None,
        trial_s: None,
        errors: None,
        state: RecordingState::Unreadable,
        reason: Some(error.with_remedy()),
    };
    let glance = ClosedLogHeader::read(path);
    if let Some(glance) = &glance
        && let Some(figures) = cache.figures(&glance.digest)
    {
        return (from_figures(path, depth, glance, figures).unwrap_or_else(unreadable), None);
    }
    match read(path, depth, cost) {
        Ok((row, at_console)) => {
            let glance = glance.filter(|_| at_console.counts());
            let new = glance.zip(row.arm.zip(row.trial_s).zip(row.errors));
            let new = new.map(|(glance, ((arm, trial_s), errors))| {
                (glance.digest, CachedRecordingNumbers { arm, trial_s, errors })
            });
            (row, new)
        }
        Err(error) => (unreadable(error), None),
    }
}

/// The list's row of a closed recording whose numbers are in the cache.
fn from_figures(
    path: &Path,
    depth: RecordingListDetail,
    glance: &ClosedLogHeader,
    figures: CachedRecordingNumbers,
) -> FileResult<ListedRecording> {
    let standing = standing::with_ruling(ExclusionStatus::default(), path)?;
    let is_excluded = !standing.counts();
    Ok(ListedRecording {
        recording: name(path),
        code: Some(glance.code.clone()),
        condition: Some(glance.condition),
        arm: Some(figures.arm),
        date: glance.date.clone(),
        trial_s: Some(figures.trial_s),
        errors: (depth == RecordingListDetail::WithErrors).then_some(figures.errors),
        state: if is_excluded { RecordingState::Excluded } else { RecordingState::Whole },
        reason: is_excluded.then(|| standing.describe()),
    })
}

/// Applies all events of a recording; `cost` is kept for the next recording of the same kitchen. Returns also whether
/// the trial was aborted or excluded at the console.
fn read(
    path: &Path,
    depth: RecordingListDetail,
    cost: &mut KeptCost,
) -> FileResult<(ListedRecording, ExclusionStatus)> {
    let mut log = LogReader::open(path)?;
    let mut session = log.session();
    let kitchen = session.kitchen.clone();
    let cost = cost.for_kitchen(&kitchen);
    let mut judge = PressJudge::new(kitchen);
    let mut errors = 0;
    while let Some(line) = log.next_line()? {
        let change = apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?.change;
        if depth == RecordingListDetail::WithErrors {
            let verdict = judge.note(cost, line.stamped.time, &change);
            errors += u64::from(verdict.is_some_and(|verdict| verdict.error));
            if let Some(pause) = session.probe_pause(&line.stamped) {
                judge.postpone(pause);
            }
        }
    }
    let at_console = ExclusionStatus::at_console(&session);
    let standing = standing::with_ruling(at_console.clone(), log.folder())?;
    let state = match log.ending() {
        LogEnding::Running => RecordingState::Running,
        _ if !standing.counts() => RecordingState::Excluded,
        LogEnding::Cut => RecordingState::Cut,
        LogEnding::Closed => RecordingState::Whole,
    };
    let row = ListedRecording {
        recording: name(path),
        code: Some(session.spec.participant.code.clone()),
        condition: Some(session.spec.trial.condition),
        arm: Some(session.study_arm()),
        date: log.header.started.clone(),
        trial_s: Some(session.trial_clock(session.time).as_secs_f64()),
        errors: (depth == RecordingListDetail::WithErrors).then_some(errors),
        state,
        reason: (state == RecordingState::Excluded).then(|| standing.describe()),
    };
    Ok((row, at_console))
}
