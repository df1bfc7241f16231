//! Gaze accuracy check on the console: the present target in the kitchen panel, and the result.

use crossterm::event::KeyCode;
use ratatui::layout::Rect;

use super::paint::Painter;
use super::popup::open;
use super::theme::TextRole;
use crate::console::arrange::KitchenMap;
use crate::console::chord::KeyChord;
use crate::console::console_model::ConsoleModel;
use crate::console::gaze_advice::AccuracyCheckAction;
use crate::console::gaze_targets::{AS_IT_IS, CORRECTED, REPEAT, chosen};
use crate::console::text_columns::width;
use tomcom_core::gaze::calibration::{GOOD_DEG, GazeAccuracy, USABLE_DEG};
use tomcom_session::Session;

const COLUMNS: u16 = 76;
/// Column, inside the frame, at which the measured values of the gaze accuracy check begin.
const VALUE: u16 = 15;

/// Draws the present target of the gaze accuracy check in the kitchen panel.
pub fn target(brush: &mut Painter, plan: &KitchenMap, panel: Rect, session: &Session) {
    let Some(check) = &session.calibration else { return };
    let Some(((index, _), point)) = check.shown.zip(check.target()) else { return };
    let Some((x, y)) = plan.cell(point) else { return };
    let text = format!(" + look here: target {} of {} ", index + 1, check.targets.len());
    let columns = width(&text).min(panel.width);
    // The cross is on the target; the instruction stands to its right, or to its left if there is no room.
    let before = if x + columns < panel.right() { 1 } else { columns.saturating_sub(2) };
    let text =
        if before == 1 { text } else { format!(" look here: target {} of {} + ", index + 1, check.targets.len()) };
    let badge = brush.theme.badge(TextRole::Gaze);
    let (x, y) = (x.saturating_sub(before).max(panel.x), y.clamp(panel.y, panel.bottom().saturating_sub(1)));
    brush.text(x, y, columns, &text, badge);
}

/// Draws the result of the gaze accuracy check, once all targets have been shown.
pub fn draw(brush: &mut Painter, screen: Rect, session: &Session, model: &ConsoleModel) {
    let Some(outcome) = session.calibration.as_ref().and_then(|check| check.result.as_ref()) else { return };
    let inside = open(brush, screen, (COLUMNS, 13), "Gaze accuracy check", "space stops the robot");
    let columns = inside.width.saturating_sub(2);
    let mut y = inside.y + 1;
    let mut line = |brush: &mut Painter, name: &str, text: &str, role: TextRole| {
        brush.parts(inside.x + 1, y, VALUE, &[(name, TextRole::Quiet)]);
        brush.parts(inside.x + 1 + VALUE, y, columns.saturating_sub(VALUE), &[(text, role)]);
        y += 1;
    };
    let esc = KeyChord::plain(KeyCode::Esc);
    let again = format!("enter or {REPEAT}");
    let Some(found) = &outcome.found else {
        line(brush, "accuracy", "not measured: too few usable gaze samples at the targets", TextRole::Alarm);
        line(brush, "fix", "let the participant look at every target; check the tracker", TextRole::Text);
        let hints = [
            (again.as_str(), "repeat the gaze accuracy check", Some(KeyChord::char(REPEAT))),
            ("esc", "cancel the check", Some(esc)),
        ];
        brush.hints(inside.x + 1, inside.bottom().saturating_sub(1), columns, &hints);
        return;
    };
    let (words, role) = verdict(found.accuracy_deg);
    let cm = |deg: f64| deg.to_radians().tan() * session.spec.tracker.distance_m * 100.0;
    line(
        brush,
        "accuracy",
        &format!("{:.2} deg, {:.1} cm on the display: {words}", found.accuracy_deg, cm(found.accuracy_deg)),
        role,
    );
    let (words, role) = verdict(found.corrected_deg);
    line(
        brush,
        "corrected",
        &format!("{:.2} deg, {:.1} cm without the offset: {words}", found.corrected_deg, cm(found.corrected_deg)),
        role,
    );
    line(brush, "precision", &format!("{:.2} deg (RMS between samples)", found.precision_deg), TextRole::Text);
    line(brush, "targets", &targets(found), TextRole::Text);
    let taken = chosen(model, Some(found));
    let rows = [
        (CORRECTED, "accept the gaze with its offset subtracted", AccuracyCheckAction::Corrected),
        (AS_IT_IS, "accept the gaze without correction", AccuracyCheckAction::AsItIs),
        (REPEAT, "repeat the gaze accuracy check", AccuracyCheckAction::Repeat),
    ];
    y += 1;
    for (key, does, is) in rows {
        let is_taken = is == taken;
        let (enter, role) = if is_taken { ("enter    ", TextRole::Strong) } else { ("         ", TextRole::Quiet) };
        let words = format!("{key}  ");
        let parts = [(enter, TextRole::Strong), (words.as_str(), TextRole::Strong), (does, role)];
        let end = brush.parts(inside.x + 1, y, columns, &parts);
        // The first click on an action selects it, the next click carries it out.
        let chord = if is_taken { KeyChord::plain(KeyCode::Enter) } else { KeyChord::char(key) };
        brush.key_target(inside.x + 1, y, end, chord);
        y += 1;
    }
    let parts = [("         esc  ", TextRole::Strong), ("cancel: the gaze stays as before", TextRole::Quiet)];
    let end = brush.parts(inside.x + 1, y, columns, &parts);
    brush.key_target(inside.x + 1, y, end, esc);
}

fn verdict(accuracy_deg: f64) -> (&'static str, TextRole) {
    match accuracy_deg {
        deg if deg <= GOOD_DEG => ("good", TextRole::Text),
        deg if deg <= USABLE_DEG => ("usable", TextRole::Strong),
        _ => ("too far off", TextRole::Alarm),
    }
}

/// Measured gaze accuracy at every target, in degrees.
fn targets(found: &GazeAccuracy) -> String {
    let one = |target: &tomcom_core::gaze::calibration::TargetAccuracy| match target.accuracy_deg {
        Some(deg) => format!("{deg:.1}"),
        None => "no gaze".to_string(),
    };
    let each: Vec<String> = found.targets.iter().map(one).collect();
    format!("{} deg, centre target first", each.join(", "))
}
