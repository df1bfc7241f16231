//! A list dialog above the panels.

use ratatui::layout::Rect;

use super::paint::{Painter, width};
use super::popup::open;
use super::theme::TextRole;
use crate::console::picker::{Picker, PickerEntry};
use crate::session::Session;

/// Largest size of the list: columns and rows.
const MOST: (u16, u16) = (64, 26);
/// Rows around the list: frame, search line, separator, key hints.
const AROUND: u16 = 6;

/// Draws an open list.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, picker: &Picker) {
    let choices = picker.choices(session);
    // The height stays the same while the filter changes.
    let all = Picker::new(picker.question).choices(session).len() as u16;
    let size = (MOST.0.min(screen.width), (all + AROUND).min(MOST.1).min(screen.height));
    let inside = open(brush, screen, size, &picker.title(session), "space stops the robot");
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let cursor = brush.theme.signs().to;
    let typed = format!("{}_", picker.filter);
    let found = format!("{} of {all}", choices.len());
    brush.parts(x, inside.y, columns, &[("search ", TextRole::Quiet), (&typed, TextRole::Strong)]);
    let quiet = brush.style(TextRole::Quiet);
    brush.text_right(x + columns, inside.y, 12, &found, quiet);
    let list = Rect { x, y: inside.y + 2, width: columns, height: inside.height.saturating_sub(4) };
    let rows = usize::from(list.height).max(1);
    let first = picker.at.saturating_sub(rows / 2).min(choices.len().saturating_sub(rows));
    for (row, choice) in choices.iter().skip(first).take(rows).enumerate() {
        line(brush, list, row as u16, choice, (first + row == picker.at).then_some(cursor));
    }
    if choices.is_empty() {
        brush.text(list.x, list.y, list.width, "nothing is called so: bksp deletes", quiet);
    }
    let keys = [
        ("up/down", TextRole::Strong),
        (" or type  ", TextRole::Quiet),
        ("enter", TextRole::Strong),
        (" takes it  ", TextRole::Quiet),
        ("esc", TextRole::Strong),
        (" leaves", TextRole::Quiet),
    ];
    brush.parts(x, inside.bottom().saturating_sub(1), columns, &keys);
}

fn line(brush: &mut Painter, list: Rect, row: u16, choice: &PickerEntry, cursor: Option<&str>) {
    let y = list.y + row;
    let role = if cursor.is_some() { TextRole::Strong } else { TextRole::Text };
    let remark = width(&choice.remark).min(list.width / 2);
    let label = list.width.saturating_sub(remark + 3);
    brush.parts(list.x, y, label + 2, &[(cursor.unwrap_or(" "), TextRole::Signal), (" ", role), (&choice.label, role)]);
    let quiet = brush.style(TextRole::Quiet);
    brush.text_right(list.x + list.width, y, remark, &choice.remark, quiet);
}
