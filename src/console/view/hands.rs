//! The list of preflight checks, and the text input of notes and answers.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::paint::Painter;
use super::popup::open;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyAction;
use crate::console::note::TextInput;
use crate::console::preflight::{OVERRIDE, all_ok, checks};
use crate::console::text_columns::wrap;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};
use tomcom_session::{Session, TrialPhase};

const COLUMNS: u16 = 76;
/// Label before the remedy of a failed preflight check.
const FIX: &str = "fix: ";
/// Column at which the findings of the preflight checks begin.
const FOUND: u16 = 23;

/// Draws the list of preflight checks.
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
    let rows = checks.len() + remedies.iter().map(Vec::len).sum::<usize>();
    let inside = open(brush, screen, (columns, rows as u16 + 5), "Checks before the trial", "space stops the robot");
    let mut y = inside.y;
    for (check, remedy) in checks.iter().zip(&remedies) {
        line(brush, inside, y, check);
        y += 1;
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

fn line(brush: &mut Painter, inside: Rect, y: u16, check: &PreflightCheck) {
    let (word, role) = match check.verdict {
        PreflightVerdict::Ok => ("ok", TextRole::Text),
        PreflightVerdict::Warning => ("warning", TextRole::Strong),
        PreflightVerdict::Failed => ("FAILED", TextRole::Alarm),
    };
    brush.parts(inside.x + 1, y, 8, &[(word, role)]);
    brush.parts(inside.x + 10, y, FOUND - 11, &[(&check.name, TextRole::Text)]);
    let x = inside.x + FOUND;
    brush.parts(x, y, inside.right().saturating_sub(x + 1), &[(&check.found, role)]);
}

/// Draws the text input of the wizard's note.
pub fn note(brush: &mut Painter, screen: Rect, session: &Session, text: &TextInput) {
    // A trial goes on by itself after a freeze probe.
    let (remark, says) = match session.is_running() {
        true => ("the trial runs: space stops the robot", "The trial goes on, so the space bar stops the robot."),
        false => {
            let says = "No trial runs and the robot stands, so the space bar types a space here.";
            ("no trial is running: space types a space", says)
        }
    };
    input_line(brush, screen, text, ("Note to be recorded", remark), says);
}

/// Draws the text input of a questionnaire answer below its item.
pub fn answer(brush: &mut Painter, screen: Rect, session: &Session, text: &TextInput) {
    let shown = session.protocol.as_ref().map_or(0, |protocol| protocol.item);
    let item = session.questionnaire().and_then(|asked| asked.items.get(shown));
    let says = item.map_or("", |item| item.text.as_str());
    input_line(brush, screen, text, ("Answer", "no trial is running: space types a space"), says);
}

fn input_line(brush: &mut Painter, screen: Rect, text: &TextInput, (title, remark): (&str, &str), says: &str) {
    let lines = wrap(says, COLUMNS - 4);
    let size = (COLUMNS, lines.len() as u16 + 7);
    let inside = open(brush, screen, size, title, remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let [before, under, after] = text.parts(usize::from(columns));
    let style = brush.style(TextRole::Strong);
    let badge = brush.theme.badge(TextRole::Text);
    let at = brush.text(x, inside.y + 1, columns, &before, style);
    let at = brush.text(at, inside.y + 1, (x + columns).saturating_sub(at), &under, badge);
    brush.text(at, inside.y + 1, (x + columns).saturating_sub(at), &after, style);
    let quiet = brush.style(TextRole::Quiet);
    for (row, line) in lines.iter().enumerate() {
        brush.text(x, inside.y + 3 + row as u16, columns, line, quiet);
    }
    let [enter, esc] = [KeyCode::Enter, KeyCode::Esc].map(|code| Some(KeyChord::plain(code)));
    let hints = [("enter", "save the text", enter), ("esc", "cancel", esc)];
    brush.hints(x, inside.bottom().saturating_sub(1), columns, &hints);
}
