//! The page that lists recordings to choose from, when no session is open.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::paint::{Painter, targets, width};
use super::picker::TYPE;
use super::popup::open;
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::click::{ClickAction, ClickTarget};
use crate::console::recording_picker::RecordingPicker;

/// Rows around the list of recordings: frame, search line, headings, key hints.
const AROUND: u16 = 7;

/// Draws the list of recordings as large as the screen allows.
pub fn draw_recordings(picker: &RecordingPicker, theme: Theme, frame: &mut Frame) {
    draw(&mut Painter::new(frame.buffer_mut(), theme), picker);
}

/// Click targets of the list of recordings on a screen of `size` columns and rows.
pub fn recording_targets(picker: &RecordingPicker, theme: Theme, size: (u16, u16)) -> Vec<ClickTarget> {
    targets(theme, size, |brush| draw(brush, picker))
}

fn draw(brush: &mut Painter, picker: &RecordingPicker) {
    let screen = *brush.buffer.area();
    let widths: Vec<u16> = (0..picker.headings.len()).map(|column| column_width(picker, column)).collect();
    let wanted = widths.iter().map(|width| width + 2).sum::<u16>() + 6;
    let hint = width(&picker.title) + 4;
    let size = (wanted.max(hint).max(64).min(screen.width), (picker.rows.len() as u16 + AROUND).min(screen.height));
    let inside = open(brush, screen, size, &picker.title, "");
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let left = picker.left();
    let typed = format!("{}_", picker.cursor.filter);
    brush.parts(x, inside.y, columns, &[(TYPE, TextRole::Quiet), (&typed, TextRole::Strong)]);
    let quiet = brush.style(TextRole::Quiet);
    brush.text_right(x + columns, inside.y, 16, &format!("{} of {}", left.len(), picker.rows.len()), quiet);
    row(
        brush,
        Rect { x: x + 2, y: inside.y + 2, width: columns.saturating_sub(2), height: 1 },
        &picker.headings,
        &widths,
        TextRole::Quiet,
    );
    let list = Rect { x, y: inside.y + 3, width: columns, height: inside.height.saturating_sub(5) };
    let rows = usize::from(list.height).max(1);
    let first = picker.cursor.at.saturating_sub(rows / 2).min(left.len().saturating_sub(rows));
    let cursor = brush.theme.signs().to;
    for (line, &index) in left.iter().skip(first).take(rows).enumerate() {
        let (y, is_at) = (list.y + line as u16, first + line == picker.cursor.at);
        let role = if is_at { TextRole::Strong } else { TextRole::Text };
        brush.parts(list.x, y, 2, &[(if is_at { cursor } else { " " }, TextRole::Signal)]);
        let cells = Rect { x: list.x + 2, y, width: list.width.saturating_sub(2), height: 1 };
        row(brush, cells, &picker.rows[index], &widths, role);
        brush.target(Rect { y, height: 1, ..list }, ClickAction::Row(first + line));
    }
    if left.is_empty() {
        brush.text(list.x, list.y, list.width, "no recording matches; bksp deletes a letter", quiet);
    }
    let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
    let hints = [("up/down", "select", None), ("enter", "open", enter), ("esc", "back", esc)];
    brush.hints(x, inside.bottom().saturating_sub(1), columns, &hints);
}

fn column_width(picker: &RecordingPicker, column: usize) -> u16 {
    let rows = picker.rows.iter().filter_map(|row| row.get(column));
    rows.chain(picker.headings.get(column)).map(|cell| width(cell)).max().unwrap_or(0)
}

fn row(brush: &mut Painter, area: Rect, cells: &[String], widths: &[u16], role: TextRole) {
    let style = brush.style(role);
    let mut x = area.x;
    for (cell, width) in cells.iter().zip(widths) {
        brush.text(x, area.y, area.right().saturating_sub(x), cell, style);
        x += width + 2;
    }
}
