//! The head line: where are we, and is everything alive.

use super::paint::{Brush, width};
use super::regions::{ROOMY_COLUMNS, Regions, Room};
use super::theme::Role;
use crate::console::model::{Model, Recording, Viewers};
use crate::console::words;
use crate::robot::safety::SafetyMode;
use crate::session::settings::{Condition, GazeSource};
use crate::session::tracker::Link;
use crate::session::{Phase, Session};

/// Draws the head line.
pub fn draw(brush: &mut Brush, regions: &Regions, session: &Session, model: &Model) {
    let area = regions.head;
    // One panel alone is drawn in full, but the head line is as long as it is.
    let room = if area.width < ROOMY_COLUMNS { Room::Small } else { Room::Medium };
    let gap = if room == Room::Small { 1 } else { 3 };
    let strong = brush.style(Role::Strong);
    // A small replay, and one of a plan, need the room of the name.
    let is_tight = (model.playback.is_some() || session.step().is_some()) && room == Room::Small;
    let name = if is_tight { "" } else { "tomcom" };
    let mut x = brush.text(area.x + 1, area.y, area.width, name, strong) + gap;
    let badge = brush.theme.badge(phase_role(session.phase));
    let stage = if model.lesson.is_some() { "TRAINING".to_string() } else { words::stage(session) };
    x = brush.text(x, area.y, 19, &format!(" {stage} "), badge) + gap;
    if let (Some(label), None) = (series(session), &model.playback) {
        x = brush.text(x, area.y, area.right() - x, &label, strong) + gap;
    }
    if session.study_phase().is_none_or(|phase| phase.phase().has_trial()) {
        x = clock(brush, x, area.y, session, model) + gap;
        let presses = session.all_presses();
        let unit = if is_tight && model.playback.is_none() { "" } else { " presses" };
        let counts = format!("{presses:>3}/{}{unit}", session.spec.trial.presses);
        let text = brush.style(Role::Text);
        x = brush.text(x, area.y, 20, &counts, text) + gap;
    }
    let mut healths = healths(session, model, room);
    let needed = |healths: &[(String, Role)]| healths.iter().map(|(text, _)| width(text) + gap).sum::<u16>();
    // Where not all fits, what is as it should be goes first.
    while needed(&healths) > area.right().saturating_sub(x)
        && let Some(fine) = healths.iter().position(|(_, role)| matches!(role, Role::Text | Role::Quiet))
    {
        healths.remove(fine);
    }
    let needed = needed(&healths);
    let mut right = area.right().saturating_sub(needed).max(x);
    let quiet = brush.style(Role::Quiet);
    for text in facts(session, model) {
        if x + width(&text) + gap < right {
            x = brush.text(x, area.y, right - x, &text, quiet) + gap;
        }
    }
    for (text, role) in healths {
        let style = brush.style(role);
        right = brush.text(right, area.y, area.right().saturating_sub(right), &text, style) + gap;
    }
}

fn phase_role(phase: Phase) -> Role {
    match phase {
        Phase::Running => Role::Text,
        Phase::Paused => Role::Signal,
        _ => Role::Quiet,
    }
}

fn clock(brush: &mut Brush, x: u16, y: u16, session: &Session, model: &Model) -> u16 {
    let clock = session.trial_clock(model.now).to_string();
    let total = crate::base::time::SessionTime::from_secs_f64(session.spec.trial.seconds);
    brush.parts(x, y, 16, &[(&format!("{clock:>5}"), Role::Strong), (&format!(" / {total}"), Role::Quiet)])
}

fn condition(session: &Session) -> &'static str {
    match session.spec.trial.condition {
        Condition::None => "unassisted",
        Condition::Assistant => "assistant",
        Condition::Wizard => "wizard",
    }
}

/// Where a recording is in its participant's series: "P07 trial 2/2 wizard".
fn series(session: &Session) -> Option<String> {
    let (step, _) = session.step()?;
    Some(format!("{} {} {}", session.spec.participant.code, step.label(), condition(session)))
}

/// What stays the same during a trial, the most important first.
fn facts(session: &Session, model: &Model) -> Vec<String> {
    let condition = condition(session);
    let served = format!("{} served", session.served.len());
    let code = session.spec.participant.code.clone();
    if session.step().is_some() && model.playback.is_none() {
        return [served, session.kitchen.title.clone()].into_iter().chain(streamed(model)).collect();
    }
    let mut facts = match &model.playback {
        None => vec![code, condition.to_string(), served],
        Some(playback) => vec![served, code, condition.to_string(), playback.name.clone()],
    };
    facts.push(session.kitchen.title.clone());
    facts.extend(streamed(model));
    facts
}

/// Recording, gaze, stream and robot: each with its state in words.
fn healths(session: &Session, model: &Model, room: Room) -> Vec<(String, Role)> {
    let mut healths = Vec::new();
    if !model.focused && model.playback.is_none() {
        healths.push((" NO KEYBOARD ".to_string(), Role::Alarm));
    }
    let excluded = model.playback.as_ref().is_some_and(|playback| playback.excluded) || session.excluded.is_some();
    if excluded {
        healths.push((" EXCLUDED ".to_string(), Role::Strong));
    }
    match &model.playback {
        Some(playback) => {
            let state = if playback.playing { "play" } else { "paused" };
            let follows = if playback.follows { " live" } else { "" };
            let what = if room == Room::Small { "" } else { " event" };
            let (speed, event, events) = (playback.speed_label(), playback.event, playback.events);
            let label = format!("{state} {speed}{follows} {what} {event}/{events}");
            healths.push((label, Role::Strong));
            match (playback.follows, playback.running) {
                (false, true) => healths.push(("still running: --follow".to_string(), Role::Strong)),
                (false, false) if playback.cut => healths.push(("cut".to_string(), Role::Alarm)),
                _ => {}
            }
        }
        None => healths.push(match &model.recording {
            Recording::Off => ("not recorded".to_string(), Role::Quiet),
            Recording::On(_) => (format!("{} rec", model.theme.signs().recording), Role::Text),
            Recording::Lost => (" RECORDING LOST ".to_string(), Role::Alarm),
        }),
    }
    if room > Room::Small || model.playback.is_none() {
        healths.push(gaze(session, model));
    }
    if let Some((text, is_fine)) = model.display.as_ref().map(|display| display.line()) {
        healths.push((text, if is_fine { Role::Text } else { Role::Alarm }));
    }
    if let Some(Viewers { dropped: dropped @ 1.., .. }) = &model.viewers {
        healths.push((format!("RERUN {dropped} DROPPED"), Role::Alarm));
    }
    let robot = match (session.robot.stopped, session.robot.held) {
        (true, _) => (stopped(session), Role::Alarm),
        (false, true) => ("ROBOT HELD", Role::Strong),
        (false, false) => ("robot ok", Role::Text),
    };
    if (room > Room::Small && model.playback.is_none()) || robot.1 != Role::Text {
        healths.push((robot.0.to_string(), robot.1));
    }
    healths
}

/// How the robot is stopped: by the wizard, or by its arm itself.
fn stopped(session: &Session) -> &'static str {
    match session.robot.arm.mode {
        SafetyMode::ProtectiveStop => "PROTECTIVE STOP",
        SafetyMode::Fault => "ARM FAULT",
        _ => "ROBOT STOPPED",
    }
}

/// Where Rerun's viewers connect, as long as they and the stream's file get everything.
fn streamed(model: &Model) -> Option<String> {
    let viewers = model.viewers.as_ref().filter(|viewers| viewers.dropped == 0)?;
    let port = viewers.address.as_ref().and_then(|address| address.rsplit(':').next());
    Some(port.map_or("rerun ok".to_string(), |port| format!("rerun :{port} ok")))
}

fn gaze(session: &Session, model: &Model) -> (String, Role) {
    if session.spec.participant.gaze == GazeSource::None {
        return ("no gaze".to_string(), Role::Quiet);
    }
    match (&session.tracker.link, session.tracker.sees_display) {
        (Link::Lost { since, .. }, _) => {
            return (format!("NO TRACKER {:.0} s", model.now.secs_since(*since)), Role::Alarm);
        }
        (Link::Unknown, _) if session.spec.participant.gaze == GazeSource::Pupil => {
            return ("NO TRACKER".to_string(), Role::Alarm);
        }
        (Link::Connected { .. }, Some(false)) => return ("TAGS NOT SEEN".to_string(), Role::Alarm),
        _ => {}
    }
    let usable = session.gaze.last.is_some_and(|(at, _)| model.now.secs_since(at) <= 1.0);
    match (session.gaze_hz(model.now), session.gaze.arrived) {
        (Some(_), _) if !usable => ("GAZE UNUSABLE".to_string(), Role::Alarm),
        (Some(hz), _) => (format!("gaze {hz:>3.0} Hz"), Role::Text),
        (None, Some(at)) if session.is_running() => (format!("NO GAZE {:.0} s", model.now.secs_since(at)), Role::Alarm),
        (None, None) if session.is_running() => ("NO GAZE".to_string(), Role::Alarm),
        _ => ("gaze waits".to_string(), Role::Quiet),
    }
}
