//! Lets a person at a terminal choose one recording from a folder.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::desk::OperatorDesk;
use super::error::{ReviewError, TerminalError};
use super::event_loop::{self, ConsoleShell, FRAME, LoopEvent, ShellDeadlines, ShellView};
use super::recording_list::{self, RecordingListDetail};
use crate::console::ConsoleMessage;
use crate::console::lists::{RecordingPicker, RecordingReply};
use crate::console::mouse::ClickAction;
use crate::console::view::recordings_page::recording_targets;
use crate::console::view::theme::Theme;
use crate::edge::terminal::TerminalScreen;
use tomcom_session::settings::ConsoleSpec;
use tomcom_study::analysis::recording_table::RecordingList;

/// Period of redrawing the list of recordings, in case the terminal's size changed.
const REDRAW: Duration = Duration::from_millis(100);

/// Asks the person which recording of the folder to use; `None` if the person chooses no recording.
///
/// # Errors
/// The folder cannot be read or has no recordings, or there is no terminal.
pub fn pick(folder: &Path) -> Result<Option<PathBuf>, ReviewError> {
    let (list, paths) = recording_list::list(folder, RecordingListDetail::Quick, |_| (), || ())?;
    // The list has no column of errors here, since counting errors takes long.
    let without_errors = |cells: [String; 7]| {
        let [code, condition, date, length, _, state, recording] = cells;
        vec![code, condition, date, length, state, recording]
    };
    let headings = without_errors(RecordingList::HEADINGS.map(str::to_string));
    let rows = list.recordings.iter().map(|one| without_errors(one.cells())).collect();
    let title = format!("Which recording of {}?", list.folder);
    let picker = RecordingPicker::new(title, headings, rows);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(TerminalError)?;
    let chosen = runtime.block_on(async {
        let mut desk = OperatorDesk::without_devices(&ConsoleSpec::default())?;
        let mut shell = OpenPicker { picker, theme: desk.theme, dirty: true };
        event_loop::run(&mut shell, &mut desk).await
    })?;
    Ok(match chosen {
        Some(RecordingReply::Chosen(index)) => paths.get(index).cloned(),
        Some(RecordingReply::Leave) | None => None,
    })
}

/// A list of recordings from which none has been chosen yet.
struct OpenPicker {
    picker: RecordingPicker,
    theme: Theme,
    /// Whether the list of recordings has to be redrawn.
    dirty: bool,
}

impl OpenPicker {
    /// Handles a mouse click on the list of recordings.
    fn click(&mut self, cell: (u16, u16)) -> Option<RecordingReply> {
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
    type Outcome = RecordingReply;
    type Error = ReviewError;

    fn deadlines(&mut self) -> ShellDeadlines {
        ShellDeadlines { frame_after: if self.dirty { FRAME } else { REDRAW }, ..ShellDeadlines::default() }
    }

    fn take(&mut self, event: LoopEvent) -> Result<Option<RecordingReply>, ReviewError> {
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
