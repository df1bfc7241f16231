//! What one could tell the participant: the place for the ranked signals, which says what it waits for.

use super::paint::{Brush, wrap};
use super::regions::{Regions, Room};
use super::theme::Role;

/// Draws the recommendation panel.
pub fn draw(brush: &mut Brush, regions: &Regions) {
    let area = regions.recommendation;
    if area.area() == 0 {
        return;
    }
    let quiet = brush.style(Role::Quiet);
    if regions.room == Room::Small {
        brush.text(area.x, area.y, area.width, " advice   none: it waits for the estimate of the belief", quiet);
        return;
    }
    let inside = brush.panel(area, "Recommendation", "net benefit");
    let waits = "None: a recommendation waits for the estimate of the belief. The signals are yours.";
    for (row, line) in wrap(waits, inside.width.saturating_sub(2)).iter().enumerate() {
        let y = inside.y + row as u16;
        if y < inside.bottom() {
            brush.text(inside.x + 1, y, inside.width.saturating_sub(1), line, quiet);
        }
    }
}
