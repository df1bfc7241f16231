//! The palette: a searchable list of all actions that have keys at present.

use super::key_action::{KeyAction, KeyBinding, KeyLayer};
use super::keys::KeyBindings;
use super::list_cursor::ListCursor;

/// The actions that match the filter, in the order of the help.
pub fn actions<'a>(keys: &'a KeyBindings, layer: KeyLayer, cursor: &ListCursor) -> Vec<&'a KeyBinding> {
    let is_active = |line: &&KeyBinding| line.layer.is_none_or(|only| only == layer);
    let is_left = |line: &&KeyBinding| {
        line.action != KeyAction::Palette && cursor.keeps(&format!("{} {}", line.help, line.group))
    };
    keys.bindings.iter().filter(is_active).filter(is_left).collect()
}
