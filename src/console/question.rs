//! A question before a recording begins, while there is no session to draw.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// A question with numbered answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct QuestionPage {
    /// The heading.
    pub title: String,
    /// Paragraphs.
    pub text: Vec<String>,
    /// Answers; key 1 selects the first.
    pub answers: Vec<String>,
}

/// Reply to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuestionReply {
    /// Index of the chosen answer.
    Answer(usize),
    /// Quit the program.
    Leave,
}

impl QuestionPage {
    /// The reply of a key; `None` for other keys and for key repeat.
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
