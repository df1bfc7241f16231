//! The page that lists recordings to choose from, when no session is open.

use crossterm::event::KeyCode;
use ratatui::Frame;
use ratatui::layout::Rect;

use super::dialog::open;
use super::paint::{Painter, targets};
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::lists::RecordingPicker;
use crate::console::mouse::{ClickAction, ClickTarget};
use crate::console::text_columns::{fit_end, width};
use tomcom_core::base::text::count;

/// Rows around the list of recordings: frame, search line, headings, key hints.
const AROUND: u16 = 7;
/// Columns beside the cells of a row: frame, margins and cursor.
const BESIDE: u16 = 6;
/// Columns between two cells.
const GAP: u16 = 2;
/// Headings of the columns that are left out where not all fit; the others tell recordings and their states apart.
const LEFT_OUT: [&str; 2] = ["errors", "length"];
/// Least width of a column whose cells are cut.
const LEAST_CELL: u16 = 6;
/// Heading of the column whose cells are cut at their beginning: recordings of a day differ in the end of their names.
const CUT_IN_FRONT: &str = "recording";

pub fn draw_recordings(picker: &RecordingPicker, theme: Theme, frame: &mut Frame) {
    draw(&mut Painter::new(frame.buffer_mut(), theme), picker);
}

/// Click targets of the list of recordings on a screen of `size` columns and rows.
pub fn recording_targets(picker: &RecordingPicker, theme: Theme, size: (u16, u16)) -> Vec<ClickTarget> {
    targets(theme, size, |brush| draw(brush, picker))
}

fn draw(brush: &mut Painter, picker: &RecordingPicker) {
    let screen = *brush.buffer.area();
    let shown = ShownColumns::that_fit(picker, screen.width.saturating_sub(BESIDE));
    let wanted = shown.needed() + BESIDE;
    let hint = width(&picker.title) + 4;
    let size = (
        wanted.max(hint).max(64).min(screen.width),
        (picker.reading.unwrap_or(picker.rows.len()) as u16 + AROUND).min(screen.height),
    );
    let inside = open(brush, screen, size, &picker.title, "");
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let left = picker.left();
    let typed = format!("{}_", picker.cursor.filter);
    brush.parts(x, inside.y, columns, &[("type to filter: ", TextRole::Quiet), (&typed, TextRole::Strong)]);
    let found = picker.reading.map_or(format!("{} of {}", left.len(), picker.rows.len()), |_| String::new());
    brush.text_right(x + columns, inside.y, 16, &found, TextRole::Quiet);
    let headings = Rect { x: x + 2, y: inside.y + 2, width: columns.saturating_sub(2), height: 1 };
    shown.row(brush, headings, &picker.headings, TextRole::Quiet);
    let list = Rect { x, y: inside.y + 3, width: columns, height: inside.height.saturating_sub(5) };
    let rows = usize::from(list.height).max(1);
    let first = picker.cursor.at.saturating_sub(rows / 2).min(left.len().saturating_sub(rows));
    let cursor = brush.theme.signs().cursor;
    for (line, &index) in left.iter().skip(first).take(rows).enumerate() {
        let (y, is_at) = (list.y + line as u16, first + line == picker.cursor.at);
        let role = if is_at { TextRole::Strong } else { TextRole::Text };
        brush.text(list.x, y, 2, if is_at { cursor } else { " " }, TextRole::Signal);
        let cells = Rect { x: list.x + 2, y, width: list.width.saturating_sub(2), height: 1 };
        shown.row(brush, cells, &picker.rows[index], role);
        brush.target(Rect { y, height: 1, ..list }, ClickAction::Row(first + line));
    }
    if left.is_empty() {
        let words = match picker.reading {
            Some(number) => format!("reading {}", count(number as u64, "recording", "recordings")),
            None => "no recording matches; bksp deletes a letter".to_string(),
        };
        brush.text(list.x, list.y, list.width, &words, TextRole::Quiet);
    }
    let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
    let hints = [("up/down", "select", None), ("enter", picker.does, enter), ("esc", "back", esc)];
    brush.hints(x, inside.bottom().saturating_sub(1), columns, &hints);
}

/// The columns of the list that have room.
struct ShownColumns {
    widths: Vec<(usize, u16)>,
    /// Index of the column whose cells are cut at their beginning.
    cut_in_front: usize,
}

impl ShownColumns {
    /// The columns for a row of `room` terminal columns. If not all fit, the names of recordings are cut at their
    /// beginning, which repeats date and code, and only then the widest of the others.
    fn that_fit(picker: &RecordingPicker, room: u16) -> ShownColumns {
        let width_of = |column: usize| {
            let cells = picker.rows.iter().filter_map(|row| row.get(column));
            cells.chain(picker.headings.get(column)).map(|cell| width(cell)).max().unwrap_or(0)
        };
        let columns = picker.headings.len();
        let cut_in_front = picker.headings.iter().position(|heading| heading == CUT_IN_FRONT).unwrap_or(columns);
        // Of recordings of which nothing is known, such as errors that were never counted, a column would be empty.
        let is_empty = |column: &usize| picker.rows.iter().all(|row| row.get(*column).is_none_or(|cell| cell == "-"));
        let shown = (0..columns).filter(|column| picker.rows.is_empty() || !is_empty(column));
        let widths = shown.map(|column| (column, width_of(column))).collect();
        let mut shown = ShownColumns { widths, cut_in_front };
        for heading in LEFT_OUT {
            if shown.needed() > room {
                shown.widths.retain(|(column, _)| picker.headings[*column] != heading);
            }
        }
        let over = shown.needed().saturating_sub(room);
        if let Some((_, name)) = shown.widths.iter_mut().find(|(column, _)| *column == cut_in_front) {
            *name = name.saturating_sub(over).max(LEAST_CELL.min(*name));
        }
        while shown.needed() > room
            && let Some((_, widest)) = shown.widths.iter_mut().max_by_key(|(_, width)| *width)
            && *widest > LEAST_CELL
        {
            *widest -= 1;
        }
        shown
    }

    /// Number of terminal columns that a row needs.
    fn needed(&self) -> u16 {
        self.widths.iter().map(|(_, width)| width + GAP).sum::<u16>().saturating_sub(GAP)
    }

    fn row(&self, brush: &mut Painter, area: Rect, cells: &[String], role: TextRole) {
        let ellipsis = brush.theme.signs().ellipsis;
        let mut x = area.x;
        for (column, width) in &self.widths {
            let room = (*width).min(area.right().saturating_sub(x));
            if let Some(cell) = cells.get(*column) {
                let cut = if *column == self.cut_in_front { fit_end(cell, room, ellipsis) } else { cell.clone() };
                brush.text(x, area.y, room, &cut, role);
            }
            x += width + GAP;
        }
    }
}
