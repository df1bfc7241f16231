//! The list from which the user chooses a recording. Its keys are those of every list ([`super::list_cursor`]), except
//! that the space bar has no effect, since there is no robot to stop.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::list_cursor::{ListCursor, ListReply};

/// An open list from which the user chooses a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingPicker {
    /// Question above the list of recordings.
    pub title: String,
    /// Headings of the columns in the list of recordings.
    pub headings: Vec<String>,
    /// Cells of each recording's row.
    pub rows: Vec<Vec<String>>,
    /// Filter and cursor of the list.
    pub cursor: ListCursor,
}

/// Result of a key in the list of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingReply {
    /// The recording with this index in [`RecordingPicker::rows`] was chosen.
    Chosen(usize),
    /// The list was closed without a choice.
    Leave,
}

impl RecordingPicker {
    /// A list of recordings without a filter, with the cursor on its first row.
    pub fn new(title: String, headings: Vec<String>, rows: Vec<Vec<String>>) -> RecordingPicker {
        RecordingPicker { title, headings, rows, cursor: ListCursor::default() }
    }

    /// Indices of the rows that match the filter, within one cell or across neighbouring cells.
    pub fn left(&self) -> Vec<usize> {
        (0..self.rows.len()).filter(|&row| self.cursor.keeps(&self.rows[row].join(" "))).collect()
    }

    /// Handles a key in the list of recordings.
    pub fn key(&mut self, key: &KeyEvent) -> Option<RecordingReply> {
        let has_control = key.modifiers.contains(KeyModifiers::CONTROL);
        match (key.kind, key.code) {
            (KeyEventKind::Release, _) => None,
            (_, KeyCode::Char('c')) if has_control => Some(RecordingReply::Leave),
            // A held enter key does not open a recording.
            (KeyEventKind::Repeat, KeyCode::Enter) => None,
            (_, KeyCode::Char(_)) if has_control => None,
            (_, code) => self.take(code),
        }
    }

    /// Moves the cursor to a row of the list, counted among the rows that match the filter; chooses the row if the
    /// cursor was already there.
    pub fn click(&mut self, row: usize) -> Option<RecordingReply> {
        if self.cursor.at == row {
            return self.take(KeyCode::Enter);
        }
        self.cursor.at = row;
        None
    }

    /// Handles a turn of the mouse wheel by this number of steps upwards.
    pub fn scroll(&mut self, steps: i8) {
        self.take(if steps > 0 { KeyCode::Up } else { KeyCode::Down });
    }

    /// Handles a key in the list of recordings that is pressed without ctrl.
    pub fn take(&mut self, code: KeyCode) -> Option<RecordingReply> {
        let left = self.left();
        match self.cursor.key(left.len(), code) {
            ListReply::Open => None,
            ListReply::Left => Some(RecordingReply::Leave),
            ListReply::Taken => left.get(self.cursor.at).map(|&row| RecordingReply::Chosen(row)),
        }
    }
}
