//! Dialogs above the panels: their frame, questions to confirm, lists, text inputs, and texts to read.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::help;
use super::paint::Painter;
use super::regions::{PanelAreas, inside};
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::{ConsoleModel, Dialog, ReplayAction};
use crate::console::form;
use crate::console::key_action::{KeyAction, KeyBinding, ManualAction};
use crate::console::lists::{self, ListCursor, OTHER_REASON, Picker};
use crate::console::mouse::ClickAction;
use crate::console::possible::is_possible_behind;
use crate::console::preflight::{OVERRIDE, all_ok, checks};
use crate::console::text_columns::{width, wrap};
use crate::console::text_input::TextInput;
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_session::history::event_words;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};
use tomcom_session::{Session, TimelineEvent, TrialPhase};

/// Draws the open dialog, if there is one.
pub fn draw(brush: &mut Painter, screen: Rect, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    match &model.dialog {
        // The question whether to send a clicked signal stands in the line of messages.
        None | Some(Dialog::Send(_)) => {}
        Some(Dialog::Pick(list)) => draw_answers(brush, regions.middle(), session, list),
        Some(Dialog::Palette(cursor)) => draw_palette(brush, regions.middle(), session, model, cursor),
        Some(Dialog::Preflight) => preflight(brush, screen, session, model),
        Some(Dialog::Calibration) => super::gaze::draw_accuracy_check(brush, screen, session, model),
        Some(Dialog::Note(line)) => note(brush, screen, session, line),
        Some(Dialog::Reason(_, reason, line)) => {
            let says = match reason.as_str() {
                OTHER_REASON => "Type the reason. No trial runs: the space bar types a space here.",
                _ => "enter without words gives the reason alone. No trial runs: the space bar types a space here.",
            };
            input_line(brush, screen, line, (&format!("{reason}: in words"), ""), says);
        }
        Some(Dialog::Answer(line)) => answer(brush, screen, session, line),
        Some(Dialog::Help(effects)) => help::draw(brush, screen, model, effects),
        Some(Dialog::Details(title, lines)) => details(brush, screen, title, lines),
        Some(Dialog::Report(lines)) => report(brush, screen, lines, model),
        Some(Dialog::EndTrial) => {
            let yes = yes_keys(model, &KeyAction::EndTrial);
            let presses = format!("{} of {} presses", session.all_presses(), session.spec.trial.presses);
            let abort = model.keys.chord_for(&KeyAction::Manual(ManualAction::Abort));
            let abort = abort.map_or(String::new(), |key| format!("{key} aborts it instead: then it does not count."));
            let [counts, instead] = match &session.excluded {
                Some(reason) => {
                    [format!("It ends with {presses}, and cannot be resumed."), format!("It is excluded: {reason}.")]
                }
                None => [format!("It counts with {presses}, and cannot be resumed."), abort],
            };
            ask(brush, screen, "End the trial?", &[&counts, &instead], &yes);
        }
        Some(Dialog::EndTutorial) => {
            let lines = ["The participant does not see its other pages,", "and cannot go back to it."];
            ask(brush, screen, "End the tutorial?", &lines, "y");
        }
        Some(Dialog::Quit) => {
            let lines: &[&str] = match session.phase {
                _ if model.lesson.is_some() => &["The training ends without a saved result."],
                TrialPhase::Running | TrialPhase::Paused => {
                    &["The trial is not over.", "The recording is kept, and can go on."]
                }
                _ if session.is_empty() => &["No trial was begun: nothing is kept."],
                _ if session.protocol.is_some() && !session.is_step_done() => {
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
    let widest = lines.iter().map(|line| width(line)).max().unwrap_or(0);
    let inside = open(brush, screen, ((widest + 5).max(46), lines.len() as u16 + 5), title, "");
    for (row, line) in lines.iter().enumerate() {
        brush.text(inside.x + 2, inside.y + 1 + row as u16, inside.width - 3, line, TextRole::Text);
    }
    let hints = [(yes, "yes", Some(KeyChord::char('y'))), ("any other key", "no", Some(KeyChord::plain(KeyCode::Esc)))];
    brush.hints(inside.x + 2, inside.bottom() - 1, inside.width - 3, &hints);
}

fn details(brush: &mut Painter, screen: Rect, title: &str, lines: &[String]) {
    let columns = (screen.width - 4).min(100);
    let wrapped: Vec<(bool, String)> = lines
        .iter()
        .enumerate()
        .flat_map(|(index, line)| wrap(line, columns - 4).into_iter().map(move |line| (index == 0, line)))
        .collect();
    let rows = wrapped.len() as u16 + 2;
    let inside = open(brush, screen, (columns, rows), title, "any key closes");
    for (row, (is_head, line)) in wrapped.iter().enumerate().take(usize::from(inside.height)) {
        let role = if *is_head { TextRole::Strong } else { TextRole::Text };
        brush.text(inside.x + 1, inside.y + row as u16, inside.width - 2, line, role);
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

fn report(brush: &mut Painter, screen: Rect, lines: &[String], model: &ConsoleModel) {
    let (columns, lines, rows) = report_lines(lines, (screen.width, screen.height));
    let rest = lines.len().saturating_sub(rows);
    let from = model.help_from.min(rest);
    let remark = if rest == 0 { "" } else { "up, down: more of the report" };
    let size = (columns, lines.len().min(rows) as u16 + 4);
    let inside = open(brush, screen, size, "The training is over", remark);
    for (row, line) in lines.iter().skip(from).take(rows).enumerate() {
        let role = if from + row == 0 { TextRole::Strong } else { TextRole::Text };
        brush.text(inside.x + 1, inside.y + row as u16, inside.width - 2, line, role);
    }
    let hints = [("enter", "continue; this report is saved", Some(KeyChord::plain(KeyCode::Enter)))];
    brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width - 2, &hints);
}

const COLUMNS: u16 = 76;
/// Label before the remedy of a failed preflight check.
const FIX: &str = "fix: ";
/// Rows around the preflight checks: frame, space, key hints.
const AROUND_CHECKS: usize = 5;
/// Column at which the findings of the preflight checks begin.
const FOUND: u16 = 23;

pub fn preflight(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    let checks = checks(session, model);
    let columns = (COLUMNS + 24).min(screen.width);
    // Width left for a finding: inside the frame, after the names of the checks.
    let room = columns.saturating_sub(2 + FOUND + 1);
    let remedies: Vec<Vec<String>> = checks
        .iter()
        .map(|check| {
            check.remedy.as_ref().map_or(Vec::new(), |remedy| wrap(remedy, room.saturating_sub(FIX.len() as u16)))
        })
        .collect();
    let mut findings: Vec<Vec<String>> = checks.iter().map(|check| wrap(&check.found, room)).collect();
    let rows_of = |findings: &[Vec<String>]| findings.iter().chain(&remedies).map(Vec::len).sum::<usize>();
    // On a small screen the end of a long finding gives way to the checks below it.
    if rows_of(&findings) + AROUND_CHECKS > usize::from(screen.height) {
        findings = checks.iter().map(|check| vec![check.found.clone()]).collect();
    }
    let rows = rows_of(&findings);
    let size = (columns, (rows + AROUND_CHECKS) as u16);
    let inside = open(brush, screen, size, "Checks before the trial", "space stops the robot");
    let mut y = inside.y;
    for ((check, found), remedy) in checks.iter().zip(&findings).zip(&remedies) {
        y = line(brush, inside, y, check, found);
        for (row, words) in remedy.iter().enumerate() {
            let fix = if row == 0 { FIX } else { "     " };
            brush.parts(inside.x + FOUND, y, room, &[(fix, TextRole::Quiet), (words, TextRole::Text)]);
            y += 1;
        }
    }
    let start = model.keys.chord_for(&KeyAction::Advance);
    let (key, chord, does) = match all_ok(&checks) {
        true => (start.map_or(String::new(), |key| key.to_string()), start, "start the trial"),
        false => (OVERRIDE.to_string(), Some(KeyChord::char(OVERRIDE)), "start the trial anyway"),
    };
    let esc = ("esc", "close the list", Some(KeyChord::plain(KeyCode::Esc)));
    let hints = [(key.as_str(), does, chord), esc];
    let hints = if session.phase == TrialPhase::Ready { &hints[..] } else { &hints[1..] };
    brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), inside.width.saturating_sub(2), hints);
}

/// Draws a check with the lines of what was found; returns the row below.
fn line(brush: &mut Painter, inside: Rect, y: u16, check: &PreflightCheck, found: &[String]) -> u16 {
    let (word, role) = match check.verdict {
        PreflightVerdict::Ok => ("ok", TextRole::Text),
        PreflightVerdict::Warning => ("warning", TextRole::Strong),
        PreflightVerdict::Failed => ("FAILED", TextRole::Alarm),
    };
    brush.text(inside.x + 1, y, 8, word, role);
    brush.text(inside.x + 10, y, FOUND - 11, &check.name, TextRole::Text);
    let x = inside.x + FOUND;
    let rows = y..y + found.len().max(1) as u16;
    for (y, words) in rows.clone().zip(found) {
        brush.text(x, y, inside.right().saturating_sub(x + 1), words, role);
    }
    rows.end
}

pub fn note(brush: &mut Painter, screen: Rect, session: &Session, text: &TextInput) {
    // A trial goes on by itself after a freeze probe.
    let (remark, says) = match session.is_running() {
        true => ("the trial runs: space stops the robot", "The trial goes on, so the space bar stops the robot."),
        false => {
            let says = "No trial runs and the robot stands, so the space bar types a space here.";
            ("no trial is running: space types a space", says)
        }
    };
    let (title, marks) = match session.open_marks.as_slice() {
        [] => ("Note to be recorded".to_string(), String::new()),
        [(_, at), others @ ..] => {
            let more = match others.len() as u64 {
                0 => String::new(),
                more => format!(" {} after it.", count(more, "further mark", "further marks")),
            };
            let clock = session.trial_clock_at(*at);
            let around = presses_around(session, *at);
            let says = format!("{around}enter alone leaves it without words.{more} ");
            (format!("The time mark at {clock}: its words"), says)
        }
    };
    // The title of a mark has no room for it beside; below it is said anyhow.
    let remark = if marks.is_empty() { remark } else { "" };
    input_line(brush, screen, text, (&title, remark), &(marks + says));
}

/// The two presses before a time mark and the one after it, in words.
fn presses_around(session: &Session, mark: SessionTime) -> String {
    let presses = session.timeline.iter().filter(|entry| matches!(entry.what, TimelineEvent::Press { .. }));
    let (before, after): (Vec<_>, Vec<_>) = presses.partition(|entry| entry.time <= mark);
    let told = before[before.len().saturating_sub(2)..].iter().chain(after.first()).map(|entry| {
        let (who, what) = event_words::happening(&session.kitchen, &entry.what);
        format!("{} {who} {what}\n", session.trial_clock_at(entry.time))
    });
    told.collect()
}

/// Draws the text input of a questionnaire answer below its item.
pub fn answer(brush: &mut Painter, screen: Rect, session: &Session, text: &TextInput) {
    let shown = session.protocol.as_ref().map_or(0, |protocol| protocol.item);
    let item = session.questionnaire().and_then(|asked| asked.items.get(shown));
    let says = form::debriefing_question(session).or(item.map(|item| item.text.as_str())).unwrap_or_default();
    input_line(brush, screen, text, ("Answer", "no trial is running: space types a space"), says);
}

fn input_line(brush: &mut Painter, screen: Rect, text: &TextInput, (title, remark): (&str, &str), says: &str) {
    let lines: Vec<String> = says.lines().flat_map(|line| wrap(line, COLUMNS - 4)).collect();
    let size = (COLUMNS, lines.len() as u16 + 7);
    let inside = open(brush, screen, size, title, remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let [before, under, after] = text.parts(usize::from(columns));
    let badge = brush.theme.badge(TextRole::Text);
    let at = brush.text(x, inside.y + 1, columns, &before, TextRole::Strong);
    let at = brush.styled(at, inside.y + 1, (x + columns).saturating_sub(at), &under, badge);
    brush.text(at, inside.y + 1, (x + columns).saturating_sub(at), &after, TextRole::Strong);
    for (row, line) in lines.iter().enumerate() {
        brush.text(x, inside.y + 3 + row as u16, columns, line, TextRole::Quiet);
    }
    let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
    let hints = [("enter", "save the text", enter), ("esc", "cancel", esc)];
    brush.hints(x, inside.bottom().saturating_sub(1), columns, &hints);
}

/// Largest size of a list: columns and rows.
const MOST: (u16, u16) = (72, 26);
/// Largest width of a list with a replay's events, whose words are long.
const MOST_EVENTS: u16 = 112;
/// Rows around a list: frame, search line, separator, key hints.
const AROUND: u16 = 6;
/// Text that says how the entries of a list are filtered.
pub(super) const TYPE: &str = "type to filter (no spaces): ";

/// A row of a list: text, remark at the right, and whether choosing the row has an effect now.
struct Row {
    /// The digit that chooses the row, or room for it; empty in lists without numbers.
    number: String,
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
    /// What is said where no row matches the filter.
    none: &'a str,
    /// What typing does.
    types: &'a str,
    /// Keys that select a row.
    selects: &'a str,
    space: &'a str,
    takes: &'a str,
    most_columns: u16,
}

pub fn draw_answers(brush: &mut Painter, screen: Rect, session: &Session, picker: &Picker) {
    // Digits that are typed after a letter are part of the filter.
    let (takes_words, is_filtered) = (picker.takes_words(session), !picker.cursor.filter.is_empty());
    let number = |index: usize| match index {
        0..9 if !is_filtered => format!("{} ", index + 1),
        _ => "  ".to_string(),
    };
    let rows: Vec<Row> = picker
        .choices(session)
        .into_iter()
        .enumerate()
        .map(|(index, choice)| Row { number: number(index), label: choice.label, remark: choice.remark, counts: true })
        .collect();
    let all = Picker::new(picker.kind).choices(session).len();
    let digits = format!("1-{}, up/down", all.clamp(1, 9));
    ListPage {
        title: picker.title(session),
        cursor: &picker.cursor,
        rows,
        all,
        none: "no entry matches",
        types: if takes_words { "type to filter, or a reason in words: " } else { TYPE },
        selects: if is_filtered { "up/down" } else { &digits },
        space: if takes_words && is_filtered { "space types a space" } else { STOPS },
        takes: if takes_words { "choose; words can follow" } else { "choose" },
        most_columns: MOST.0,
    }
    .draw(brush, screen);
}

/// Text for what the space bar does in a list of a live session.
const STOPS: &str = "space stops the robot";

/// Draws the palette (the list of all actions): key, action, and group; actions without an effect now are grey and say so.
pub fn draw_palette(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel, cursor: &ListCursor) {
    let row = |line: &&KeyBinding| {
        let key = line.chords.first().map_or(String::new(), KeyChord::to_string);
        let counts = is_possible_behind(session, model, &line.action);
        let remark = if counts { line.group } else { "no effect now" };
        Row { number: String::new(), label: format!("{key:>7}  {}", line.help), remark: remark.to_string(), counts }
    };
    let rows = match lists::place(model, cursor) {
        Some((_, label)) => vec![Row { number: String::new(), label, remark: String::new(), counts: true }],
        None => {
            let event = |(_, words): &(ReplayAction, String)| Row {
                number: String::new(),
                label: words.clone(),
                remark: String::new(),
                counts: true,
            };
            let events = lists::events(model, cursor).into_iter().map(event);
            lists::actions(model, cursor).iter().map(row).chain(events).collect()
        }
    };
    let all = lists::actions(model, &ListCursor::default());
    let has_signals = all.iter().any(|line| matches!(line.action, KeyAction::Signal(..)));
    let takes = if has_signals { "run action (signal: show key)" } else { "run the action" };
    let is_replay = all.iter().any(|line| matches!(line.action, KeyAction::Move(_)));
    let types = if is_replay { "type words, or 2:13, or error 7: " } else { TYPE };
    let space = if model.playback.is_none() { STOPS } else { "" };
    let title = "All actions".to_string();
    let told = model.playback.as_ref().map_or(0, |playback| playback.told.len());
    let (all, none) = (all.len() + told, if told > 0 { "no such command or event" } else { "no such command" });
    let (selects, most_columns) = ("up/down", if told > 0 { MOST_EVENTS } else { MOST.0 });
    ListPage { title, cursor, rows, all, none, types, selects, space, takes, most_columns }.draw(brush, screen);
}

impl ListPage<'_> {
    fn draw(&self, brush: &mut Painter, screen: Rect) {
        // The height of the list stays the same while the filter changes.
        let rows = self.all.min(usize::from(MOST.1)) as u16 + AROUND;
        let size = (self.most_columns.min(screen.width), rows.min(MOST.1).min(screen.height));
        let inside = open(brush, screen, size, &self.title, self.space);
        let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
        let typed = format!("{}_", self.cursor.filter);
        let found = format!("{} of {}", self.rows.len(), self.all);
        brush.parts(x, inside.y, columns, &[(self.types, TextRole::Quiet), (&typed, TextRole::Strong)]);
        brush.text_right(x + columns, inside.y, 12, &found, TextRole::Quiet);
        let list = Rect { x, y: inside.y + 2, width: columns, height: inside.height.saturating_sub(4) };
        let shown = usize::from(list.height).max(1);
        let first = self.cursor.at.saturating_sub(shown / 2).min(self.rows.len().saturating_sub(shown));
        for (line, row) in self.rows.iter().skip(first).take(shown).enumerate() {
            let cells = Rect { y: list.y + line as u16, height: 1, ..list };
            row.draw(brush, cells, first + line == self.cursor.at);
            brush.target(cells, ClickAction::Row(first + line));
        }
        if self.rows.is_empty() {
            let none = format!("{}; bksp deletes a letter", self.none);
            brush.text(list.x, list.y, list.width, &none, TextRole::Quiet);
        }
        let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
        let hints = [(self.selects, "select", None), ("enter", self.takes, enter), ("esc", "back", esc)];
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
        let parts = [
            (cursor, TextRole::Signal),
            (" ", role),
            (self.number.as_str(), TextRole::Signal),
            (self.label.as_str(), role),
        ];
        brush.parts(cells.x, cells.y, label + 2, &parts);
        brush.text_right(cells.right(), cells.y, remark, &self.remark, TextRole::Quiet);
    }
}

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
    brush.frame(area, TextRole::Strong);
    brush.text(area.x + 2, area.y, columns, &format!(" {title} "), TextRole::Strong);
    if !remark.is_empty() {
        brush.text_right(area.right() - 2, area.y, columns, &format!(" {remark} "), TextRole::Strong);
    }
    inside(area)
}
