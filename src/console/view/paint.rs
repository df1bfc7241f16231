//! Drawing functions of the console: text that is cut to the available columns, frames with titles, bars, and click
//! targets.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Style;

use super::regions::inside;
use super::theme::{TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::mouse::{ClickAction, ClickTarget};
use crate::console::text_columns::{fit, width};

/// Draws on a screen buffer in a theme, and collects click targets.
pub struct Painter<'a> {
    pub buffer: &'a mut Buffer,
    pub theme: Theme,
    /// Area of the panel that has the focus: its frame is drawn stronger.
    pub focus: Rect,
    /// Click targets in the order in which they were drawn.
    pub targets: Vec<ClickTarget>,
}

/// A key hint: name of the key, label, and the key that a click on the hint stands for.
pub type KeyHint<'a> = (&'a str, &'a str, Option<KeyChord>);

/// Columns between two key hints.
const HINT_GAP: u16 = 3;

/// Click targets of a screen of `size` columns and rows, after `draw` has drawn on it.
pub(super) fn targets(theme: Theme, size: (u16, u16), draw: impl FnOnce(&mut Painter)) -> Vec<ClickTarget> {
    let mut buffer = Buffer::empty(Rect { x: 0, y: 0, width: size.0, height: size.1 });
    let mut brush = Painter::new(&mut buffer, theme);
    draw(&mut brush);
    brush.targets
}

impl Painter<'_> {
    pub fn new(buffer: &mut Buffer, theme: Theme) -> Painter<'_> {
        Painter { buffer, theme, focus: Rect::default(), targets: Vec::new() }
    }

    pub fn target(&mut self, cells: Rect, action: ClickAction) {
        self.targets.push(ClickTarget { cells, action });
    }

    /// Marks the columns from `x` to `end` of a row as clickable; a click does what the key does.
    pub fn key_target(&mut self, x: u16, y: u16, end: u16, chord: KeyChord) {
        self.target(Rect { x, y, width: end.saturating_sub(x), height: 1 }, ClickAction::Key(chord));
    }

    /// Writes key hints one after another; each can be clicked if it names a single key.
    pub fn hints(&mut self, x: u16, y: u16, columns: u16, hints: &[KeyHint]) {
        let mut at = x;
        for (key, words, chord) in hints {
            let room = (x + columns).saturating_sub(at);
            let end =
                self.parts(at, y, room, &[(key, TextRole::Strong), (" ", TextRole::Quiet), (words, TextRole::Quiet)]);
            if let Some(chord) = chord {
                self.key_target(at, y, end, *chord);
            }
            at = end + HINT_GAP;
        }
    }

    /// The style of a text role (such as a title or an alarm) in this theme.
    pub fn style(&self, role: TextRole) -> Style {
        self.theme.style(role)
    }

    /// Writes at most `columns` of a text and returns the column after it. Control characters are escaped.
    pub fn text(&mut self, x: u16, y: u16, columns: u16, text: &str, role: TextRole) -> u16 {
        self.styled(x, y, columns, text, self.style(role))
    }

    /// Writes a text as [`Painter::text`] does, in a style of its own.
    pub fn styled(&mut self, x: u16, y: u16, columns: u16, text: &str, style: Style) -> u16 {
        let area = *self.buffer.area();
        if y < area.y || y >= area.bottom() || x < area.x || x >= area.right() {
            return x;
        }
        let text = fit(text, columns.min(area.right() - x), self.theme.signs().ellipsis);
        // The style of a text drawn earlier in these cells is removed.
        self.buffer.set_stringn(x, y, &text, usize::from(columns), Style::reset().patch(style)).0
    }

    pub fn is_written(&self, x: u16, y: u16) -> bool {
        self.buffer.cell((x, y)).is_some_and(|cell| cell.symbol() != " ")
    }

    /// Writes a text on the screen so that it ends before the column `right`.
    pub fn text_right(&mut self, right: u16, y: u16, columns: u16, text: &str, role: TextRole) {
        let text = fit(text, columns, self.theme.signs().ellipsis);
        self.text(right.saturating_sub(width(&text)), y, columns, &text, role);
    }

    /// Writes text parts in their styles one after another, and returns the column after the last.
    pub fn parts(&mut self, x: u16, y: u16, columns: u16, parts: &[(&str, TextRole)]) -> u16 {
        let end = x + columns;
        parts.iter().fold(x, |x, (text, role)| self.text(x, y, end.saturating_sub(x), text, *role))
    }

    pub fn frame(&mut self, area: Rect, role: TextRole) {
        if area.width < 2 || area.height < 2 {
            return;
        }
        let (right, bottom) = (area.right() - 1, area.bottom() - 1);
        let (signs, style) = (self.theme.signs().frame, self.style(role));
        // A frame is most of a screen's texts: its signs have one column each and need no measuring.
        let mut put = |x, y, sign: &str| {
            if let Some(cell) = self.buffer.cell_mut((x, y)) {
                cell.set_symbol(sign).set_style(Style::reset().patch(style));
            }
        };
        for x in area.x + 1..right {
            put(x, area.y, signs[4]);
            put(x, bottom, signs[4]);
        }
        for y in area.y + 1..bottom {
            put(area.x, y, signs[5]);
            put(right, y, signs[5]);
        }
        for (x, y, sign) in [(area.x, area.y, 0), (right, area.y, 1), (area.x, bottom, 2), (right, bottom, 3)] {
            put(x, y, signs[sign]);
        }
    }

    /// Draws the frame of a panel with its title, and a remark at the right; returns the area inside.
    pub fn panel(&mut self, area: Rect, title: &str, remark: &str) -> Rect {
        self.panel_with(area, title, &[(remark, TextRole::Quiet)])
    }

    /// Draws the frame of a panel with its title, and a remark in several styles at the right; returns the area inside.
    pub fn panel_with(&mut self, area: Rect, title: &str, remark: &[(&str, TextRole)]) -> Rect {
        let has_focus = area.area() > 0 && area == self.focus;
        let line = if has_focus { TextRole::Strong } else { TextRole::Frame };
        self.frame(area, line);
        let title = match has_focus {
            true => format!(" {} {title} ", self.theme.signs().to),
            false => format!(" {title} "),
        };
        let room = area.width.saturating_sub(4);
        self.text(area.x + 1, area.y, room, &title, TextRole::Strong);
        let columns: u16 = remark.iter().map(|(text, _)| width(text)).sum();
        if columns > 0 && width(&title) + columns <= room {
            let begins = area.right() - 3 - columns;
            self.text(begins, area.y, columns + 2, &" ".repeat(usize::from(columns + 2)), line);
            self.parts(begins + 1, area.y, columns, remark);
        }
        inside(area)
    }

    /// Draws a bar of `columns`, of which a `share` from 0 to 1 is filled.
    pub fn bar(&mut self, x: u16, y: u16, columns: u16, share: f64, role: TextRole) -> u16 {
        let signs = self.theme.signs();
        let filled = (share.clamp(0.0, 1.0) * f64::from(columns)).round() as u16;
        let x = self.text(x, y, filled, &signs.bar_full.repeat(usize::from(filled)), role);
        let rest = columns - filled;
        self.text(x, y, rest, &signs.bar_empty.repeat(usize::from(rest)), TextRole::Frame)
    }
}
