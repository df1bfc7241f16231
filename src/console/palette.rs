//! The palette: a searchable list of all actions that have keys at present.

use super::console_model::{ConsoleModel, Dialog};
use super::key_action::{KeyAction, KeyBinding, ManualAction};
use super::list_cursor::ListCursor;
use super::possible::is_possible_behind;
use tomcom_session::Session;

/// Further words by which the palette finds an action: what people type who think of it by another name.
fn synonyms(action: &KeyAction) -> &'static str {
    match action {
        KeyAction::Advance => "begin go continue run",
        KeyAction::EndTrial => "finish stop the trial over",
        KeyAction::Hand(ManualAction::Abort) => "cancel the trial",
        KeyAction::Hand(ManualAction::Redo) => "redo again",
        KeyAction::Hand(ManualAction::NoteInWords) => "comment remark write",
        KeyAction::Note(_) => "marker",
        KeyAction::Hand(ManualAction::Correct) => "fix change mend",
        KeyAction::Hand(ManualAction::Calibrate) => "calibrate calibration eye tracker",
        KeyAction::StopRobot => "halt emergency",
        KeyAction::TakeBack => "undo withdraw hide",
        KeyAction::Quit => "exit close leave end the session",
        KeyAction::Help => "keys manual signs",
        _ => "",
    }
}

/// Actions that may stand first in the open palette, the most likely one first. None of them changes the trial.
const FIRST: [KeyAction; 4] = [
    KeyAction::Accept,
    KeyAction::Hand(ManualAction::Preflight),
    KeyAction::Hand(ManualAction::NoteInWords),
    KeyAction::Help,
];

/// Opens the palette with this filter. Its first action is the one that was chosen last in it, or else a likely one
/// that changes nothing. It is decided here once, so that no row moves under the cursor while the palette is open.
pub(super) fn open(model: &mut ConsoleModel, session: &Session, filter: &str) {
    let likely = model.palette_chosen.iter().chain(&FIRST);
    let does =
        |action: &&KeyAction| model.keys.chord_for(action).is_some() && is_possible_behind(session, model, action);
    model.palette_first = likely.into_iter().find(does).cloned();
    model.dialog = Some(Dialog::Palette(ListCursor { filter: filter.to_string(), at: 0 }));
}

/// Remembers the action that the wizard chose in the palette, unless it stops or ends something.
pub(super) fn remember(model: &mut ConsoleModel, action: &KeyAction) {
    if !ends(action) {
        model.palette_chosen = Some(action.clone());
    }
}

/// Whether an action stops the robot, or ends the trial or the session.
fn ends(action: &KeyAction) -> bool {
    matches!(
        action,
        KeyAction::StopRobot | KeyAction::EndTrial | KeyAction::Quit | KeyAction::Hand(ManualAction::Abort)
    )
}

/// The actions that match the filter, in the order of the help. Without a filter, the one that the palette was opened
/// with is first, and what stops the robot or ends the trial or the session is last.
pub fn actions<'a>(model: &'a ConsoleModel, cursor: &ListCursor) -> Vec<&'a KeyBinding> {
    let is_active = |line: &&KeyBinding| line.layer.is_none_or(|only| only == model.layer);
    let is_left = |line: &&KeyBinding| {
        let words = format!("{} {} {}", line.help, line.group, synonyms(&line.action));
        line.action != KeyAction::Palette && cursor.keeps(&words)
    };
    let mut left: Vec<&KeyBinding> = model.keys.bindings.iter().filter(is_active).filter(is_left).collect();
    if cursor.filter.is_empty() {
        left.sort_by_key(|line| (model.palette_first.as_ref() != Some(&line.action), ends(&line.action)));
    }
    left
}
