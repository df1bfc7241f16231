//! Text page of a sheet (a form at full size): lines with indents and styles; if they do not fit, the part around the
//! present item is drawn.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::paint::{KeyHint, Painter};
use super::popup::open;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::text_columns::{width, wrap};

/// Largest width of a line, in columns, for readability.
const WIDEST: u16 = 84;

/// Drawing context of a sheet (a form at full size).
pub(super) struct Pen<'a, 'b> {
    /// Painter that draws on the screen.
    pub brush: &'a mut Painter<'b>,
    /// Whether the sheet's keys work and are shown; they do not in a replay.
    pub with_keys: bool,
}

/// A text within a line: its indent in columns, the text, and its style.
type PagePart = (u16, String, TextRole);

/// Text page of a sheet (a form at full size).
#[derive(Default)]
pub(super) struct Page {
    columns: u16,
    lines: Vec<Vec<PagePart>>,
    /// Index of the line that must be visible if the page is longer than the screen.
    focus: usize,
    /// Lines that can be clicked, each with the key that a click stands for.
    keys: Vec<(usize, KeyChord)>,
}

impl Page {
    /// An empty text page that fits this screen area.
    pub(super) fn new(screen: Rect) -> Page {
        Page { columns: screen.width.saturating_sub(4).min(WIDEST).saturating_sub(4), ..Page::default() }
    }

    /// Width of the page's text, in columns.
    pub(super) fn columns(&self) -> u16 {
        self.columns
    }

    /// Adds a text to the page, in as many lines as it needs.
    pub(super) fn text(&mut self, indent: u16, text: &str, role: TextRole) {
        let lines = wrap(text, self.columns.saturating_sub(indent));
        self.lines.extend(lines.into_iter().map(|line| vec![(indent, line, role)]));
    }

    /// Adds a line whose texts stand in columns of this width.
    pub(super) fn cells(&mut self, width: u16, cells: Vec<(&str, TextRole)>) {
        let part = |(index, (text, role)): (usize, (&str, TextRole))| (index as u16 * width, text.to_string(), role);
        self.lines.push(cells.into_iter().enumerate().map(part).collect());
    }

    /// Marks the next line as the one that must be visible, or the last line if none follows.
    pub(super) fn focus_here(&mut self) {
        self.focus = self.lines.len();
    }

    /// Adds a text with a mark before its first line.
    pub(super) fn marked(&mut self, mark: &str, text: &str, role: TextRole) {
        let first = self.lines.len();
        self.text(width(mark) + 1, text, role);
        if let Some([(indent, text, _)]) = self.lines.get_mut(first).map(Vec::as_mut_slice) {
            (*indent, *text) = (0, format!("{mark} {text}"));
        }
    }

    /// Adds a numbered choice, which can be clicked.
    pub(super) fn choice(&mut self, index: usize, mark: &str, text: &str, role: TextRole) {
        let digit = char::from_digit(index as u32 + 1, 10).unwrap_or(' ');
        self.keys.push((self.lines.len(), KeyChord::char(digit)));
        self.marked(mark, text, role);
    }

    /// Adds an empty line to the page.
    pub(super) fn space(&mut self) {
        self.lines.push(Vec::new());
    }

    /// Draws the part of the page around the line that must be visible, with key hints in the last line.
    pub(super) fn draw(self, pen: &mut Pen, screen: Rect, title: &str, remark: &str, keys: &[KeyHint]) {
        let rows = (self.lines.len() as u16 + 5).min(screen.height.saturating_sub(2));
        let brush = &mut *pen.brush;
        let inside = open(brush, screen, (self.columns + 4, rows), title, remark);
        let room = usize::from(inside.height.saturating_sub(3));
        let last = self.lines.len().saturating_sub(room);
        let from = (self.focus + 2).saturating_sub(room).min(last);
        for (row, line) in self.lines.iter().skip(from).take(room).enumerate() {
            let (x, y) = (inside.x + 1, inside.y + 1 + row as u16);
            let end = line.iter().fold(x, |_, (indent, text, role)| {
                let style = brush.style(*role);
                brush.text(x + indent, y, self.columns - indent, text, style)
            });
            let key = self.keys.iter().find(|(line, _)| *line == from + row);
            if let Some((_, chord)) = key.filter(|_| pen.with_keys) {
                brush.key_target(x, y, end, *chord);
            }
        }
        if pen.with_keys {
            brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width - 1, keys);
        }
    }
}

/// The key that a click on a key hint stands for.
pub(super) fn plain(code: KeyCode) -> Option<KeyChord> {
    Some(KeyChord::plain(code))
}
