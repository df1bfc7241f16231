//! The list from which a recording is chosen. Its keys are those of every list ([`super::list_cursor`]); there is no robot to stop, and
//! the space bar does nothing.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::list_cursor::{ListCursor, ListReply};

/// An open list of recordings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingPicker {
    /// What is asked.
    pub title: String,
    /// The headings of the columns.
    pub headings: Vec<String>,
    /// The cells of each recording.
    pub rows: Vec<Vec<String>>,
    /// Filter and cursor.
    pub cursor: ListCursor,
}

/// What came of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordingReply {
    /// The recording with this index in [`RecordingPicker::rows`].
    Chosen(usize),
    /// Nothing is chosen.
    Leave,
}

impl RecordingPicker {
    /// A list without a filter, with the cursor on its first row.
    pub fn new(title: String, headings: Vec<String>, rows: Vec<Vec<String>>) -> RecordingPicker {
        RecordingPicker { title, headings, rows, cursor: ListCursor::default() }
    }

    /// Indices of the rows that have all of what was typed in one of their cells, or across neighbouring cells.
    pub fn left(&self) -> Vec<usize> {
        (0..self.rows.len()).filter(|&row| self.cursor.keeps(&self.rows[row].join(" "))).collect()
    }

    /// Takes a key.
    pub fn key(&mut self, key: &KeyEvent) -> Option<RecordingReply> {
        let has_control = key.modifiers.contains(KeyModifiers::CONTROL);
        match (key.kind, key.code) {
            (KeyEventKind::Release, _) => None,
            (_, KeyCode::Char('c')) if has_control => Some(RecordingReply::Leave),
            // Only a press opens a recording, not a held key.
            (KeyEventKind::Repeat, KeyCode::Enter) => None,
            (_, KeyCode::Char(_)) if has_control => None,
            (_, code) => self.take(code),
        }
    }

    /// Goes to a row of those that are left; takes the row if the cursor was there.
    pub fn click(&mut self, row: usize) -> Option<RecordingReply> {
        if self.cursor.at == row {
            return self.take(KeyCode::Enter);
        }
        self.cursor.at = row;
        None
    }

    /// Turns the wheel by so many steps upwards.
    pub fn scroll(&mut self, steps: i8) {
        self.take(if steps > 0 { KeyCode::Up } else { KeyCode::Down });
    }

    /// Takes a key without control.
    pub fn take(&mut self, code: KeyCode) -> Option<RecordingReply> {
        let left = self.left();
        match self.cursor.key(left.len(), code) {
            ListReply::Open => None,
            ListReply::Left => Some(RecordingReply::Leave),
            ListReply::Taken => left.get(self.cursor.at).map(|&row| RecordingReply::Chosen(row)),
        }
    }
}
