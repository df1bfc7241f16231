//! The check of the calibration: the target in the kitchen, and what came of it.

use ratatui::layout::Rect;

use super::dialog::open;
use super::paint::Brush;
use super::theme::Role;
use crate::console::arrange::Plan;
use crate::console::calibration::{AS_IT_IS, Best, CORRECTED, REPEAT};
use crate::gaze::calibration::{Found, GOOD_DEG, USABLE_DEG};
use crate::session::Session;

const COLUMNS: u16 = 76;
/// Where values begin.
const VALUE: u16 = 15;

/// Draws the target that is to be looked at, where it is on the display.
pub fn target(brush: &mut Brush, plan: &Plan, panel: Rect, session: &Session) {
    let Some(check) = &session.calibration else { return };
    let Some(((index, _), point)) = check.shown.zip(check.target()) else { return };
    let Some((x, y)) = plan.cell(point) else { return };
    let text = format!(" + look here: {} of {} ", index + 1, check.targets.len());
    let columns = super::paint::width(&text).min(panel.width);
    // The cross stands on the target, the words beside it, or before it where there is no room.
    let before = if x + columns < panel.right() { 1 } else { columns.saturating_sub(2) };
    let text = if before == 1 { text } else { format!(" look here: {} of {} + ", index + 1, check.targets.len()) };
    let badge = brush.theme.badge(Role::Gaze);
    let (x, y) = (x.saturating_sub(before).max(panel.x), y.clamp(panel.y, panel.bottom().saturating_sub(1)));
    brush.text(x, y, columns, &text, badge);
}

/// Draws what came of the check; nothing while targets are shown.
pub fn draw(brush: &mut Brush, screen: Rect, session: &Session) {
    let Some(outcome) = session.calibration.as_ref().and_then(|check| check.result.as_ref()) else { return };
    let inside = open(brush, screen, (COLUMNS, 13), "Calibration check", "space stops the robot");
    let columns = inside.width.saturating_sub(2);
    let mut y = inside.y + 1;
    let mut line = |brush: &mut Brush, name: &str, text: &str, role: Role| {
        brush.parts(inside.x + 1, y, VALUE, &[(name, Role::Quiet)]);
        brush.parts(inside.x + 1 + VALUE, y, columns.saturating_sub(VALUE), &[(text, role)]);
        y += 1;
    };
    let again = format!("enter or {REPEAT}");
    let Some(found) = &outcome.found else {
        line(brush, "accuracy", "not known: too few usable samples at the targets", Role::Alarm);
        line(brush, "mend", "look at every target; see that the tracker sends gaze", Role::Text);
        let keys = [
            (again.as_str(), Role::Strong),
            (" repeats it   ", Role::Quiet),
            ("esc", Role::Strong),
            (" leaves", Role::Quiet),
        ];
        brush.parts(inside.x + 1, inside.bottom().saturating_sub(1), columns, &keys);
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
        "offset off",
        &format!("{:.2} deg, {:.1} cm: {words}", found.corrected_deg, cm(found.corrected_deg)),
        role,
    );
    line(brush, "precision", &format!("{:.2} deg from sample to sample", found.precision_deg), Role::Text);
    line(brush, "targets", &targets(found), Role::Text);
    let best = Best::of(Some(found));
    let rows = [
        (CORRECTED, "takes it with the offset taken off", Best::Corrected),
        (AS_IT_IS, "takes it as it is", Best::AsItIs),
        (REPEAT, "repeats the check", Best::Repeat),
    ];
    y += 1;
    for (key, does, is) in rows {
        let (enter, role) = if is == best { ("enter or ", Role::Strong) } else { ("         ", Role::Quiet) };
        let key = format!("{key}  ");
        brush.parts(inside.x + 1, y, columns, &[(enter, Role::Strong), (&key, Role::Strong), (does, role)]);
        y += 1;
    }
    brush.parts(inside.x + 1, y, columns, &[("         esc  ", Role::Strong), ("leaves it as it was", Role::Quiet)]);
}

fn verdict(accuracy_deg: f64) -> (&'static str, Role) {
    match accuracy_deg {
        deg if deg <= GOOD_DEG => ("good", Role::Text),
        deg if deg <= USABLE_DEG => ("usable", Role::Strong),
        _ => ("too far off", Role::Alarm),
    }
}

/// The accuracy at every target, in degrees.
fn targets(found: &Found) -> String {
    let one = |target: &crate::gaze::calibration::FoundTarget| match target.accuracy_deg {
        Some(deg) => format!("{deg:.1}"),
        None => "not seen".to_string(),
    };
    let each: Vec<String> = found.targets.iter().map(one).collect();
    format!("{} deg, the centre first", each.join(", "))
}
