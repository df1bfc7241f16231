//! The palette: a searchable list of all actions that have keys at present.

use super::key_action::{KeyAction, KeyBinding, KeyLayer, ManualAction};
use super::keys::KeyBindings;
use super::list_cursor::ListCursor;

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

/// The actions that match the filter, in the order of the help.
pub fn actions<'a>(keys: &'a KeyBindings, layer: KeyLayer, cursor: &ListCursor) -> Vec<&'a KeyBinding> {
    let is_active = |line: &&KeyBinding| line.layer.is_none_or(|only| only == layer);
    let is_left = |line: &&KeyBinding| {
        let words = format!("{} {} {}", line.help, line.group, synonyms(&line.action));
        line.action != KeyAction::Palette && cursor.keeps(&words)
    };
    keys.bindings.iter().filter(is_active).filter(is_left).collect()
}
