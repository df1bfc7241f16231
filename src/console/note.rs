//! A line that can be edited: a note in words while the trial is paused, or an answer that is typed before or after a trial. Only here
//! the space bar types a space; no trial runs, and the robot stands.

use crossterm::event::KeyCode;

/// No line is longer, in characters.
const MOST: usize = 500;

/// A line of text with a cursor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextInput {
    letters: Vec<char>,
    at: usize,
}

impl TextInput {
    /// A line that holds this text, with the cursor behind it.
    pub fn with_text(text: &str) -> TextInput {
        let letters: Vec<char> = text.chars().take(MOST).collect();
        TextInput { at: letters.len(), letters }
    }

    /// Takes a key that edits.
    pub fn key(&mut self, code: KeyCode) {
        match code {
            KeyCode::Char(letter) if self.letters.len() < MOST && !letter.is_control() => {
                self.letters.insert(self.at, letter);
                self.at += 1;
            }
            KeyCode::Backspace if self.at > 0 => {
                self.at -= 1;
                self.letters.remove(self.at);
            }
            KeyCode::Delete if self.at < self.letters.len() => {
                self.letters.remove(self.at);
            }
            KeyCode::Left => self.at = self.at.saturating_sub(1),
            KeyCode::Right => self.at = (self.at + 1).min(self.letters.len()),
            KeyCode::Home => self.at = 0,
            KeyCode::End => self.at = self.letters.len(),
            _ => {}
        }
    }

    /// What was written.
    pub fn text(&self) -> String {
        self.letters.iter().collect::<String>().trim().to_string()
    }

    /// What stands before the cursor, under it, and after it, cut to `columns` around the cursor.
    pub fn parts(&self, columns: usize) -> [String; 3] {
        let room = columns.max(2) - 1;
        let first = (self.at + 1).saturating_sub(room);
        let last = (first + room).min(self.letters.len());
        let part = |from: usize, to: usize| self.letters[from.min(to)..to].iter().collect::<String>();
        let under = self.letters.get(self.at).copied().unwrap_or(' ').to_string();
        [part(first, self.at), under, part((self.at + 1).min(last), last)]
    }
}
