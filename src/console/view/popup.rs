//! The frame of dialogs, lists and cards.

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::inside;
use super::theme::TextRole;

/// Clears an area of the screen, so that a dialog, list or card can be drawn there.
pub(super) fn blank(brush: &mut Painter, area: Rect) {
    for y in area.y..area.bottom() {
        for x in area.x..area.right() {
            if let Some(cell) = brush.buffer.cell_mut((x, y)) {
                cell.reset();
            }
        }
    }
}

/// Clears and frames an area in the middle of the screen; returns the area inside the frame.
pub(super) fn open(brush: &mut Painter, screen: Rect, size: (u16, u16), title: &str, remark: &str) -> Rect {
    let (columns, rows) = (size.0.min(screen.width), size.1.min(screen.height));
    let area = Rect {
        x: screen.x + (screen.width - columns) / 2,
        y: screen.y + (screen.height - rows) / 2,
        width: columns,
        height: rows,
    };
    // Click targets under the dialog are removed; those of the hint line are drawn later.
    brush.targets.clear();
    blank(brush, area);
    let style = brush.style(TextRole::Strong);
    brush.frame(area, &brush.theme.signs().frame, style);
    brush.text(area.x + 2, area.y, columns, &format!(" {title} "), style);
    if !remark.is_empty() {
        brush.text_right(area.right() - 2, area.y, columns, &format!(" {remark} "), style);
    }
    inside(area)
}
