//! Lists above the panels: a question with its answers, and the list of all actions (the palette).

use ratatui::layout::Rect;

use super::paint::Painter;
use super::popup::open;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::click::ClickAction;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::{KeyAction, KeyBinding};
use crate::console::list_cursor::ListCursor;
use crate::console::palette;
use crate::console::picker::Picker;
use crate::console::possible::is_possible_behind;
use crate::console::text_columns::width;
use crossterm::event::KeyCode;
use tomcom_session::Session;

/// Largest size of a list: columns and rows.
const MOST: (u16, u16) = (72, 26);
/// Rows around a list: frame, search line, separator, key hints.
const AROUND: u16 = 6;
/// Text that says how the entries of a list are filtered.
pub(super) const TYPE: &str = "type to filter (no spaces): ";

/// A row of a list: text, remark at the right, and whether choosing the row has an effect now.
struct Row {
    label: String,
    remark: String,
    counts: bool,
}

/// An open list (answers to a question, or all actions) as it is drawn.
struct ListPage<'a> {
    title: String,
    cursor: &'a ListCursor,
    rows: Vec<Row>,
    /// Number of rows of the list before filtering.
    all: usize,
    /// What the space bar does in the list, as a hint.
    space: &'a str,
    /// What the enter key does in the list, as a hint.
    takes: &'a str,
}

/// Draws the open list of answers to a question.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, picker: &Picker) {
    let rows = picker.choices(session).into_iter();
    let rows = rows.map(|choice| Row { label: choice.label, remark: choice.remark, counts: true }).collect();
    let all = Picker::new(picker.question).choices(session).len();
    let title = picker.title(session);
    ListPage { title, cursor: &picker.cursor, rows, all, space: STOPS, takes: "choose" }.draw(brush, screen);
}

/// Text for what the space bar does in a list of a live session.
const STOPS: &str = "space stops the robot";

/// Draws the palette (the list of all actions): key, action, and group; actions without an effect now are grey.
pub fn draw_palette(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel, cursor: &ListCursor) {
    let row = |line: &&KeyBinding| {
        let key = line.chords.first().map_or(String::new(), KeyChord::to_string);
        Row {
            label: format!("{key:>7}  {}", line.help),
            remark: line.group.to_string(),
            counts: is_possible_behind(session, model, &line.action),
        }
    };
    let rows = palette::actions(model, cursor).iter().map(row).collect();
    let all = palette::actions(model, &ListCursor::default());
    let has_signals = all.iter().any(|line| matches!(line.action, KeyAction::Signal(..)));
    let takes = if has_signals { "run action (signal: show key)" } else { "run the action" };
    let space = if model.playback.is_none() { STOPS } else { "" };
    let title = "All actions".to_string();
    ListPage { title, cursor, rows, all: all.len(), space, takes }.draw(brush, screen);
}

impl ListPage<'_> {
    fn draw(&self, brush: &mut Painter, screen: Rect) {
        // The height of the list stays the same while the filter changes.
        let size = (MOST.0.min(screen.width), (self.all as u16 + AROUND).min(MOST.1).min(screen.height));
        let inside = open(brush, screen, size, &self.title, self.space);
        let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
        let typed = format!("{}_", self.cursor.filter);
        let found = format!("{} of {}", self.rows.len(), self.all);
        brush.parts(x, inside.y, columns, &[(TYPE, TextRole::Quiet), (&typed, TextRole::Strong)]);
        let quiet = brush.style(TextRole::Quiet);
        brush.text_right(x + columns, inside.y, 12, &found, quiet);
        let list = Rect { x, y: inside.y + 2, width: columns, height: inside.height.saturating_sub(4) };
        let shown = usize::from(list.height).max(1);
        let first = self.cursor.at.saturating_sub(shown / 2).min(self.rows.len().saturating_sub(shown));
        for (line, row) in self.rows.iter().skip(first).take(shown).enumerate() {
            let cells = Rect { y: list.y + line as u16, height: 1, ..list };
            row.draw(brush, cells, first + line == self.cursor.at);
            brush.target(cells, ClickAction::Row(first + line));
        }
        if self.rows.is_empty() {
            brush.text(list.x, list.y, list.width, "no entry matches; bksp deletes a letter", quiet);
        }
        let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
        let hints = [("up/down", "select", None), ("enter", self.takes, enter), ("esc", "back", esc)];
        brush.hints(x, inside.bottom().saturating_sub(1), columns, &hints);
    }
}

impl Row {
    fn draw(&self, brush: &mut Painter, cells: Rect, is_at: bool) {
        let cursor = if is_at { brush.theme.signs().cursor } else { " " };
        let role = match (is_at, self.counts) {
            (true, _) => TextRole::Strong,
            (false, true) => TextRole::Text,
            (false, false) => TextRole::Quiet,
        };
        let remark = width(&self.remark).min(cells.width / 2);
        let label = cells.width.saturating_sub(remark + 3);
        let parts = [(cursor, TextRole::Signal), (" ", role), (self.label.as_str(), role)];
        brush.parts(cells.x, cells.y, label + 2, &parts);
        let quiet = brush.style(TextRole::Quiet);
        brush.text_right(cells.right(), cells.y, remark, &self.remark, quiet);
    }
}
