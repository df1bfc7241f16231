//! Single-line text input: the wizard's note or reason while no trial runs, or a typed answer before or after a trial.
//! Only here the space bar types a space instead of stopping the robot, since the robot stands.

use crossterm::event::KeyCode;

use super::actions::refuse;
use super::console_model::{ConsoleCommand, ConsoleModel, Dialog};
use super::form;
use super::lists::{OTHER_REASON, PickerKind};
use tomcom_session::Session;

/// Longest text that can be typed, in characters.
const MOST: usize = 500;

/// A text input of one line with a cursor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextInput {
    letters: Vec<char>,
    at: usize,
}

impl TextInput {
    /// A text input that holds this text, with the cursor at its end.
    pub fn with_text(text: &str) -> TextInput {
        let letters: Vec<char> = text.chars().take(MOST).collect();
        TextInput { at: letters.len(), letters }
    }

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

    /// Inserts pasted text, in which line breaks and other control characters become spaces.
    ///
    /// # Errors
    /// The text does not fit, and is not inserted.
    pub fn paste(&mut self, text: &str) -> Result<(), String> {
        let (text, room) = (text.trim_matches(['\r', '\n']).replace("\r\n", "\n"), MOST - self.letters.len());
        let letters: Vec<char> = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
        if letters.len() > room {
            let count = letters.len();
            return Err(format!("nothing pasted: the text has {count} characters, the field has room for {room}"));
        }
        self.letters.splice(self.at..self.at, letters.iter().copied());
        self.at += letters.len();
        Ok(())
    }

    /// The typed text, without spaces at its ends.
    pub fn text(&self) -> String {
        self.letters.iter().collect::<String>().trim().to_string()
    }

    /// The typed text before the cursor, under it, and after it, cut to `columns` around the cursor.
    pub fn parts(&self, columns: usize) -> [String; 3] {
        let room = columns.max(2) - 1;
        let first = (self.at + 1).saturating_sub(room);
        let last = (first + room).min(self.letters.len());
        let part = |from: usize, to: usize| self.letters[from.min(to)..to].iter().collect::<String>();
        let under = self.letters.get(self.at).copied().unwrap_or(' ').to_string();
        [part(first, self.at), under, part((self.at + 1).min(last), last)]
    }
}

/// Why pasted text is refused outside of a text field; `None` is a paste that had no end.
pub fn refusal_of_paste(text: Option<&str>) -> &'static str {
    match text {
        Some(_) => "pasted text is not taken for keys: paste only into a text field",
        None => "a paste did not end: its text is dropped",
    }
}

/// Handles pasted text; `None` is a paste that had no end.
pub(super) fn paste(model: &mut ConsoleModel, session: &Session, text: Option<&str>) -> Option<ConsoleCommand> {
    let Some(text) = text else { return refuse(model, refusal_of_paste(text)) };
    let pasted = match &mut model.dialog {
        Some(Dialog::Note(line) | Dialog::Reason(_, _, line) | Dialog::Answer(line)) => line.paste(text),
        Some(Dialog::Pick(picker)) => {
            picker.cursor.paste(text);
            if let (PickerKind::Reason(what), Some(words)) = (picker.kind, picker.other_words(session)) {
                let field = TextInput::with_text(&words);
                model.dialog = Some(Dialog::Reason(what, OTHER_REASON.to_string(), field));
            }
            Ok(())
        }
        Some(Dialog::Palette(cursor)) => {
            cursor.paste(text);
            Ok(())
        }
        None if model.playback.is_none() => match form::input_of_sheet(session) {
            Some(mut line) => line.paste(text).map(|()| model.dialog = Some(Dialog::Answer(line))),
            None => Err(refusal_of_paste(Some(text)).to_string()),
        },
        _ => Err(refusal_of_paste(Some(text)).to_string()),
    };
    pasted.err().and_then(|reason| refuse(model, reason))
}
