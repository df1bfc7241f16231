//! The check of the calibration at the console: a key begins it, the targets are shown on the wall display and in the
//! kitchen, and the wizard says what comes of the result.

use crossterm::event::KeyCode;

use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog};
use super::notice::NoticeLevel;
use super::sending::send;
use crate::gaze::calibration::{GazeAccuracy, USABLE_DEG};
use crate::session::accuracy_check::CalibrationEvent;
use crate::session::{Event, Session};

/// The key that takes the gaze as it is.
pub const AS_IT_IS: char = 'u';
/// The key that takes it with the offset taken off.
pub const CORRECTED: char = 'o';
/// The key that repeats the check.
pub const REPEAT: char = 'r';

/// Begins a check, or begins it again.
pub(super) fn begin(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    let event = Event::Calibration(CalibrationEvent::begin());
    let begun =
        send(model, session, event, NoticeLevel::Done, "the participant looks at the targets; esc ends the check");
    if begun.is_some() {
        model.dialog = Some(Dialog::Calibration);
    }
    begun
}

/// What enter does with a result: what is best for the gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationAdvice {
    /// Accept the gaze with its measured offset taken away.
    Corrected,
    /// Accept the gaze as it is.
    AsItIs,
    /// Both are too far off, or nothing was found.
    Repeat,
}

impl CalibrationAdvice {
    /// Of what was found.
    pub fn for_result(found: Option<&GazeAccuracy>) -> CalibrationAdvice {
        match found {
            Some(found) if found.accuracy_deg.min(found.corrected_deg) > USABLE_DEG => CalibrationAdvice::Repeat,
            Some(found) if found.corrected_deg < found.accuracy_deg => CalibrationAdvice::Corrected,
            Some(_) => CalibrationAdvice::AsItIs,
            None => CalibrationAdvice::Repeat,
        }
    }
}

/// A key while a check goes on, or its result is shown.
pub(super) fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    is_press: bool,
) -> Option<ConsoleCommand> {
    let outcome = session.calibration.as_ref().and_then(|check| check.result.as_ref());
    let found = outcome.and_then(|outcome| outcome.found.as_ref());
    let code = match (code, CalibrationAdvice::for_result(found)) {
        (KeyCode::Enter, CalibrationAdvice::Corrected) => KeyCode::Char(CORRECTED),
        (KeyCode::Enter, CalibrationAdvice::AsItIs) => KeyCode::Char(AS_IT_IS),
        (KeyCode::Enter, CalibrationAdvice::Repeat) => KeyCode::Char(REPEAT),
        (code, _) => code,
    };
    let mut decide = |event: CalibrationEvent, words: &str| {
        model.dialog = None;
        send(model, session, Event::Calibration(event), NoticeLevel::Done, words)
    };
    match code {
        KeyCode::Esc if session.calibration.is_none() => {
            model.dialog = None;
            None
        }
        KeyCode::Esc => decide(CalibrationEvent::Dismissed, "the calibration stays as it was"),
        KeyCode::Char(CORRECTED) if is_press && found.is_some() => {
            decide(CalibrationEvent::Accepted { corrected: true }, "accepted: the offset is taken off the gaze")
        }
        KeyCode::Char(AS_IT_IS) if is_press && found.is_some() => {
            decide(CalibrationEvent::Accepted { corrected: false }, "accepted: the gaze stays as it is")
        }
        KeyCode::Char(REPEAT) if is_press && outcome.is_some() => begin(model, session),
        _ => None,
    }
}
