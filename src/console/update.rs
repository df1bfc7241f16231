//! The `update` function of the Elm architecture: takes a message, changes the console's model, and returns a command
//! if the session is concerned.

use super::click_question;
use super::console_message::{ConsoleCommand, ConsoleMessage};
use super::console_model::ConsoleModel;
use super::hands;
use super::key_press;
use super::mouse;
use super::pasting;
use tomcom_session::{Event, Session, TrialPhase};

/// Handles a message to the console at the time `model.now`.
pub fn update(model: &mut ConsoleModel, session: &Session, message: ConsoleMessage) -> Option<ConsoleCommand> {
    click_question::expire(model, session);
    hands::expire(model, session);
    match message {
        ConsoleMessage::Key(key) => key_press::key(model, session, &key),
        ConsoleMessage::Pointer(column, row) => {
            mouse::point(model, session, (column, row));
            None
        }
        ConsoleMessage::Click(column, row) => mouse::click(model, session, (column, row)),
        ConsoleMessage::Wheel(column, row, steps) => mouse::wheel(model, session, (column, row), i64::from(steps)),
        ConsoleMessage::Resized(columns, rows) => {
            model.size = (columns, rows);
            None
        }
        ConsoleMessage::Paste(text) => pasting::paste(model, session, text.as_deref()),
        ConsoleMessage::Focus(focused) => {
            let changed = std::mem::replace(&mut model.focused, focused) != focused;
            model.pressed = None;
            let event = if focused { Event::FocusRegained } else { Event::FocusLost };
            (changed && session.phase != TrialPhase::Closed).then_some(ConsoleCommand::Input(event))
        }
    }
}
