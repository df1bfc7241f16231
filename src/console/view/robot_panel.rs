//! The robot panel: ongoing press, progress of the arm, reason for being idle, and joint angles of the arm.

use std::f64::consts::TAU;

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::console_model::ConsoleModel;
use crate::console::key_action::KeyAction;
use crate::console::key_action::ManualAction;
use crate::console::text_columns::width;
use tomcom_core::base::text::count;
use tomcom_core::kitchen::Agent;
use tomcom_core::robot::ArmSample;
use tomcom_core::robot::{SLOWS_M, SafetyMode};
use tomcom_session::history::wording;
use tomcom_session::settings::ArmKind;
use tomcom_session::{Session, TrialPhase};

/// Draws the robot panel.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.robot;
    if area.area() == 0 {
        return;
    }
    if regions.room == ScreenSize::Small {
        brush.parts(area.x, area.y, area.width, &[(" robot    ", TextRole::Quiet)]);
        let (mut columns, mode) = (area.width.saturating_sub(11), session.robot.arm.mode);
        // Other modes than this one stand in the head line.
        if mode == SafetyMode::Reduced && !session.robot.stopped {
            let name = format!(" {}", mode.name());
            columns = columns.saturating_sub(name.len() as u16);
            brush.parts(area.x + 10 + columns, area.y, name.len() as u16, &[(&name, mode_role(mode))]);
        }
        line(brush, area.x + 10, area.y, columns, session, model);
        return;
    }
    let is_arm = session.spec.robot.arm == ArmKind::Physics;
    let remark = match (session.robot.stopped, session.robot.held, &model.playback) {
        (true, ..) => String::new(),
        (false, true, _) => release(model),
        (false, false, None) => "space stops the robot".to_string(),
        (false, false, Some(_)) => String::new(),
    };
    let mode = session.robot.arm.mode;
    let name = if is_arm && !mode.is_stopped() { mode.name() } else { "" };
    let between = if name.is_empty() || remark.is_empty() { "" } else { "  " };
    let title = if is_arm { "UR5" } else { "Robot" };
    let parts = [(name, mode_role(mode)), (between, TextRole::Quiet), (&remark, TextRole::Quiet)];
    // The arm's mode comes before the hint where there is room for one of them.
    let columns = [title, name, between, &remark].map(width).iter().sum::<u16>();
    let is_crowded = !name.is_empty() && columns + 6 >= area.width;
    let inside = brush.panel_with(area, title, if is_crowded { &parts[..1] } else { &parts });
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    line(brush, x, inside.y, columns, session, model);
    // In a low panel the pose of the arm has priority over the content of the robot's hand, which the kitchen panel
    // also shows.
    match session.robot.arm.last {
        Some((_, moment)) if inside.height < 4 => arm(brush, x, inside.y + 1, columns, session, &moment),
        Some((_, moment)) => {
            holds(brush, x, inside.y + 1, columns, session);
            arm(brush, x, inside.y + 2, columns, session, &moment);
            joints(brush, x, inside.y + 3, columns, &moment);
        }
        None => holds(brush, x, inside.y + 1, columns, session),
    }
}

/// Draws the content of the robot's hand and its number of presses.
fn holds(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session) {
    let held = session.kitchen.content_label(session.state, session.kitchen.hands[Agent::Robot.index()]);
    let presses = count(u64::from(session.presses[Agent::Robot.index()]), "press", "presses");
    brush.parts(x, y, columns, &[("holds ", TextRole::Quiet), (held, TextRole::Text)]);
    let quiet = brush.style(TextRole::Quiet);
    brush.text_right(x + columns, y, columns / 2, &presses, quiet);
}

/// Draws the arm's motion phase, joint angles as bars, distance of the human's hand, and contact force.
fn arm(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, moment: &ArmSample) {
    let signs = brush.theme.signs();
    let bar = |angle: &f64| signs.levels[((angle / TAU + 0.5) * 8.0).clamp(0.0, 7.0) as usize];
    let bars: String = moment.joints.iter().map(bar).collect();
    let is_over = matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed);
    let phase = if session.robot.stopped || is_over { "stopped" } else { wording::arm_phase(moment.phase) };
    let phase = format!("{phase:<10} ");
    let hand = match moment.hand_away_m {
        away_m if away_m < 0.005 => " hand at arm".to_string(),
        away_m => format!(" hand {away_m:>4.2} m"),
    };
    let force = match moment.force_n {
        force_n if force_n >= 0.5 => format!(" {force_n:>3.0} N"),
        _ => format!(" {:>3}  ", signs.dash),
    };
    let hand_role = if moment.hand_away_m < SLOWS_M { TextRole::Human } else { TextRole::Quiet };
    let parts =
        [(phase.as_str(), TextRole::Text), (&bars, TextRole::Robot), (&hand, hand_role), (&force, TextRole::Text)];
    brush.parts(x, y, columns, &parts);
}

/// Draws the arm's joint angles in degrees.
fn joints(brush: &mut Painter, x: u16, y: u16, columns: u16, moment: &ArmSample) {
    let angles: String = moment.joints.iter().map(|angle| format!("{:>6.0}", angle.to_degrees())).collect();
    brush.parts(x, y, columns, &[("joints", TextRole::Quiet), (&angles, TextRole::Text), (" deg", TextRole::Quiet)]);
}

/// Draws the stop of the robot with its reason and the key that resumes it.
fn stopped(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, model: &ConsoleModel) {
    let label = format!(" {} ", session.robot.safety_mode().name());
    let key = model.keys.chord_for(&KeyAction::ResumeRobot).filter(|_| session.phase != TrialPhase::Closed);
    let resume = key.map(|key| format!(" {key} resume")).unwrap_or_default();
    let force = session.robot.arm.stopped_by_n.map(|force_n| format!(" {force_n:.0} N")).unwrap_or_default();
    let badge = brush.theme.badge(TextRole::Alarm);
    let end = brush.text(x, y, columns, &label, badge);
    brush.parts(end, y, (x + columns).saturating_sub(end), &[(&force, TextRole::Alarm), (&resume, TextRole::Text)]);
}

/// Style in which a safety mode of the robot is drawn.
fn mode_role(mode: SafetyMode) -> TextRole {
    match mode {
        SafetyMode::Normal => TextRole::Quiet,
        SafetyMode::Reduced | SafetyMode::Safeguard => TextRole::Strong,
        _ => TextRole::Alarm,
    }
}

fn line(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, model: &ConsoleModel) {
    if session.robot.stopped {
        stopped(brush, x, y, columns, session, model);
        return;
    }
    let (x, columns) = if session.robot.held { held(brush, x, y, columns, model) } else { (x, columns) };
    if matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed) {
        brush.parts(x, y, columns, &[("stopped: the trial is over", TextRole::Quiet)]);
        return;
    }
    let Some((button, since, until)) = session.robot.intention else {
        let why = match &session.robot.idle {
            _ if session.robot.held => String::new(),
            Some((reason, waits_for)) => {
                let human = &session.kitchen.buttons[Agent::Human.index()];
                let names: Vec<&str> = waits_for.iter().map(|button| human[button.index()].name.as_str()).collect();
                wording::idle(*reason, &names, usize::from(columns))
            }
            None => "no press planned".to_string(),
        };
        brush.parts(x, y, columns, &[(&why, TextRole::Quiet)]);
        return;
    };
    let now = if session.is_running() { model.now } else { session.paused_at };
    let whole_s = until.secs_since(since).max(1e-3);
    let left_s = until.secs_since(now);
    let label = format!("{} {}", brush.theme.signs().to, wording::button(&session.kitchen, Agent::Robot, button));
    let by = if session.robot.driven_to.is_some() {
        " by wizard"
    } else if session.robot.initiative {
        " alone: nobody presses"
    } else {
        ""
    };
    if session.robot.arm.mode == SafetyMode::Safeguard {
        // The time that is left is unknown until the hand is gone.
        let parts = [(label.as_str(), TextRole::Robot), (by, TextRole::Signal), (": hand in the way", TextRole::Text)];
        brush.parts(x, y, columns, &parts);
        return;
    }
    // The name of the button has priority over the length of the bar.
    let bar = 8.min(columns / 4).min(columns.saturating_sub(width(&label) + width(by) + 7));
    brush.parts(x, y, columns.saturating_sub(bar + 7), &[(&label, TextRole::Robot), (by, TextRole::Signal)]);
    let at = brush.bar(x + columns - bar - 6, y, bar, 1.0 - left_s / whole_s, TextRole::Robot);
    brush.parts(at, y, 6, &[(&format!(" {left_s:>3.1} s"), TextRole::Text)]);
}

/// Name of the key that releases the held robot, with words.
fn release(model: &ConsoleModel) -> String {
    model
        .keys
        .chord_for(&KeyAction::Hand(ManualAction::HoldRobot))
        .map(|key| format!("{key} releases the robot"))
        .unwrap_or_default()
}

/// Draws that the wizard holds the robot before its next press; returns the next column and the remaining width.
fn held(brush: &mut Painter, x: u16, y: u16, columns: u16, model: &ConsoleModel) -> (u16, u16) {
    let badge = brush.theme.badge(TextRole::Strong);
    let end = brush.text(x, y, columns, " HELD ", badge);
    let left = (x + columns).saturating_sub(end);
    let words = if left > 50 { format!(" {} ", release(model)) } else { " ".to_string() };
    let end = brush.parts(end, y, left, &[(&words, TextRole::Quiet)]);
    (end, (x + columns).saturating_sub(end))
}
