//! Pasted text. It is text in a text field or in the filter of a list. Everywhere else it is refused, since its letters
//! would be keys: "please call me" would send signals and stop the robot.

use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog};
use super::form;
use super::sending::refuse;
use tomcom_session::Session;

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
        Some(Dialog::Note(line) | Dialog::Answer(line)) => line.paste(text),
        Some(Dialog::Pick(picker)) => {
            picker.cursor.paste(text);
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
    pasted.err().and_then(|reason| refuse(model, &reason))
}
