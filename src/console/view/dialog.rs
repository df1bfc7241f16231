//! What opens above the panels: the help, made from the table of keys, and the questions before something ends.

use ratatui::layout::Rect;

use super::hands;
use super::paint::{Brush, width, wrap};
use super::picker;
use super::regions::inside;
use super::theme::{Role, Signs};
use crate::console::chord::Chord;
use crate::console::keys::{Binding, Layer};
use crate::console::model::{Dialog, Model};
use crate::session::{Phase, Session};

/// Draws the open dialog, if there is one.
pub fn draw(brush: &mut Brush, screen: Rect, session: &Session, model: &Model) {
    match &model.dialog {
        None => {}
        Some(Dialog::Pick(list)) => picker::draw(brush, screen, session, list),
        Some(Dialog::Preflight) => hands::preflight(brush, screen, session, model),
        Some(Dialog::Calibration) => super::calibration::draw(brush, screen, session),
        Some(Dialog::Note(line)) => hands::note(brush, screen, line),
        Some(Dialog::Help) => help(brush, screen, model),
        Some(Dialog::Difference(lines)) => difference(brush, screen, lines),
        Some(Dialog::EndTrial) => ask(brush, screen, "End the trial?", &["It cannot be resumed after that."]),
        Some(Dialog::Quit) => {
            let lines: &[&str] = match session.phase {
                Phase::Running | Phase::Paused => {
                    &["The trial is not over.", "The session ends, the recording is kept."]
                }
                _ if !session.is_step_done() => {
                    &["Not everything of this step is done.", "It can be continued, or done again."]
                }
                _ => &["The session ends, the recording is kept."],
            };
            ask(brush, screen, "Quit tomcom?", lines);
        }
    }
}

/// Clears the middle of the screen and frames it.
pub(super) fn open(brush: &mut Brush, screen: Rect, size: (u16, u16), title: &str, remark: &str) -> Rect {
    let (columns, rows) = (size.0.min(screen.width), size.1.min(screen.height));
    let area = Rect {
        x: screen.x + (screen.width - columns) / 2,
        y: screen.y + (screen.height - rows) / 2,
        width: columns,
        height: rows,
    };
    for y in area.y..area.bottom() {
        for x in area.x..area.right() {
            if let Some(cell) = brush.buffer.cell_mut((x, y)) {
                cell.reset();
            }
        }
    }
    let style = brush.style(Role::Strong);
    brush.frame(area, &brush.theme.signs().frame, style);
    brush.text(area.x + 2, area.y, columns, &format!(" {title} "), style);
    if !remark.is_empty() {
        brush.text_right(area.right() - 2, area.y, columns, &format!(" {remark} "), style);
    }
    inside(area)
}

fn ask(brush: &mut Brush, screen: Rect, title: &str, lines: &[&str]) {
    let inside = open(brush, screen, (46, lines.len() as u16 + 5), title, "");
    for (row, line) in lines.iter().enumerate() {
        brush.parts(inside.x + 2, inside.y + 1 + row as u16, inside.width - 3, &[(line, Role::Text)]);
    }
    let y = inside.bottom() - 1;
    let parts = [("y", Role::Strong), (" yes    ", Role::Text), ("any other key", Role::Strong), (" no", Role::Text)];
    brush.parts(inside.x + 2, y, inside.width - 3, &parts);
}

/// What each knew where they differ.
fn difference(brush: &mut Brush, screen: Rect, lines: &[String]) {
    let columns = (screen.width - 4).min(100);
    let wrapped: Vec<(bool, String)> = lines
        .iter()
        .enumerate()
        .flat_map(|(index, line)| wrap(line, columns - 4).into_iter().map(move |line| (index == 0, line)))
        .collect();
    let rows = wrapped.len() as u16 + 2;
    let inside = open(brush, screen, (columns, rows), "What each knew", "any key closes");
    for (row, (is_head, line)) in wrapped.iter().enumerate().take(usize::from(inside.height)) {
        let style = brush.style(if *is_head { Role::Strong } else { Role::Text });
        brush.text(inside.x + 1, inside.y + row as u16, inside.width - 2, line, style);
    }
}

/// The columns of a line of the help, with its key.
const HELP_COLUMNS: u16 = 39;

/// A line of the help: a heading, a key with what it does, or a sign with what it means.
#[derive(Clone, Copy)]
enum Line<'a> {
    Heading(&'a str),
    Key(&'a Binding),
    /// A sign of the panels, with what it means.
    Sign(&'static str, &'static str),
    Space,
}

/// What the signs mean that explain themselves nowhere else.
fn legend(signs: &Signs) -> Vec<Line<'static>> {
    let meanings = [
        (signs.gaze, "the gaze; in the belief: it was just there"),
        (signs.trail, "where the gaze was before"),
        (signs.rules[1], "changed just now, by whom: the colour"),
        (signs.changed, "changed so long ago"),
        (signs.rules[2], "shown to the participant"),
        (signs.to, "the robot goes there; trial or robot goes on"),
        (signs.bar_full, "how sure a belief is; what a signal saves"),
        (signs.press, "press"),
        (signs.no_effect, "press without effect"),
        (signs.error, "error; trial excluded"),
        (signs.served, "order served"),
        ("+", "new order; more than there is room for"),
        (signs.taken_back, "taken back; robot's press skipped"),
        (signs.by_hand, "by the experimenter's hand"),
        (signs.stopped, "robot stopped"),
        (signs.pause, "trial paused; robot held"),
        ("*", "note in words"),
        ("!", "the keyboard was elsewhere"),
    ];
    meanings.map(|(sign, meaning)| Line::Sign(sign, meaning)).to_vec()
}

fn help(brush: &mut Brush, screen: Rect, model: &Model) {
    let mut groups: Vec<(&str, Vec<Line>)> = Vec::new();
    for binding in &model.keys.bindings {
        match groups.iter_mut().find(|(group, _)| *group == binding.group) {
            Some((_, members)) => members.push(Line::Key(binding)),
            None => groups.push((binding.group, vec![Line::Key(binding)])),
        }
    }
    groups.push(("Signs", legend(brush.theme.signs())));
    let rows = screen.height.saturating_sub(3);
    let columns = columns(&groups, usize::from(rows));
    let tallest = columns.iter().map(Vec::len).max().unwrap_or(0) as u16;
    let fits = usize::from((screen.width.saturating_sub(4) / HELP_COLUMNS).max(1)).min(columns.len());
    let from = model.help_from.min(columns.len() - fits);
    let remark = match columns.len() - fits {
        0 => "any key closes".to_string(),
        more => format!("arrows: page {} of {}, other keys close", from + 1, more + 1),
    };
    let column_width = (screen.width.saturating_sub(4) / fits as u16).min(HELP_COLUMNS + 2);
    let inside = open(brush, screen, (column_width * fits as u16 + 4, tallest + 2), "Keys", &remark);
    for (index, column) in columns.iter().skip(from).take(fits).enumerate() {
        let x = inside.x + 1 + index as u16 * column_width;
        for (row, line) in column.iter().take(usize::from(inside.height)).enumerate() {
            help_line(brush, x, inside.y + row as u16, column_width - 1, line);
        }
    }
}

fn help_line(brush: &mut Brush, x: u16, y: u16, columns: u16, line: &Line) {
    match line {
        Line::Space => {}
        Line::Heading(text) => {
            let style = brush.style(Role::Strong);
            brush.text(x, y, columns, text, style);
        }
        Line::Sign(sign, meaning) => {
            let style = brush.style(Role::Strong);
            brush.text(x + 5, y, 1, sign, style);
            brush.parts(x + 7, y, columns.saturating_sub(7), &[(meaning, Role::Text)]);
        }
        Line::Key(binding) => {
            let key = binding.chords.first().map(Chord::to_string).unwrap_or_default();
            let role = match binding.layer {
                Some(Layer::Wizard) => Role::Signal,
                Some(Layer::Participant) => Role::Human,
                None => Role::Strong,
            };
            let style = brush.style(role);
            brush.text(x + 6 - width(&key).min(6), y, 6, &key, style);
            brush.parts(x + 7, y, columns.saturating_sub(7), &[(&binding.help, Role::Text)]);
        }
    }
}

/// The groups in as few columns as hold them: each in the first column that has room, one that is longer than a column
/// goes on in the next.
fn columns<'a>(groups: &[(&'a str, Vec<Line<'a>>)], rows: usize) -> Vec<Vec<Line<'a>>> {
    let rows = rows.max(4);
    let mut columns: Vec<Vec<Line>> = vec![Vec::new()];
    for (group, members) in groups {
        // A heading, and a line between it and what is above.
        let fits = |column: &Vec<Line>| column.is_empty() || column.len() + members.len() + 2 <= rows;
        let mut index = columns.iter().position(fits).unwrap_or(columns.len());
        if index == columns.len() {
            columns.push(Vec::new());
        }
        if !columns[index].is_empty() {
            columns[index].push(Line::Space);
        }
        columns[index].push(Line::Heading(group));
        for member in members {
            if columns[index].len() >= rows {
                columns.push(Vec::new());
                index = columns.len() - 1;
            }
            columns[index].push(*member);
        }
    }
    columns
}
