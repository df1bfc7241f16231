//! Filter and cursor of every list at the console: arrow keys or typed text select a row, enter chooses it, esc closes
//! the list. The space bar stops the robot, so filters contain no spaces, and spaces in rows are ignored.

use crossterm::event::KeyCode;

/// Number of rows that the page up and page down keys move the cursor.
const PAGE: usize = 10;

/// Filter and cursor of an open list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ListCursor {
    /// Typed text by which the rows are filtered.
    pub filter: String,
    /// Index of the row under the cursor, among the rows that match the filter.
    pub at: usize,
}

/// Result of a key in an open list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListReply {
    /// The list stays open.
    Open,
    /// The list was closed without a choice.
    Left,
    /// The row under the cursor was chosen.
    Taken,
}

impl ListCursor {
    /// Handles a key, where `rows` rows match the filter.
    pub fn key(&mut self, rows: usize, code: KeyCode) -> ListReply {
        let last = rows.saturating_sub(1);
        let before = self.filter.len();
        match code {
            KeyCode::Up => self.at = self.at.saturating_sub(1),
            KeyCode::Down => self.at += 1,
            KeyCode::PageUp => self.at = self.at.saturating_sub(PAGE),
            KeyCode::PageDown => self.at += PAGE,
            KeyCode::Home => self.at = 0,
            KeyCode::End => self.at = last,
            KeyCode::Enter if self.at < rows => return ListReply::Taken,
            KeyCode::Esc if self.filter.is_empty() => return ListReply::Left,
            KeyCode::Esc => self.filter.clear(),
            KeyCode::Backspace => drop(self.filter.pop()),
            // Punctuation is not part of the filter, so that a question mark does not empty the list.
            KeyCode::Char(letter) if letter.is_alphanumeric() => self.filter.push(letter),
            _ => {}
        }
        self.at = if self.filter.len() == before { self.at.min(last) } else { 0 };
        ListReply::Open
    }

    /// Adds the letters and digits of a pasted text to the filter.
    pub fn paste(&mut self, text: &str) {
        self.filter.extend(text.chars().filter(|letter| letter.is_alphanumeric()));
        self.at = 0;
    }

    /// Whether a row with this text matches the filter: the row's letters and digits contain the filter, or the filter
    /// consists of beginnings of the row's words in their order ("traw" for "tuna raw").
    pub fn keeps(&self, text: &str) -> bool {
        let wanted: Vec<char> = self.filter.to_lowercase().chars().collect();
        let text = text.to_lowercase();
        let words: Vec<Vec<char>> = text
            .split(|letter: char| !letter.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(|word| word.chars().collect())
            .collect();
        let joined: Vec<char> = words.concat();
        wanted.is_empty() || joined.windows(wanted.len()).any(|part| part == wanted) || begins(&words, &wanted)
    }
}

/// Whether `wanted` consists of beginnings of some of these words, in their order.
fn begins(words: &[Vec<char>], wanted: &[char]) -> bool {
    let Some((word, rest)) = words.split_first() else { return wanted.is_empty() };
    let common = word.iter().zip(wanted).take_while(|(letter, typed)| letter == typed).count();
    wanted.is_empty() || (0..=common).any(|taken| begins(rest, &wanted[taken..]))
}
