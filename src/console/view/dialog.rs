//! Dialogs above the panels: the help, which is generated from the key table, and questions to confirm.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::hands;
use super::paint::Painter;
use super::picker;
use super::popup::open;
use super::regions::PanelAreas;
use super::theme::{Glyphs, TextRole, Theme};
use crate::console::chord::KeyChord;
use crate::console::console_model::{ConsoleModel, Dialog};
use crate::console::key_action::{KeyAction, KeyBinding, KeyLayer};
use crate::console::keys::KeyBindings;
use crate::console::text_columns::{width, wrap};
use crate::session::{Session, TrialPhase};

/// Draws the open dialog, if there is one.
pub fn draw(brush: &mut Painter, screen: Rect, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    match &model.dialog {
        // The question whether to send a clicked signal stands in the line of messages.
        None | Some(Dialog::Send(_)) => {}
        Some(Dialog::Pick(list)) => picker::draw(brush, regions.middle(), session, list),
        Some(Dialog::Palette(cursor)) => picker::draw_palette(brush, regions.middle(), session, model, cursor),
        Some(Dialog::Preflight) => hands::preflight(brush, screen, session, model),
        Some(Dialog::Calibration) => super::gaze_targets::draw(brush, screen, session, model),
        Some(Dialog::Note(line)) => hands::note(brush, screen, line),
        Some(Dialog::Answer(line)) => hands::answer(brush, screen, session, line),
        Some(Dialog::Help) => help(brush, screen, model),
        Some(Dialog::Difference(lines)) => difference(brush, screen, lines),
        Some(Dialog::Report(lines)) => report(brush, screen, lines, model),
        Some(Dialog::EndTrial) => {
            let yes = yes_keys(model, &KeyAction::EndTrial);
            ask(brush, screen, "End the trial?", &["A trial that was ended cannot be resumed."], &yes);
        }
        Some(Dialog::Quit) => {
            let lines: &[&str] = match session.phase {
                _ if model.lesson.is_some() => &["The training ends without a saved result."],
                TrialPhase::Running | TrialPhase::Paused => {
                    &["The trial is not over: quitting ends it.", "The session ends, the recording is kept."]
                }
                _ if !session.is_step_done() => {
                    &["This step of the study is not complete.", "It can be continued or repeated."]
                }
                _ => &["The session ends, the recording is kept."],
            };
            ask(brush, screen, "Quit tomcom?", lines, &yes_keys(model, &KeyAction::Quit));
        }
    }
}

/// The keys that answer a question with yes: y, and the key that opened the question.
fn yes_keys(model: &ConsoleModel, action: &KeyAction) -> String {
    model.keys.chord_for(action).map_or("y".to_string(), |chord| format!("y or {chord}"))
}

/// Draws a yes-or-no question with the keys that answer it.
fn ask(brush: &mut Painter, screen: Rect, title: &str, lines: &[&str], yes: &str) {
    let inside = open(brush, screen, (46, lines.len() as u16 + 5), title, "");
    for (row, line) in lines.iter().enumerate() {
        brush.parts(inside.x + 2, inside.y + 1 + row as u16, inside.width - 3, &[(line, TextRole::Text)]);
    }
    let hints = [(yes, "yes", Some(KeyChord::char('y'))), ("any other key", "no", Some(KeyChord::plain(KeyCode::Esc)))];
    brush.hints(inside.x + 2, inside.bottom() - 1, inside.width - 3, &hints);
}

/// Draws the details of a difference between wizard and assistant.
fn difference(brush: &mut Painter, screen: Rect, lines: &[String]) {
    let columns = (screen.width - 4).min(100);
    let wrapped: Vec<(bool, String)> = lines
        .iter()
        .enumerate()
        .flat_map(|(index, line)| wrap(line, columns - 4).into_iter().map(move |line| (index == 0, line)))
        .collect();
    let rows = wrapped.len() as u16 + 2;
    let inside = open(brush, screen, (columns, rows), "What wizard and assistant knew", "any key closes");
    for (row, (is_head, line)) in wrapped.iter().enumerate().take(usize::from(inside.height)) {
        let style = brush.style(if *is_head { TextRole::Strong } else { TextRole::Text });
        brush.text(inside.x + 1, inside.y + row as u16, inside.width - 2, line, style);
    }
}

/// Width, wrapped lines, and number of visible lines of a training report on a terminal of this size (columns and
/// rows).
fn report_lines(lines: &[String], size: (u16, u16)) -> (u16, Vec<String>, usize) {
    let columns = size.0.saturating_sub(4).min(110);
    let broken = lines.iter().flat_map(|line| {
        let text = line.trim_start();
        let indent = " ".repeat(line.len() - text.len());
        let columns = columns.saturating_sub(4 + width(&indent));
        wrap(text, columns).into_iter().map(move |part| format!("{indent}{part}"))
    });
    (columns, broken.collect(), usize::from(size.1.saturating_sub(6)))
}

/// Number of lines of the open training report that are below the visible part.
pub fn report_rest(model: &ConsoleModel) -> usize {
    let Some(Dialog::Report(lines)) = &model.dialog else { return 0 };
    let (_, lines, rows) = report_lines(lines, model.size);
    lines.len().saturating_sub(rows)
}

/// Draws the report of a wizard training.
fn report(brush: &mut Painter, screen: Rect, lines: &[String], model: &ConsoleModel) {
    let (columns, lines, rows) = report_lines(lines, (screen.width, screen.height));
    let rest = lines.len().saturating_sub(rows);
    let from = model.help_from.min(rest);
    let remark = if rest == 0 { "" } else { "up, down: more of the report" };
    let size = (columns, lines.len().min(rows) as u16 + 4);
    let inside = open(brush, screen, size, "The training is over", remark);
    for (row, line) in lines.iter().skip(from).take(rows).enumerate() {
        let style = brush.style(if from + row == 0 { TextRole::Strong } else { TextRole::Text });
        brush.text(inside.x + 1, inside.y + row as u16, inside.width - 2, line, style);
    }
    let hints = [("enter", "continue; this report is saved", Some(KeyChord::plain(KeyCode::Enter)))];
    brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width - 2, &hints);
}

/// Least width of a column of the help, in characters.
const HELP_COLUMNS: u16 = 39;
/// Indent of the description in a help line, in characters.
const HELP_INDENT: u16 = 7;

/// A line of the help: a heading, a key with its action, or a sign with its meaning.
#[derive(Clone, Copy)]
enum Line<'a> {
    Heading(&'a str),
    Key(&'a KeyBinding),
    /// A sign that panels draw, with its meaning.
    Sign(&'static str, &'static str),
    Space,
}

impl Line<'_> {
    /// Width of a line of the help, in characters.
    fn columns(&self) -> u16 {
        match self {
            Line::Heading(text) => width(text),
            Line::Key(binding) => key_indent(binding) + width(&binding.help),
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

/// Legend of the signs that the console's panels use.
fn legend(signs: &Glyphs) -> Vec<Line<'static>> {
    let meanings = [
        (signs.gaze, "where the participant looks or just looked"),
        (signs.trail, "where the participant looked before"),
        (signs.rules[1], "content changed just now; colour: by whom"),
        (signs.changed, "time since the content changed"),
        (signs.rules[2], "place highlighted on the participant's display"),
        (signs.to, "robot's next press; trial or robot resumed"),
        (signs.bar_full, "probability of a belief; presses a signal saves"),
        (signs.bar_empty, "presses saved, up to one standard error more"),
        (signs.frame[5], "cost of a signal, in a bar of presses saved"),
        (signs.press, "press with an effect"),
        (signs.no_effect, "press without effect"),
        (signs.error, "error of the human; trial excluded"),
        (signs.served, "order served"),
        ("+", "new order; further entries without room"),
        (signs.taken_back, "signal taken back; robot's press skipped"),
        (signs.by_hand, "manual intervention of the experimenter"),
        (signs.stopped, "robot stopped"),
        (signs.touched, "a person touched the robot's arm"),
        (signs.levels[3], "joint angles of the robot's arm, base first"),
        (signs.pause, "trial paused; robot held"),
        ("*", "note that the wizard typed"),
        (signs.cursor, "selected row of a list"),
        ("!", "keyboard focus was lost"),
    ];
    meanings.map(|(sign, meaning)| Line::Sign(sign, meaning)).to_vec()
}

/// Columns of the help, and the number of them that fit side by side on the screen.
fn help_columns<'a>(keys: &'a KeyBindings, theme: &Theme, size: (u16, u16)) -> (Vec<Vec<Line<'a>>>, usize) {
    let mut groups: Vec<(&str, Vec<Line>)> = Vec::new();
    for binding in &keys.bindings {
        match groups.iter_mut().find(|(group, _)| *group == binding.group) {
            Some((_, members)) => members.push(Line::Key(binding)),
            None => groups.push((binding.group, vec![Line::Key(binding)])),
        }
    }
    groups.push(("Signs on the screen", legend(theme.signs())));
    let columns = columns(&groups, usize::from(size.1.saturating_sub(3)));
    let fits = usize::from((size.0.saturating_sub(4) / HELP_COLUMNS).max(1)).min(columns.len());
    (columns, fits)
}

/// Number of further pages of the help after the first.
pub fn help_pages(model: &ConsoleModel) -> usize {
    let (columns, fits) = help_columns(&model.keys, &model.theme, model.size);
    columns.len() - fits
}

fn help(brush: &mut Painter, screen: Rect, model: &ConsoleModel) {
    let theme = brush.theme;
    let (columns, fits) = help_columns(&model.keys, &theme, (screen.width, screen.height));
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
            let style = brush.style(TextRole::Strong);
            brush.text(x, y, columns, text, style);
        }
        Line::Sign(sign, meaning) => {
            let style = brush.style(TextRole::Strong);
            brush.text(x + 5, y, 1, sign, style);
            brush.parts(x + HELP_INDENT, y, columns.saturating_sub(HELP_INDENT), &[(meaning, TextRole::Text)]);
        }
        Line::Key(binding) => {
            let (key, indent) = (key_name(binding), key_indent(binding));
            let role = match binding.layer {
                Some(KeyLayer::Wizard) => TextRole::Signal,
                Some(KeyLayer::Participant) => TextRole::Human,
                None => TextRole::Strong,
            };
            let style = brush.style(role);
            brush.text_right(x + indent - 1, y, indent - 1, &key, style);
            brush.parts(x + indent, y, columns.saturating_sub(indent), &[(&binding.help, TextRole::Text)]);
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
