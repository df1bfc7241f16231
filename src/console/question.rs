//! A question before a recording begins, when there is no session yet that could be drawn.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// A question with numbered answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuestionPage {
    pub title: String,
    /// Paragraphs.
    pub text: Vec<String>,
    /// The first has the key 1.
    pub answers: Vec<String>,
}

/// What a key answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuestionReply {
    /// The place of the answer, from 0.
    Answer(usize),
    /// The program is left.
    Leave,
}

impl QuestionPage {
    /// What this key answers; nothing, if it means nothing here or is only held down.
    pub fn reply(&self, key: &KeyEvent) -> Option<QuestionReply> {
        if key.kind != KeyEventKind::Press {
            return None;
        }
        match key.code {
            KeyCode::Esc => Some(QuestionReply::Leave),
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(QuestionReply::Leave),
            KeyCode::Char(digit @ '1'..='9') => {
                let index = usize::from(digit as u8 - b'1');
                (index < self.answers.len()).then_some(QuestionReply::Answer(index))
            }
            _ => None,
        }
    }
}
