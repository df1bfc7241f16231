//! The help: all keys of the key table, first those that have an effect now, and the signs on the screen.

use ratatui::layout::Rect;

use super::dialog::open;
use super::paint::Painter;
use super::theme::{Glyphs, TextRole};
use crate::console::chord::KeyChord;
use crate::console::console_model::{ConsoleModel, Dialog};
use crate::console::key_action::{KeyBinding, KeyLayer};
use crate::console::text_columns::width;

/// Least width of a column of the help, in characters: no line is longer.
const HELP_COLUMNS: u16 = 58;
/// Indent of the description in a help line, in characters.
const HELP_INDENT: u16 = 7;

/// A line of the help: a heading, a key with its action, or a sign with its meaning.
#[derive(Clone, Copy)]
enum Line<'a> {
    Heading(&'a str),
    Key(&'a KeyBinding, bool),
    Sign(&'static str, &'static str),
    Space,
}

impl Line<'_> {
    fn columns(&self) -> u16 {
        match self {
            Line::Heading(text) => width(text),
            Line::Key(binding, _) => key_indent(binding) + width(&binding.help),
            Line::Sign(_, meaning) => HELP_INDENT + width(meaning),
            Line::Space => 0,
        }
    }
}

/// Name of a binding's first key.
fn key_name(binding: &KeyBinding) -> String {
    binding.chords.first().map(KeyChord::to_string).unwrap_or_default()
}

/// Indent of the description of a key, in characters; more than usual after a key with a long name.
fn key_indent(binding: &KeyBinding) -> u16 {
    HELP_INDENT.max(width(&key_name(binding)) + 1)
}

fn legend(signs: &Glyphs) -> Vec<Line<'static>> {
    let meanings = [
        (signs.gaze, "where the participant looks or just looked"),
        (signs.trail, "where the participant looked before"),
        (signs.rules[1], "content changed just now; colour: by whom"),
        (signs.changed, "changed, and the participant has not looked since"),
        (signs.unknown, "changed, and no gaze tells whether it was seen"),
        (signs.rules[2], "place highlighted on the participant's display"),
        (signs.to, "robot's next press; trial or robot resumed"),
        (signs.bar_full, "probability of a belief; presses a signal saves"),
        (signs.bar_empty, "presses saved, up to one standard error more"),
        (signs.frame[5], "cost of a signal, in a bar of presses saved"),
        (signs.press, "press with an effect"),
        (signs.no_effect, "press without effect"),
        (signs.error, "error of the human"),
        (signs.served, "order served; item of an order that is there"),
        (signs.dash, "trial excluded from the analysis"),
        (signs.in_work, "item of an order in work; dish that was begun"),
        (signs.missing, "missing item of an order; step that is left"),
        ("+", "new order; further entries without room"),
        (signs.taken_back, "signal taken back; robot's press skipped"),
        (signs.by_hand, "manual intervention of the experimenter"),
        (signs.stopped, "robot stopped"),
        (signs.touched, "a person touched the robot's arm"),
        ("alone", "the robot acts as long as the human does not"),
        (signs.pause, "trial paused; robot held"),
        ("*", "note that the wizard typed"),
        (signs.cursor, "selected row of a list"),
        ("!", "keyboard focus or gaze lost; a line: gaze is lost"),
    ];
    meanings.map(|(sign, meaning)| Line::Sign(sign, meaning)).to_vec()
}

/// Heading of the keys that have no effect now.
const NO_EFFECT: &str = "Keys without an effect now";

/// Columns of the help, and the number of them that fit side by side on the screen: first the keys with an effect now,
/// then the others, then the signs.
fn help_columns<'a>(model: &'a ConsoleModel, effects: &[bool]) -> (Vec<Vec<Line<'a>>>, usize) {
    let mut groups: Vec<(&str, Vec<Line>)> = Vec::new();
    let lines = model.keys.bindings.iter().zip(effects).map(|(binding, &has_effect)| (binding, has_effect));
    let (works, others): (Vec<_>, Vec<_>) = lines.partition(|(_, has_effect)| *has_effect);
    for (binding, _) in works {
        let line = Line::Key(binding, true);
        match groups.iter_mut().find(|(group, _)| *group == binding.group) {
            Some((_, members)) => members.push(line),
            None => groups.push((binding.group, vec![line])),
        }
    }
    groups.push((NO_EFFECT, others.into_iter().map(|(binding, _)| Line::Key(binding, false)).collect()));
    groups.push(("Signs on the screen", legend(model.theme.signs())));
    groups.retain(|(_, members)| !members.is_empty());
    let columns = columns(&groups, usize::from(model.size.1.saturating_sub(3)));
    let fits = usize::from((model.size.0.saturating_sub(4) / HELP_COLUMNS).max(1)).min(columns.len());
    (columns, fits)
}

/// Number of further pages of the open help after the first; 0 if the help is closed.
pub fn help_pages(model: &ConsoleModel) -> usize {
    let Some(Dialog::Help(effects)) = &model.dialog else { return 0 };
    let (columns, fits) = help_columns(model, effects);
    columns.len() - fits
}

/// Draws the help; `effects` tells for each entry of the key table whether its key had an effect when it was opened.
pub(super) fn draw(brush: &mut Painter, screen: Rect, model: &ConsoleModel, effects: &[bool]) {
    let (columns, fits) = help_columns(model, effects);
    let tallest = columns.iter().map(Vec::len).max().unwrap_or(0) as u16;
    let from = model.help_from.min(columns.len() - fits);
    let remark = match columns.len() - fits {
        0 => "any key closes".to_string(),
        more => format!("arrows: help page {} of {}, other keys close", from + 1, more + 1),
    };
    // Help columns are as wide as the longest line, if that fits.
    let longest = columns.iter().flatten().map(Line::columns).max().unwrap_or(0).max(HELP_COLUMNS);
    let column_width = (screen.width.saturating_sub(4) / fits as u16).min(longest + 2);
    let inside = open(brush, screen, (column_width * fits as u16 + 4, tallest + 2), "Keys", &remark);
    for (index, column) in columns.iter().skip(from).take(fits).enumerate() {
        let x = inside.x + 1 + index as u16 * column_width;
        for (row, line) in column.iter().take(usize::from(inside.height)).enumerate() {
            help_line(brush, x, inside.y + row as u16, column_width - 1, line);
        }
    }
}

fn help_line(brush: &mut Painter, x: u16, y: u16, columns: u16, line: &Line) {
    match line {
        Line::Space => {}
        Line::Heading(text) => {
            brush.text(x, y, columns, text, TextRole::Strong);
        }
        Line::Sign(sign, meaning) => {
            brush.text_right(x + HELP_INDENT - 1, y, HELP_INDENT - 1, sign, TextRole::Strong);
            brush.text(x + HELP_INDENT, y, columns.saturating_sub(HELP_INDENT), meaning, TextRole::Text);
        }
        Line::Key(binding, has_effect) => {
            let (key, indent) = (key_name(binding), key_indent(binding));
            let role = match binding.layer {
                _ if !has_effect => TextRole::Quiet,
                Some(KeyLayer::Wizard) => TextRole::Signal,
                Some(KeyLayer::Participant) => TextRole::Human,
                None => TextRole::Strong,
            };
            brush.text_right(x + indent - 1, y, indent - 1, &key, role);
            let text = if *has_effect { TextRole::Text } else { TextRole::Quiet };
            brush.text(x + indent, y, columns.saturating_sub(indent), &binding.help, text);
        }
    }
}

/// Distributes the key groups of the help over as few columns as possible: each group goes into the first column with
/// room, and continues in the next column if it is too long.
fn columns<'a>(groups: &[(&'a str, Vec<Line<'a>>)], rows: usize) -> Vec<Vec<Line<'a>>> {
    let rows = rows.max(4);
    let mut columns: Vec<Vec<Line>> = vec![Vec::new()];
    for (group, members) in groups {
        // A group needs two additional rows, for its heading and an empty line above it.
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
