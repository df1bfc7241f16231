//! Filter and cursor of every list: arrows or typing find the row, enter takes it, esc goes back. The space bar is the robot stop, so
//! the filter has no spaces, and rows are searched without theirs.

use crossterm::event::KeyCode;

/// How far a page key goes.
const PAGE: usize = 10;

/// Filter and cursor of an open list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ListCursor {
    /// What was typed.
    pub filter: String,
    /// The row under the cursor, of those that are left.
    pub at: usize,
}

/// What came of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListReply {
    /// The list stays open.
    Open,
    /// It was left.
    Left,
    /// The row under the cursor was taken.
    Taken,
}

impl ListCursor {
    /// Takes a key, with `rows` rows left.
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
            // Signs are not searched, so a question mark does not empty the list.
            KeyCode::Char(letter) if letter.is_alphanumeric() => self.filter.push(letter),
            _ => {}
        }
        self.at = if self.filter.len() == before { self.at.min(last) } else { 0 };
        ListReply::Open
    }

    /// Whether a row with this text is left: its letters and digits contain what was typed, or what was typed is made of
    /// beginnings of its words in their order ("traw" for "tuna raw").
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

/// Whether `wanted` is made of beginnings of some of these words, in their order.
fn begins(words: &[Vec<char>], wanted: &[char]) -> bool {
    let Some((word, rest)) = words.split_first() else { return wanted.is_empty() };
    let common = word.iter().zip(wanted).take_while(|(letter, typed)| letter == typed).count();
    wanted.is_empty() || (0..=common).any(|taken| begins(rest, &wanted[taken..]))
}
