//! Gaze accuracy check at the console: a key begins it, targets are shown on the wall display and in the kitchen panel,
//! and the wizard decides what to do with the result.

use crossterm::event::KeyCode;

use super::actions::send;
use super::console_model::{ConsoleCommand, ConsoleModel, Dialog};
use tomcom_core::gaze::calibration::{GazeAccuracy, USABLE_DEG};
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::{Event, Session};

/// Key that selects accepting the gaze without a correction.
pub const AS_IT_IS: char = 'u';
/// Key that selects accepting the gaze with its measured offset subtracted.
pub const CORRECTED: char = 'o';
/// Key that repeats the gaze accuracy check.
pub const REPEAT: char = 'r';

/// Begins a gaze accuracy check, or begins it again.
pub(super) fn begin(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    model.gaze_choice = None;
    let event = Event::Calibration(GazeCheckEvent::begin());
    let begun = send(model, session, event, "the participant looks at the targets; esc ends the check");
    if begun.is_some() {
        model.dialog = Some(Dialog::Calibration);
    }
    begun
}

/// What enter does with the check's result: the wizard's selection, or else the proposed action.
pub fn chosen(model: &ConsoleModel, found: Option<&GazeAccuracy>) -> AccuracyCheckAction {
    let best = AccuracyCheckAction::for_result(found);
    found.and(model.gaze_choice).unwrap_or(best)
}

/// Handles a key during a gaze accuracy check or at its result. Letters select an action and enter accepts the gaze;
/// the key to repeat needs no enter.
pub(super) fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    is_press: bool,
) -> Option<ConsoleCommand> {
    let outcome = session.calibration.as_ref().and_then(|check| check.result.as_ref());
    let found = outcome.and_then(|outcome| outcome.found.as_ref());
    let advice = chosen(model, found);
    match code {
        KeyCode::Esc if session.calibration.is_none() => {
            model.dialog = None;
            None
        }
        KeyCode::Esc => {
            decide(model, session, GazeCheckEvent::Dismissed, "gaze accuracy check cancelled: the gaze stays as it was")
        }
        KeyCode::Char(REPEAT) if is_press && outcome.is_some() => begin(model, session),
        KeyCode::Char(CORRECTED) if found.is_some() => {
            model.gaze_choice = Some(AccuracyCheckAction::Corrected);
            None
        }
        KeyCode::Char(AS_IT_IS) if found.is_some() => {
            model.gaze_choice = Some(AccuracyCheckAction::AsItIs);
            None
        }
        KeyCode::Enter if is_press && outcome.is_some() => match advice {
            AccuracyCheckAction::Repeat => begin(model, session),
            AccuracyCheckAction::Corrected => {
                let accepted = GazeCheckEvent::Accepted { corrected: true };
                decide(model, session, accepted, "gaze accepted: its offset is subtracted")
            }
            AccuracyCheckAction::AsItIs => {
                let accepted = GazeCheckEvent::Accepted { corrected: false };
                decide(model, session, accepted, "gaze accepted without correction")
            }
        },
        _ => None,
    }
}

fn decide(model: &mut ConsoleModel, session: &Session, event: GazeCheckEvent, words: &str) -> Option<ConsoleCommand> {
    model.dialog = None;
    send(model, session, Event::Calibration(event), words)
}

/// Action that the console proposes after a gaze accuracy check, which enter carries out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccuracyCheckAction {
    /// Accept the gaze with its measured offset subtracted from all samples.
    Corrected,
    /// Accept the gaze samples without a correction.
    AsItIs,
    /// Repeat the check: with and without correction the gaze is too inaccurate, or no accuracy was measured.
    Repeat,
}

impl AccuracyCheckAction {
    /// The proposed action for a measured gaze accuracy; without a measured accuracy, to repeat the check.
    pub fn for_result(found: Option<&GazeAccuracy>) -> AccuracyCheckAction {
        match found {
            Some(found) if found.accuracy_deg.min(found.corrected_deg) > USABLE_DEG => AccuracyCheckAction::Repeat,
            Some(found) if found.corrected_deg < found.accuracy_deg => AccuracyCheckAction::Corrected,
            Some(_) => AccuracyCheckAction::AsItIs,
            None => AccuracyCheckAction::Repeat,
        }
    }
}
