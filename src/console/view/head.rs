//! The head line of the console: phase, clock, condition, and states of all devices.

use ratatui::style::Style;

use super::paint::Painter;
use super::regions::{PanelAreas, ROOMY_COLUMNS, ScreenSize};
use super::theme::TextRole;
use crate::console::console_model::{ConsoleModel, RecordingStatus, RerunStreamStatus};
use crate::console::probe_keys;
use crate::console::text_columns::width;
use tomcom_core::base::time::SessionTime;
use tomcom_core::robot::SafetyMode;
use tomcom_session::history::wording;
use tomcom_session::settings::{Condition, GazeSource};
use tomcom_session::tracker::TrackerConnection;
use tomcom_session::{Session, TrialPhase};

/// Draws the head line of the console: phase, clock, condition, devices.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.head;
    // The head line is as wide as the screen even if one panel is at full size.
    let room = if area.width < ROOMY_COLUMNS { ScreenSize::Small } else { ScreenSize::Medium };
    let gap = if room == ScreenSize::Small { 1 } else { 3 };
    let strong = brush.style(TextRole::Strong);
    // On small screens, the state of the robot takes the room of the program's name.
    let is_small = room == ScreenSize::Small;
    let name = if is_small { "" } else { "tomcom" };
    let mut x = brush.text(area.x + 1, area.y, area.width, name, strong) + gap;
    // A replay does not name the phase; whether it plays is shown beside its position.
    let is_replayed = is_replayed(model);
    let stage = match (model.lesson.is_some(), session.phase) {
        (true, _) => "TRAINING".to_string(),
        (false, TrialPhase::Running) if is_replayed => "REPLAY".to_string(),
        (false, TrialPhase::Paused) if session.is_frozen() && !session.can_be_paused() => "PROBE PAUSED".to_string(),
        (false, TrialPhase::Paused) if session.is_frozen() => "PROBE".to_string(),
        _ => wording::stage(session),
    };
    let (mark, style) = match session.phase {
        TrialPhase::Running if is_replayed => (" ".to_string(), strong),
        phase => stage_mark(brush, phase),
    };
    x = brush.text(x, area.y, 19, &format!("{mark}{stage} "), style) + gap;
    let whose = match (&model.coding, &model.playback) {
        // A rater must not know in which condition the trial was.
        (Some(coding), _) => Some(format!("rater {}", coding.name())),
        (None, None) => series(session),
        (None, Some(_)) => None,
    };
    if let Some(whose) = whose {
        x = brush.text(x, area.y, area.right() - x, &whose, strong) + gap;
    }
    if session.study_phase().is_none_or(|phase| phase.phase().has_trial()) {
        x = clock(brush, x, area.y, session, model) + gap;
        let presses = session.all_presses();
        let unit = if is_small && session.step().is_some() && model.playback.is_none() { "" } else { " presses" };
        let counts = format!("{presses:>3}/{}{unit}", session.spec.trial.presses);
        let text = brush.style(TextRole::Text);
        x = brush.text(x, area.y, 20, &counts, text) + gap;
    }
    let mut healths = healths(session, model, room);
    let needed = |healths: &[(String, TextRole)]| healths.iter().map(|(text, _)| width(text) + gap).sum::<u16>();
    // If not all device states fit, those that are in order are left out first, from the last one on.
    while needed(&healths) > area.right().saturating_sub(x)
        && let Some(fine) = healths.iter().rposition(|(_, role)| matches!(role, TextRole::Text | TextRole::Quiet))
    {
        healths.remove(fine);
    }
    let needed = needed(&healths);
    let mut right = area.right().saturating_sub(needed).max(x);
    let quiet = brush.style(TextRole::Quiet);
    for text in probe_keys::status(session, model).into_iter().chain(facts(session, model)) {
        if x + width(&text) + gap < right {
            x = brush.text(x, area.y, right - x, &text, quiet) + gap;
        }
    }
    for (text, role) in healths {
        let style = brush.style(role);
        right = brush.text(right, area.y, area.right().saturating_sub(right), &text, style) + gap;
    }
}

/// Whether the console replays a recording that is no longer being made.
fn is_replayed(model: &ConsoleModel) -> bool {
    model.playback.as_ref().is_some_and(|playback| !playback.follows)
}

/// Sign and style of the trial's phase: inconspicuous while the trial runs, conspicuous in a pause.
fn stage_mark(brush: &Painter, phase: TrialPhase) -> (String, Style) {
    let signs = brush.theme.signs();
    match phase {
        TrialPhase::Running => (format!("{} ", signs.to), brush.style(TextRole::Text)),
        TrialPhase::Paused => (format!(" {} ", signs.pause), brush.theme.badge(TextRole::Strong)),
        _ => (" ".to_string(), brush.style(TextRole::Strong)),
    }
}

fn clock(brush: &mut Painter, x: u16, y: u16, session: &Session, model: &ConsoleModel) -> u16 {
    let clock = session.trial_clock(model.now).to_string();
    // A replay shows the length of the recording elsewhere.
    let limit = match is_replayed(model) && model.lesson.is_none() {
        true => String::new(),
        false => format!(" / {}", SessionTime::from_secs_f64(session.spec.trial.seconds)),
    };
    brush.parts(x, y, 16, &[(&format!("{clock:>5}"), TextRole::Strong), (&limit, TextRole::Quiet)])
}

/// Sender of signals in this condition, in a word: "unassisted", "assistant", "wizard".
pub(super) fn condition(session: &Session) -> &'static str {
    match session.spec.trial.condition {
        Condition::None => "unassisted",
        Condition::Assistant => "assistant",
        Condition::Wizard => "wizard",
    }
}

/// Position of the trial in the participant's series: "P07 trial 2/2 wizard".
fn series(session: &Session) -> Option<String> {
    let (step, _) = session.step()?;
    Some(format!("{} {} {}", session.spec.participant.code, step.label(), condition(session)))
}

/// Facts of the head line that do not change during a trial, the most important first.
fn facts(session: &Session, model: &ConsoleModel) -> Vec<String> {
    let condition = condition(session);
    let served = format!("{} served", session.served.len());
    let code = session.spec.participant.code.clone();
    if session.step().is_some() && model.playback.is_none() {
        return [served, session.kitchen.title.clone()].into_iter().chain(streamed(model)).collect();
    }
    let mut facts = match &model.playback {
        None => vec![code, condition.to_string(), served],
        // A rater must not know in which condition the trial was.
        Some(playback) if model.coding.is_some() => vec![served, playback.name.clone()],
        Some(playback) => vec![served, code, condition.to_string(), playback.name.clone()],
    };
    facts.push(session.kitchen.title.clone());
    facts.extend(streamed(model));
    facts
}

/// States of recording, gaze, streams and robot in words, with their styles.
pub(super) fn healths(session: &Session, model: &ConsoleModel, room: ScreenSize) -> Vec<(String, TextRole)> {
    let mut healths = Vec::new();
    if !model.focused && model.playback.is_none() {
        healths.push((" NO KEYBOARD ".to_string(), TextRole::Alarm));
    }
    let excluded = model.playback.as_ref().is_some_and(|playback| playback.excluded) || session.excluded.is_some();
    if excluded {
        healths.push((" EXCLUDED ".to_string(), TextRole::Strong));
    }
    match &model.playback {
        Some(playback) => {
            let state = if playback.playing { "play" } else { "paused" };
            let follows = if playback.follows { " live" } else { "" };
            let what = if room == ScreenSize::Small { "" } else { " event" };
            let (speed, event, events) = (playback.speed_label(), playback.event, playback.events);
            let label = format!("{state} {speed}{follows} {what} {event}/{events}");
            healths.push((label, TextRole::Strong));
            match (playback.follows, playback.running) {
                (false, true) => healths.push(("recording goes on: --follow".to_string(), TextRole::Strong)),
                (false, false) if playback.cut => healths.push(("recording cut".to_string(), TextRole::Alarm)),
                _ => {}
            }
        }
        None => healths.push(match &model.recording {
            RecordingStatus::Off => ("not recorded".to_string(), TextRole::Quiet),
            RecordingStatus::On(_) => (format!("{} rec", model.theme.signs().recording), TextRole::Text),
            RecordingStatus::Lost => (" RECORDING LOST ".to_string(), TextRole::Alarm),
        }),
    }
    if room > ScreenSize::Small || model.playback.is_none() {
        healths.push(gaze(session, model));
    }
    if let Some((text, is_fine)) = model.display.as_ref().map(|display| display.line()) {
        healths.push((text, if is_fine { TextRole::Text } else { TextRole::Alarm }));
    }
    if let Some(RerunStreamStatus { dropped: dropped @ 1.., .. }) = &model.viewers {
        healths.push((format!("RERUN {dropped} ROWS DROPPED"), TextRole::Alarm));
    }
    let mode = session.robot.safety_mode();
    let robot = match (session.robot.stopped, session.robot.held) {
        (true, _) => (mode.name(), TextRole::Alarm),
        (false, true) => ("ROBOT HELD", TextRole::Strong),
        (false, false) if mode == SafetyMode::Safeguard => (mode.name(), TextRole::Strong),
        (false, false) => ("robot ok", TextRole::Text),
    };
    if model.playback.is_none() || robot.1 != TextRole::Text {
        healths.push((robot.0.to_string(), robot.1));
    }
    healths
}

/// Address for Rerun viewers, while no row of the stream has been dropped.
fn streamed(model: &ConsoleModel) -> Option<String> {
    let viewers = model.viewers.as_ref().filter(|viewers| viewers.dropped == 0)?;
    let port = viewers.address.as_ref().and_then(|address| address.rsplit(':').next());
    Some(port.map_or("rerun ok".to_string(), |port| format!("rerun :{port} ok")))
}

fn gaze(session: &Session, model: &ConsoleModel) -> (String, TextRole) {
    if session.spec.participant.gaze == GazeSource::None {
        return ("no gaze".to_string(), TextRole::Quiet);
    }
    match (&session.tracker.link, session.tracker.sees_display) {
        (TrackerConnection::Lost { since, .. }, _) => {
            return (format!("NO TRACKER {:.0} s", model.now.secs_since(*since)), TextRole::Alarm);
        }
        (TrackerConnection::Unknown, _)
            if matches!(session.spec.participant.gaze, GazeSource::Pupil | GazeSource::Lsl) =>
        {
            return ("NO TRACKER".to_string(), TextRole::Alarm);
        }
        (TrackerConnection::Connected { .. }, Some(false)) => return ("NO DISPLAY TAGS".to_string(), TextRole::Alarm),
        _ => {}
    }
    let usable = session.gaze.last.is_some_and(|(at, _)| model.now.secs_since(at) <= 1.0);
    match (session.gaze_hz(model.now), session.gaze.arrived) {
        (Some(_), _) if !usable => ("GAZE UNUSABLE".to_string(), TextRole::Alarm),
        (Some(hz), _) => (format!("gaze {hz:>3.0} Hz"), TextRole::Text),
        (None, Some(at)) if session.is_running() => {
            (format!("NO GAZE {:.0} s", model.now.secs_since(at)), TextRole::Alarm)
        }
        (None, None) if session.is_running() => ("NO GAZE".to_string(), TextRole::Alarm),
        _ => ("gaze idle".to_string(), TextRole::Quiet),
    }
}
