//! Dialogs above the panels: questions to confirm, and texts to read.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::hands;
use super::help;
use super::paint::Painter;
use super::picker;
use super::popup::open;
use super::regions::PanelAreas;
use super::theme::TextRole;
use crate::console::chord::KeyChord;
use crate::console::console_model::{ConsoleModel, Dialog};
use crate::console::key_action::KeyAction;
use crate::console::text_columns::{width, wrap};
use tomcom_session::{Session, TrialPhase};

/// Draws the open dialog, if there is one.
pub fn draw(brush: &mut Painter, screen: Rect, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    match &model.dialog {
        // The question whether to send a clicked signal stands in the line of messages.
        None | Some(Dialog::Send(_)) => {}
        Some(Dialog::Pick(list)) => picker::draw(brush, regions.middle(), session, list),
        Some(Dialog::Palette(cursor)) => picker::draw_palette(brush, regions.middle(), session, model, cursor),
        Some(Dialog::Preflight) => hands::preflight(brush, screen, session, model),
        Some(Dialog::Calibration) => super::gaze_targets::draw(brush, screen, session, model),
        Some(Dialog::Note(line)) => hands::note(brush, screen, session, line),
        Some(Dialog::Answer(line)) => hands::answer(brush, screen, session, line),
        Some(Dialog::Help(effects)) => help::draw(brush, screen, model, effects),
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
