//! Panels of the robot (ongoing press, progress of the arm, reason for being idle, what it holds), of the participant's
//! display (the signal, its content and its remaining time), and of a wizard training (task, then feedback).

use ratatui::layout::Rect;

use super::paint::Painter;
use super::regions::{PanelAreas, ScreenSize};
use super::theme::TextRole;
use crate::console::console_model::{ConsoleModel, NoticeLevel, TrainingFeedback, TrainingPanel};
use crate::console::key_action::{KeyAction, ManualAction};
use crate::console::text_columns::{width, wrap, wrap_to};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::kitchen::Agent;
use tomcom_core::robot::{SLOWS_M, SafetyMode};
use tomcom_session::history::{event_words, wording};
use tomcom_session::{Session, ShownSignal, TimelineEvent, TrialPhase, proposals};

/// What the console says while the arm is slow since a hand is near.
const SLOW: &str = "slow: hand near";

/// Age from which a sample of the arm is not shown as the present, in seconds.
const FRESH_S: f64 = 1.0;

pub fn draw_robot(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.robot;
    if area.area() == 0 {
        return;
    }
    if regions.screen_size == ScreenSize::Small {
        brush.text(area.x, area.y, area.width, " robot    ", TextRole::Quiet);
        let (mut columns, mode) = (area.width.saturating_sub(11), session.robot.arm.mode);
        // All modes stand in the head line; where there is room, this one says why.
        if mode == SafetyMode::Reduced && !session.robot.stopped && columns >= 44 {
            let name = format!(" {}", mode_words(mode));
            columns = columns.saturating_sub(width(&name));
            brush.text(area.x + 10 + columns, area.y, width(&name), &name, mode_role(mode));
        }
        robot_line(brush, Rect { x: area.x + 10, width: columns, ..area }, session, model);
        return;
    }
    let is_arm = session.spec.robot.arm.has_joints();
    let remark = match (session.robot.stopped, session.robot.held, &model.playback) {
        (true, ..) => String::new(),
        (false, true, _) => release(model),
        (false, false, None) => "space stops the robot".to_string(),
        (false, false, Some(_)) => String::new(),
    };
    let mode = session.robot.arm.mode;
    let name = if is_arm && !mode.is_stopped() { mode_words(mode) } else { "" };
    let between = if name.is_empty() || remark.is_empty() { "" } else { "  " };
    let title = "Robot";
    let parts = [(name, mode_role(mode)), (between, TextRole::Quiet), (&remark, TextRole::Quiet)];
    // The arm's mode comes before the hint where there is room for one of them.
    let columns = [title, name, between, &remark].map(width).iter().sum::<u16>();
    let is_crowded = !name.is_empty() && columns + 6 >= area.width;
    let inside = brush.panel_with(area, title, if is_crowded { &parts[..1] } else { &parts });
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let rows = robot_line(brush, Rect { x, width: columns, ..inside }, session, model);
    holds(brush, x, inside.y + rows, columns, session);
    if rows == 1 {
        arm(brush, x, inside.y + 2, columns, session, model.now);
    }
}

fn holds(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session) {
    let held = session.kitchen.hands[Agent::Robot.index()];
    let held = match session.state.content(held).is_empty() {
        true => "nothing",
        false => session.kitchen.content_label(session.state, held),
    };
    let presses = count(u64::from(session.presses[Agent::Robot.index()]), "press made", "presses made");
    brush.parts(x, y, columns, &[("holds ", TextRole::Quiet), (held, TextRole::Text)]);
    brush.text_right(x + columns, y, columns / 2, &presses, TextRole::Quiet);
}

/// Draws what the arm does, how far the hand is from it, and the force. While the arm stands no samples come: the last one
/// then tells nothing of the present.
fn arm(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, now: SessionTime) {
    if session.robot.stopped {
        brush.text(x, y, columns, &stop_reason(session), TextRole::Alarm);
        return;
    }
    let Some((at, sample)) = session.robot.arm.last else { return };
    if !session.is_running() || session.age(at, now).as_secs_f64() > FRESH_S {
        brush.text(x, y, columns, "stands", TextRole::Text);
        return;
    }
    let waits = session.robot.arm.mode == SafetyMode::Safeguard;
    let phase = format!("{:<10} ", if waits { "waits" } else { wording::arm_phase(sample.phase) });
    let hand = match sample.hand_away_m {
        None => String::new(),
        Some(away_m) if away_m < 0.005 => " hand at arm".to_string(),
        Some(away_m) => format!(" hand {away_m:>4.2} m"),
    };
    let force = match sample.force_n {
        force_n if force_n >= 0.5 => format!(" {force_n:>3.0} N"),
        _ => String::new(),
    };
    let is_near = sample.hand_away_m.is_some_and(|away_m| away_m < SLOWS_M);
    let hand_role = if is_near { TextRole::Human } else { TextRole::Quiet };
    let parts = [(phase.as_str(), TextRole::Text), (&hand, hand_role), (&force, TextRole::Text)];
    brush.parts(x, y, columns, &parts);
}

/// Why the robot is stopped: until it is resumed, whatever is said elsewhere meanwhile.
fn stop_reason(session: &Session) -> String {
    if let Some((stage, found)) = session.robot.arm.unready().filter(|_| !session.robot.arm.mode.is_stopped()) {
        return event_words::arm_stage(stage, found);
    }
    let cause = event_words::stop_cause(session.robot.arm.stopped_by_n, session.robot.arm.stopped_by_joint);
    match session.robot.is_stopped_by_wizard() {
        true => "stopped by the wizard".to_string(),
        false => cause.unwrap_or("the arm stopped itself".to_string()),
    }
}

/// Draws the stop of the robot and the key that resumes it; the force of a contact where there is one line, whose head line
/// names the stop.
fn stopped(brush: &mut Painter, line: Rect, session: &Session, model: &ConsoleModel) {
    let arm = &session.robot.arm;
    let contact_n = arm.stopped_by_n.filter(|_| line.height == 1 && !session.robot.is_stopped_by_wizard());
    let label = match (arm.unready(), contact_n) {
        (Some((stage, _)), _) if !arm.mode.is_stopped() => {
            format!(" ARM: {} ", event_words::arm_stage(stage, "").to_uppercase())
        }
        (_, Some(force_n)) => format!(" contact, {force_n:.0} N "),
        _ => format!(" {} ", session.robot.safety_mode().name()),
    };
    let key = model.keys.chord_for(&KeyAction::ResumeRobot).filter(|_| session.phase != TrialPhase::Closed);
    let resume = key.map(|key| format!(" {key} resume")).unwrap_or_default();
    let end = brush.styled(line.x, line.y, line.width, &label, brush.theme.badge(TextRole::Alarm));
    brush.text(end, line.y, line.right().saturating_sub(end), &resume, TextRole::Text);
}

/// A safety mode in words; the modes in which the arm stands keep their names.
fn mode_words(mode: SafetyMode) -> &'static str {
    if mode == SafetyMode::Reduced { SLOW } else { mode.name() }
}

fn mode_role(mode: SafetyMode) -> TextRole {
    match mode {
        SafetyMode::Normal => TextRole::Quiet,
        SafetyMode::Reduced | SafetyMode::Safeguard => TextRole::Strong,
        _ => TextRole::Alarm,
    }
}

/// Draws what the robot does or waits for; returns the number of lines, two where an area of several lines has to name
/// many buttons.
fn robot_line(brush: &mut Painter, area: Rect, session: &Session, model: &ConsoleModel) -> u16 {
    let Rect { x, y, width: columns, .. } = area;
    if session.robot.stopped {
        stopped(brush, area, session, model);
        return 1;
    }
    if let Some((stage, _)) = session.robot.arm.unready().filter(|_| session.phase == TrialPhase::Ready) {
        let key = model.keys.chord_for(&KeyAction::Manual(ManualAction::ConfirmArm)).filter(|_| stage.asks().is_some());
        let next = key.map(|key| format!("  {key} goes on")).unwrap_or_default();
        let words = event_words::arm_stage(stage, "");
        brush.parts(x, y, columns, &[(&words, TextRole::Strong), (&next, TextRole::Quiet)]);
        return 1;
    }
    let (x, columns) = if session.robot.held { held(brush, x, y, columns, model) } else { (x, columns) };
    if matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed) {
        brush.text(x, y, columns, "stopped: the trial is over", TextRole::Quiet);
        return 1;
    }
    let Some((button, since, until)) = session.robot.intention else {
        let ways = match &session.robot.idle {
            _ if session.robot.held => Vec::new(),
            Some((reason, waits_for)) => {
                let human = &session.kitchen.buttons[Agent::Human.index()];
                let names: Vec<&str> = waits_for.iter().map(|button| human[button.index()].name.as_str()).collect();
                wording::idle(*reason, &names, session.robot.gave_up)
            }
            None => vec!["no press planned".to_string()],
        };
        let (Some(least), whole) = (ways.last(), ways.iter().find(|words| width(words) <= columns)) else { return 1 };
        let rows = match whole {
            Some(words) => vec![words.clone()],
            None if area.height > 1 => wrap_to(least, columns, 2, brush.theme.signs().ellipsis),
            None => vec![least.clone()],
        };
        for (row, words) in rows.iter().enumerate() {
            brush.text(x, y + row as u16, columns, words, TextRole::Quiet);
        }
        return rows.len() as u16;
    };
    let whole_s = until.secs_since(since).max(1e-3);
    let left_s = until.secs_since(model.now);
    let label = format!("{} {}", brush.theme.signs().to, wording::button(&session.kitchen, Agent::Robot, button));
    // The human's next press ends the robot's initiative.
    let is_human = |what: &TimelineEvent| matches!(what, TimelineEvent::Press { agent: Agent::Human, .. });
    let mut lately = session.timeline.iter().rev().take_while(|entry| entry.time >= since);
    let is_alone = session.robot.initiative && !lately.any(|entry| is_human(&entry.what));
    let by = match is_alone {
        _ if session.robot.driven_to.is_some() => " by wizard",
        true if width(&label) + 30 <= columns => " alone: nobody presses",
        true => " alone",
        false => "",
    };
    let kitchen = &session.kitchen;
    let has_use = kitchen.press(session.state, &kitchen.true_recipes(), Agent::Robot, button).is_some();
    if session.robot.arm.mode == SafetyMode::Safeguard {
        // The time that is left is unknown until the hand is gone.
        let parts = [(label.as_str(), TextRole::Robot), (by, TextRole::Signal), (": hand in the way", TextRole::Text)];
        let fits = parts.iter().map(|(text, _)| width(text)).sum::<u16>() <= columns;
        brush.parts(x, y, columns, if fits { &parts } else { &[("hand in the way", TextRole::Text)] });
        return 1;
    }
    if !session.is_running() || !has_use {
        let words = if has_use { ": paused" } else { ": of no use now" };
        brush.parts(x, y, columns, &[(&label, TextRole::Robot), (by, TextRole::Signal), (words, TextRole::Text)]);
        return 1;
    }
    // How long the arm takes is known neither while it is held nor once the expected time is over.
    let left = match left_s {
        _ if session.robot.held => String::new(),
        left_s if left_s > 0.0 => format!(" {left_s:>3.1} s"),
        _ => " soon".to_string(),
    };
    if left.is_empty() {
        brush.parts(x, y, columns, &[(&label, TextRole::Robot), (by, TextRole::Signal)]);
        return 1;
    }
    // The name of the button has priority over the length of the bar.
    let bar = 8.min(columns / 4).min(columns.saturating_sub(width(&label) + width(by) + 7));
    brush.parts(x, y, columns.saturating_sub(bar + 7), &[(&label, TextRole::Robot), (by, TextRole::Signal)]);
    let at = brush.bar(x + columns - bar - 6, y, bar, 1.0 - left_s / whole_s, TextRole::Robot);
    brush.text(at, y, 6, &left, TextRole::Text);
    1
}

fn release(model: &ConsoleModel) -> String {
    let key = model.keys.chord_for(&KeyAction::Manual(ManualAction::HoldRobot));
    key.map(|key| format!("{key} releases the robot")).unwrap_or_default()
}

/// Draws that the wizard holds the robot before its next press; returns the next column and the remaining width.
fn held(brush: &mut Painter, x: u16, y: u16, columns: u16, model: &ConsoleModel) -> (u16, u16) {
    let end = brush.styled(x, y, columns, " HELD ", brush.theme.badge(TextRole::Strong));
    let left = (x + columns).saturating_sub(end);
    let ways = [format!(" {} ", release(model)), format!(" {} ", release(model).replace(" the robot", ""))];
    let fitting = ways.into_iter().zip([50, 30]).find(|(_, least)| left > *least);
    let words = fitting.map_or(" ".to_string(), |(words, _)| words);
    let end = brush.text(end, y, left, &words, TextRole::Quiet);
    (end, (x + columns).saturating_sub(end))
}

/// Draws the panel that tells which signal the participant sees now.
pub fn draw_display(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.shown;
    if area.area() == 0 {
        return;
    }
    if regions.screen_size == ScreenSize::Small {
        brush.text(area.x, area.y, area.width, " display  ", TextRole::Quiet);
        display_line(brush, area.x + 10, area.y, area.width.saturating_sub(11), session, model);
        return;
    }
    let back = model.keys.chord_for(&KeyAction::TakeBack).map(|key| format!("{key} takes the signal back"));
    let remark = session.shown.as_ref().and(back).unwrap_or_default();
    let inside = brush.panel(area, "On the participant's display", &remark);
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    display_line(brush, x, inside.y, columns, session, model);
    if let Some(shown) = &session.shown {
        for (row, text) in wrap(&says(session, &shown.signal), columns).iter().take(2).enumerate() {
            brush.text(x, inside.y + 1 + row as u16, columns, text, TextRole::Text);
        }
    }
}

/// Draws the present signal with its remaining time in one line.
fn display_line(brush: &mut Painter, x: u16, y: u16, columns: u16, session: &Session, model: &ConsoleModel) {
    if session.calibration.as_ref().is_some_and(|check| check.shown.is_some()) {
        brush.text(x, y, columns, "a target of the gaze check", TextRole::Strong);
        return;
    }
    let start = model.keys.chord_for(&KeyAction::Advance).filter(|_| session.phase == TrialPhase::Ready);
    if let Some(key) = start {
        let key = key.to_string();
        let parts = [("press ", TextRole::Strong), (&key, TextRole::Signal), (" to start the trial", TextRole::Strong)];
        brush.parts(x, y, columns, &parts);
        return;
    }
    let Some(shown) = &session.shown else {
        brush.text(x, y, columns, "no signal, only the kitchen", TextRole::Quiet);
        return;
    };
    let title = match (&shown.signal, columns > 60) {
        (Signal::ShowRecipe(_), true) => says(session, &shown.signal),
        _ => wording::signal(&shown.signal),
    };
    let (left_s, share) = time_left(session, shown, model);
    let bar = if columns < 44 { 0 } else { 8 };
    let room = columns.saturating_sub(bar + 7);
    let end = brush.text(x, y, room, &title, TextRole::Signal);
    let by = format!(" by {}", wording::sender(shown.by));
    if end + width(&by) <= x + room {
        brush.text(end, y, room, &by, TextRole::Quiet);
    }
    let at = brush.bar(x + columns - bar - 6, y, bar, share, TextRole::Signal);
    brush.text(at, y, 6, &format!(" {left_s:>3.1} s"), TextRole::Text);
}

/// Remaining time of a signal in seconds, and as a share of its duration.
fn time_left(session: &Session, shown: &ShownSignal, model: &ConsoleModel) -> (f64, f64) {
    let now = if session.is_running() { model.now } else { session.paused_at };
    let left_s = shown.until.secs_since(now);
    (left_s, left_s / shown.until.secs_since(shown.since).max(1e-3))
}

/// Content of the signal that the participant sees, in words.
fn says(session: &Session, signal: &Signal) -> String {
    let kitchen = &session.kitchen;
    let Some(location) = signal.location(kitchen) else {
        // Of proposed presses, only those that the participant has not made yet are shown.
        return proposals::left(session)
            .map_or(String::new(), |left| format!("proposed next: {}", wording::proposal(left)));
    };
    let content = kitchen.content_label(session.state, location);
    match signal {
        Signal::ShowRecipe(_) => match wording::recipe(session, location) {
            Some(recipe) => format!("{content} = {recipe}"),
            None => format!("{}: {content}", kitchen.location(location).label()),
        },
        Signal::Highlight(_) | Signal::Propose(_) => {
            format!("highlight: {} holds {content}", kitchen.location(location).label())
        }
    }
}

/// Columns for the clock time of a line of feedback.
const CLOCK: u16 = 6;

pub fn draw_training(brush: &mut Painter, regions: &PanelAreas, model: &ConsoleModel) {
    let area = regions.lesson;
    let Some(lesson) = model.lesson.as_ref().filter(|_| area.area() > 0) else { return };
    let inside = match regions.screen_size {
        ScreenSize::Small => area,
        _ => brush.panel(area, "Training", ""),
    };
    let (x, columns) = (inside.x + 1, inside.width.saturating_sub(2));
    let mut y = inside.y;
    let score = (String::new(), lesson.score.clone(), TextRole::Quiet);
    let score = Some(score).filter(|_| regions.screen_size != ScreenSize::Small);
    for (clock, text, role) in score.into_iter().chain(training_lines(lesson, model)) {
        let indent = if clock.is_empty() { 0 } else { CLOCK };
        for (row, line) in wrap(&text, columns.saturating_sub(indent)).iter().enumerate() {
            if y >= inside.bottom() {
                return;
            }
            if row == 0 {
                brush.text(x, y, indent, &clock, TextRole::Quiet);
            }
            brush.text(x + indent, y, columns.saturating_sub(indent), line, role);
            y += 1;
        }
    }
}

/// Lines of the training panel, each with or without a time on the trial's clock.
fn training_lines(lesson: &TrainingPanel, model: &ConsoleModel) -> Vec<(String, String, TextRole)> {
    if lesson.feedback.is_empty() {
        let start = model.keys.chord_for(&KeyAction::Advance).filter(|_| !lesson.begun);
        let start = start.map(|key| (String::new(), format!("Press {key} to start."), TextRole::Strong));
        let task = lesson.task.iter().map(|text| (String::new(), text.clone(), TextRole::Text));
        return start.into_iter().chain(task).collect();
    }
    let newest = lesson.feedback.iter().rev().enumerate();
    let line = |(back, TrainingFeedback { clock, level, text }): (usize, &TrainingFeedback)| {
        let role = match (back, level) {
            (_, NoticeLevel::Refused | NoticeLevel::Alarm) => TextRole::Strong,
            (0, NoticeLevel::Done) => TextRole::Strong,
            (_, NoticeLevel::Done) => TextRole::Text,
        };
        (format!("{:>5}", clock.to_string()), text.clone(), role)
    };
    newest.map(line).collect()
}
