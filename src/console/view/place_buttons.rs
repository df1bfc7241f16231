//! Further buttons of the participant at a place of the kitchen panel: processing steps and trash.

use ratatui::layout::Rect;
use ratatui::style::Modifier;

use super::paint::Painter;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyLayer;
use crate::console::text_columns::fit;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, LocationId};
use tomcom_session::Session;

/// Key and name of each further button at a place; none while the wizard's keys are active.
pub(super) fn further(session: &Session, model: &ConsoleModel, place: LocationId) -> Vec<(KeyChord, String)> {
    if model.layer != KeyLayer::Participant {
        return Vec::new();
    }
    let kitchen = &session.kitchen;
    let hand = kitchen.hands[Agent::Human.index()];
    let is_here = |action: ButtonAction| match action {
        ButtonAction::Process(process) => kitchen.processes[usize::from(process)].place.unwrap_or(hand) == place,
        ButtonAction::Trash => place == hand,
        _ => false,
    };
    let buttons = kitchen.buttons[Agent::Human.index()].iter().enumerate();
    let with_key = buttons.filter(|(_, button)| is_here(button.action)).filter_map(|(index, button)| {
        let key = model.keys.of_button(ButtonId(index as u8))?;
        Some((key, button.name.replace('_', " ")))
    });
    with_key.collect()
}

/// Draws the buttons one per line from the lower edge of the place's box upwards, or all in the last line if the box is
/// too low.
pub(super) fn draw(brush: &mut Painter, room: Rect, buttons: &[(KeyChord, String)]) {
    let style = brush.style(TextRole::Human).add_modifier(Modifier::BOLD);
    let count = buttons.len() as u16;
    for (index, (key, name)) in buttons.iter().enumerate() {
        let index = index as u16;
        let (x, y, columns) = match room.height > count {
            true => (room.x, room.bottom() - count + index, room.width),
            false => (room.x + index * room.width / count, room.bottom() - 1, room.width / count),
        };
        let name = fit(name, columns.saturating_sub(3), brush.theme.signs().ellipsis);
        let end = brush.text(x, y, columns, &format!("[{key}]{name}"), style);
        brush.key_target(x, y, end, *key);
    }
}
