//! The robot: what it is about to press, how far the arm is, and why it does nothing.

use super::paint::Brush;
use super::regions::{Regions, Room};
use super::theme::Role;
use crate::base::words::count;
use crate::console::hands::Hand;
use crate::console::keys::Action;
use crate::console::model::Model;
use crate::console::words;
use crate::kitchen::Agent;
use crate::robot::IdleReason;
use crate::session::{Phase, Session};

/// Draws the robot panel.
pub fn draw(brush: &mut Brush, regions: &Regions, session: &Session, model: &Model) {
    let area = regions.robot;
    if area.area() == 0 {
        return;
    }
    if regions.room == Room::Small {
        brush.parts(area.x, area.y, area.width, &[(" robot    ", Role::Quiet)]);
        line(brush, area.x + 10, area.y, area.width.saturating_sub(11), session, model);
        return;
    }
    let remark = match (session.robot.stopped, session.robot.held, &model.playback) {
        (true, ..) => "STOPPED".to_string(),
        (false, true, _) => release(model),
        (false, false, None) => "space stops it".to_string(),
        (false, false, Some(_)) => String::new(),
    };
    let inside = brush.panel(area, "Robot", &remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    line(brush, x, inside.y, columns, session, model);
    let held = session.kitchen.content_label(session.state, session.kitchen.hands[Agent::Robot.index()]);
    let presses = count(u64::from(session.presses[Agent::Robot.index()]), "press", "presses");
    brush.parts(x, inside.y + 1, columns, &[("holds ", Role::Quiet), (held, Role::Text)]);
    let quiet = brush.style(Role::Quiet);
    brush.text_right(x + columns, inside.y + 1, columns / 2, &presses, quiet);
}

fn line(brush: &mut Brush, x: u16, y: u16, columns: u16, session: &Session, model: &Model) {
    if session.robot.stopped {
        let key = model.keys.of(&Action::ResumeRobot).filter(|_| session.phase != Phase::Closed);
        let resume = key.map(|key| format!(": {key} lets it go on")).unwrap_or_default();
        let badge = brush.theme.badge(Role::Alarm);
        let x = brush.text(x, y, columns, " STOPPED ", badge);
        brush.parts(x, y, columns.saturating_sub(9), &[(&resume, Role::Text)]);
        return;
    }
    let (x, columns) = if session.robot.held { held(brush, x, y, columns, model) } else { (x, columns) };
    let Some((button, since, until)) = session.robot.intention else {
        let why = match session.robot.idle {
            _ if session.robot.held => "",
            Some(IdleReason::NoOrder) => "waits: there is no order",
            Some(IdleReason::HumanTurn) => "waits: only the human can go on",
            Some(IdleReason::Skipped) => "waits: its only press was skipped",
            None => "at rest",
        };
        brush.parts(x, y, columns, &[(why, Role::Quiet)]);
        return;
    };
    let now = if session.is_running() { model.now } else { session.paused_at };
    let whole_s = until.secs_since(since).max(1e-3);
    let left_s = until.secs_since(now);
    let label = format!("{} {}", brush.theme.signs().to, words::button(&session.kitchen, Agent::Robot, button));
    let bar = 8.min(columns / 4);
    let by = if session.robot.driven { " by hand" } else { "" };
    brush.parts(x, y, columns.saturating_sub(bar + 7), &[(&label, Role::Robot), (by, Role::Signal)]);
    let at = brush.bar(x + columns - bar - 6, y, bar, 1.0 - left_s / whole_s, Role::Robot);
    brush.parts(at, y, 6, &[(&format!(" {left_s:>3.1} s"), Role::Text)]);
}

/// The key that releases the robot.
fn release(model: &Model) -> String {
    model.keys.of(&Action::Hand(Hand::HoldRobot)).map(|key| format!("{key} releases it")).unwrap_or_default()
}

/// Says that the robot is held; where the line goes on, and how much room is left.
fn held(brush: &mut Brush, x: u16, y: u16, columns: u16, model: &Model) -> (u16, u16) {
    let badge = brush.theme.badge(Role::Strong);
    let end = brush.text(x, y, columns, " HELD ", badge);
    let left = (x + columns).saturating_sub(end);
    let how = if left > 50 { format!(" {} ", release(model)) } else { " ".to_string() };
    let end = brush.parts(end, y, left, &[(&how, Role::Quiet)]);
    (end, (x + columns).saturating_sub(end))
}
