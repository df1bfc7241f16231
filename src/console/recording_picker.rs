//! The list from which a recording is chosen: arrows or typing find it, enter opens it, esc leaves. As in the lists of a session, what is
//! typed has no spaces, and rows are searched without theirs.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

use super::picker::{moved, squeezed};

/// An open list of recordings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingPicker {
    /// What is asked.
    pub title: String,
    /// The headings of the columns.
    pub headings: Vec<String>,
    /// The cells of each recording.
    pub rows: Vec<Vec<String>>,
    /// What was typed.
    pub filter: String,
    /// The row under the cursor, of those that are left.
    pub at: usize,
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
        RecordingPicker { title, headings, rows, filter: String::new(), at: 0 }
    }

    /// Indices of the rows that have all of what was typed in one of their cells, or across neighbouring cells.
    pub fn left(&self) -> Vec<usize> {
        let wanted = squeezed(&self.filter);
        (0..self.rows.len()).filter(|&row| squeezed(&self.rows[row].concat()).contains(&wanted)).collect()
    }

    /// Takes a key.
    pub fn key(&mut self, key: &KeyEvent) -> Option<RecordingReply> {
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let left = self.left();
        let last = left.len().saturating_sub(1);
        self.at = moved(self.at, last, key.code);
        match key.code {
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => return Some(RecordingReply::Leave),
            KeyCode::Char(letter) if letter != ' ' && !key.modifiers.contains(KeyModifiers::CONTROL) => {
                self.filter.push(letter);
                self.at = 0;
            }
            KeyCode::Backspace => {
                self.filter.pop();
                self.at = 0;
            }
            KeyCode::Esc if !self.filter.is_empty() => {
                self.filter.clear();
                self.at = 0;
            }
            KeyCode::Esc => return Some(RecordingReply::Leave),
            KeyCode::Enter if key.kind == KeyEventKind::Press => {
                return left.get(self.at).map(|&row| RecordingReply::Chosen(row));
            }
            _ => {}
        }
        None
    }
}
