//! The list of recordings of a folder, and how the user chooses one from it.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use super::error::ReviewError;
use super::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use super::operator_station::OperatorStation;
use crate::console::ConsoleMessage;
use crate::console::lists::{ListChoice, RecordingPicker};
use crate::console::mouse::ClickAction;
use crate::console::view::recordings_page::recording_targets;
use crate::console::view::theme::Theme;
use crate::run::list_cache::{CachedRecordingNumbers, ClosedLogHeader, ListCache};
use crate::run::terminal::TerminalScreen;
use tomcom_core::measures::errors::PressJudge;
use tomcom_session::apply;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::LogReader;
use tomcom_session::settings::ConsoleSpec;
use tomcom_study::analysis::recording_summary::{
    ExclusionStatus, ListedPlace, ListedRecording, RecordingKind, RecordingList, RecordingState,
};
use tomcom_study::files::recordings;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::{parallel, standing};

/// Which information a list of recordings contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingListDetail {
    /// The list has everything, but of errors only numbers in the cache: to count them takes longest.
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
    let unreadable = |error: FileError| {
        // A ruling that cannot be read either is no exclusion.
        let standing = standing::with_ruling(ExclusionStatus::default(), path).unwrap_or_default();
        let (state, reason) = match standing.counts() {
            true => (RecordingState::Unreadable, error.with_remedy()),
            false => (RecordingState::Excluded, format!("{}; unreadable: {error}", standing.describe())),
        };
        ListedRecording {
            recording: name(path),
            code: LogReader::open(path).ok().map(|log| log.header.session.participant.code),
            condition: None,
            arm: None,
            date: None,
            trial_s: None,
            errors: None,
            kind: None,
            place: None,
            state,
            reason: Some(reason),
        }
    };
    let glance = ClosedLogHeader::read(path);
    if let Some(glance) = &glance
        && let Some(figures) = cache.figures(&glance.digest)
    {
        return (from_figures(path, glance, figures).unwrap_or_else(unreadable), None);
    }
    match read(path, depth, cost) {
        Ok(row) => {
            // The words of an exclusion are not kept.
            let glance = glance.filter(|_| row.state != RecordingState::Excluded);
            let new = glance.zip(row.arm.zip(row.trial_s).zip(row.errors.zip(row.kind)));
            let new = new.map(|(glance, ((arm, trial_s), (errors, kind)))| {
                (glance.digest, CachedRecordingNumbers { arm, trial_s, errors, kind, state: row.state })
            });
            (row, new)
        }
        Err(error) => (unreadable(error), None),
    }
}

/// The list's row of a closed recording whose numbers are in the cache.
fn from_figures(path: &Path, glance: &ClosedLogHeader, figures: CachedRecordingNumbers) -> FileResult<ListedRecording> {
    let standing = standing::with_ruling(ExclusionStatus::default(), path)?;
    let is_excluded = !standing.counts();
    Ok(ListedRecording {
        recording: name(path),
        code: Some(glance.code.clone()),
        condition: Some(glance.condition),
        arm: Some(figures.arm),
        date: glance.date.clone(),
        trial_s: Some(figures.trial_s),
        errors: Some(figures.errors),
        kind: Some(figures.kind),
        place: glance.place.clone(),
        state: if is_excluded { RecordingState::Excluded } else { figures.state },
        reason: is_excluded.then(|| standing.describe()),
    })
}

/// Applies all events of a recording; `cost` is kept for the next recording of the same kitchen.
fn read(path: &Path, depth: RecordingListDetail, cost: &mut KeptCost) -> FileResult<ListedRecording> {
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
    let standing = standing::with_ruling(ExclusionStatus::at_console(&session), log.folder())?;
    let state = RecordingState::from_session(&session, log.ending(), &standing);
    Ok(ListedRecording {
        recording: name(path),
        code: Some(session.spec.participant.code.clone()),
        condition: Some(session.spec.trial.condition),
        arm: Some(session.study_arm()),
        date: log.header.started.clone(),
        trial_s: Some(session.trial_clock(session.time).as_secs_f64()),
        errors: (depth == RecordingListDetail::WithErrors).then_some(errors),
        kind: Some(RecordingKind::from_spec(&session.spec)),
        place: ListedPlace::from_spec(&session.spec),
        state,
        reason: (state == RecordingState::Excluded).then(|| standing.describe()),
    })
}

/// Period of redrawing the list of recordings, in case the terminal's size changed.
const REDRAW: Duration = Duration::from_millis(100);

/// Asks the person which recording of the folder to use; `None` if the person chooses no recording. `does`: what is done
/// with it. While the recordings are read, the page says so and takes what is typed.
///
/// # Errors
/// The folder cannot be read or has no recordings, or there is no terminal.
pub fn pick(folder: &Path, does: &'static str) -> Result<Option<PathBuf>, ReviewError> {
    let number = recordings::of_folder(folder)?.len();
    let headings = RecordingList::HEADINGS.map(str::to_string).to_vec();
    let title = format!("Which recording of {}?", folder.display());
    let picker = RecordingPicker { reading: Some(number), ..RecordingPicker::new(title, headings, Vec::new(), does) };
    let (tell, read) = channel();
    let folder = folder.to_path_buf();
    // Nobody waits for the list of a person who has left.
    thread::spawn(move || drop(tell.send(newest_first(&folder))));
    event_loop::in_runtime(async {
        let mut station = OperatorStation::without_devices(&ConsoleSpec::default())?;
        let mut shell = OpenPicker { picker, read, paths: Vec::new(), theme: station.theme, dirty: true };
        let chosen = event_loop::run(&mut shell, &mut station).await?;
        Ok(match chosen {
            Some(ListChoice::Chosen(index)) => shell.paths.into_iter().nth(index),
            Some(ListChoice::Leave) | None => None,
        })
    })
}

/// Rows of the page, and the recordings' folders.
type PickedRows = (Vec<Vec<String>>, Vec<PathBuf>);

fn newest_first(folder: &Path) -> FileResult<PickedRows> {
    let (list, paths) = list(folder, RecordingListDetail::Quick, |_| (), || ())?;
    let mut newest: Vec<(ListedRecording, PathBuf)> = list.recordings.into_iter().zip(paths).collect();
    newest.sort_by(|(one, _), (other, _)| (&other.date, &other.recording).cmp(&(&one.date, &one.recording)));
    Ok(newest.into_iter().map(|(one, path)| (one.cells().to_vec(), path)).unzip())
}

/// A list of recordings from which none has been chosen yet.
struct OpenPicker {
    picker: RecordingPicker,
    /// The rows, once they are read.
    read: Receiver<FileResult<PickedRows>>,
    paths: Vec<PathBuf>,
    theme: Theme,
    /// Whether the list of recordings has to be redrawn.
    dirty: bool,
}

impl OpenPicker {
    fn click(&mut self, cell: (u16, u16)) -> Option<ListChoice> {
        let size = TerminalScreen::size().ok()?;
        let targets = recording_targets(&self.picker, self.theme, size);
        let target = targets.iter().rev().find(|target| target.cells.contains(cell.into()))?;
        match target.action {
            ClickAction::Row(row) => self.picker.click(row),
            ClickAction::Key(chord) => self.picker.take(chord.code),
            _ => None,
        }
    }
}

impl ConsoleShell for OpenPicker {
    type Outcome = ListChoice;
    type Error = ReviewError;

    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines { frame_after: if self.dirty { FRAME } else { REDRAW }, ..ShellDeadlines::default() }
    }

    fn take(&mut self, event: LoopEvent) -> Result<Option<ListChoice>, ReviewError> {
        if let Ok(read) = self.read.try_recv() {
            (self.picker.rows, self.paths) = read?;
            (self.picker.reading, self.dirty) = (None, true);
        }
        let LoopEvent::Terminal(message) = event else { return Ok(None) };
        self.dirty = true;
        Ok(match message {
            ConsoleMessage::Key(key) => self.picker.key(&key),
            ConsoleMessage::Click(column, row) => self.click((column, row)),
            ConsoleMessage::Wheel(_, _, steps) => {
                self.picker.scroll(steps);
                None
            }
            ConsoleMessage::Paste(text) => {
                self.picker.cursor.paste(&text.unwrap_or_default());
                None
            }
            _ => None,
        })
    }

    fn view(&self) -> ShellView<'_> {
        ShellView::Recordings(&self.picker, self.theme)
    }

    fn drawn(&mut self) {
        self.dirty = false;
    }
}
