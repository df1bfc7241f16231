//! A question to the user before a recording begins, when there is no session to draw.

use crossterm::event::{KeyCode, KeyEvent, KeyEventKind, KeyModifiers};

/// A question to the user with numbered answers, shown before a recording begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StartQuestion {
    /// Heading of the question to the user.
    pub title: String,
    /// Text of the question, as paragraphs.
    pub text: Vec<String>,
    /// Texts of the answers; key 1 selects the first.
    pub answers: Vec<String>,
}

/// Reply of the user to a question before a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartQuestionReply {
    /// Index of the answer that the user selected.
    Answer(usize),
    /// The user quits the program.
    Leave,
}

impl StartQuestion {
    /// The reply that a key gives; `None` for other keys and for key repeat.
    pub fn reply(&self, key: &KeyEvent) -> Option<StartQuestionReply> {
        if key.kind != KeyEventKind::Press {
            return None;
        }
        match key.code {
            KeyCode::Esc => Some(StartQuestionReply::Leave),
            KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(StartQuestionReply::Leave),
            KeyCode::Char(digit @ '1'..='9') => {
                let index = usize::from(digit as u8 - b'1');
                (index < self.answers.len()).then_some(StartQuestionReply::Answer(index))
            }
            _ => None,
        }
    }
}
