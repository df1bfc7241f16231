//! What the participant believes: the place for the estimate, which says what it waits for until there is one.

use super::paint::{Brush, wrap};
use super::regions::{Regions, Room};
use super::theme::Role;
use crate::session::Session;

/// Draws the belief panel.
pub fn draw(brush: &mut Brush, regions: &Regions, session: &Session) {
    let area = regions.belief;
    if area.area() == 0 {
        return;
    }
    let count = session.kitchen.aspects.len();
    let waits = format!("No estimate: nothing infers the belief about the {count} aspects of this kitchen yet.");
    if regions.room == Room::Small {
        brush.parts(area.x, area.y, area.width, &[(" belief   ", Role::Quiet), ("no estimate yet", Role::Quiet)]);
        return;
    }
    let inside = brush.panel(area, "Belief", "estimated");
    let quiet = brush.style(Role::Quiet);
    let head = format!("{:<15} {:<14} {}", "aspect", "believes", "truth");
    brush.text(inside.x + 1, inside.y, inside.width.saturating_sub(1), &head, quiet);
    for (row, line) in wrap(&waits, inside.width.saturating_sub(2)).iter().enumerate() {
        let y = inside.y + 2 + row as u16;
        if y < inside.bottom() {
            brush.text(inside.x + 1, y, inside.width.saturating_sub(1), line, quiet);
        }
    }
}
