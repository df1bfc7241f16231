//! The head line of the console: phase, clock, condition, and states of all devices.

use ratatui::style::Style;

use super::gaze::GazeLoss;
use super::paint::Painter;
use super::regions::{PanelAreas, ROOMY_COLUMNS};
use super::theme::TextRole;
use crate::console::console_model::{ConsoleModel, FilmStatus, RecordingStatus, RerunStreamStatus};
use crate::console::probe_keys;
use crate::console::text_columns::width;
use tomcom_core::base::time::SessionTime;
use tomcom_core::robot::{ArmStage, SafetyMode};
use tomcom_session::history::wording;
use tomcom_session::settings::{Condition, GazeSource};
use tomcom_session::tracker::DeviceConnection;
use tomcom_session::{Session, TrialPhase};

/// A part of the head line: its text, its style, and its rank: those of the highest rank are left out first where there is
/// no room, those of rank 0 stay.
struct HeadPart {
    text: String,
    style: Style,
    rank: u8,
    /// Whether the next part belongs to this one and stands close to it.
    is_close: bool,
}

/// Draws the head line of the console: phase, condition, trial, clock, devices. The states of recording, gaze and robot
/// are never left out, and condition and trial come before all that can be. Every part has its place, whatever the states
/// of gaze and robot: only an alarm that needs more than their columns takes those of the last parts.
pub fn draw(brush: &mut Painter, regions: &PanelAreas, session: &Session, model: &ConsoleModel) {
    let area = regions.head;
    let is_small = area.width < ROOMY_COLUMNS;
    let gap = if is_small { 1 } else { 3 };
    let (strong, text, quiet) =
        (brush.style(TextRole::Strong), brush.style(TextRole::Text), brush.style(TextRole::Quiet));
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
    let part = |text: String, style: Style, rank: u8| HeadPart { text, style, rank, is_close: false };
    // All phases of a trial take the same columns.
    let stage = format!("{:<STAGE$}", format!("{mark}{stage} "));
    let mut parts = vec![part(stage, style, 0)];
    match &model.coding {
        // A rater must not know in which condition the trial was.
        Some(coding) => parts.push(part(format!("rater {}", coding.name()), strong, 0)),
        None => {
            let step = session.step().filter(|_| model.playback.is_none());
            let code = part(session.spec.participant.code.clone(), strong, 0);
            parts.push(HeadPart { is_close: step.is_some(), ..code });
            if let Some((step, _)) = step {
                let label = step.label();
                let (trial, attempt) = label.split_once(", ").unwrap_or((&label, ""));
                parts.push(HeadPart { is_close: true, ..part(trial.to_string(), strong, TRIAL) });
                // The states of the devices come before the number of the attempt.
                if !attempt.is_empty() {
                    parts.push(HeadPart { is_close: true, ..part(attempt.to_string(), strong, TRIAL + 1) });
                }
            }
            parts.push(part(condition(session).to_string(), strong, 1));
        }
    }
    if session.study_phase().is_none_or(|phase| phase.phase().has_trial()) {
        let clock = format!("{:>5}", session.trial_clock(model.now).to_string());
        parts.push(HeadPart { is_close: true, ..part(clock, strong, 0) });
        // A replay shows the length of the recording elsewhere; once the trial is over, nobody asks for it.
        let is_over = matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed);
        if !is_over && (!is_replayed || model.lesson.is_some()) {
            let length = SessionTime::from_secs_f64(session.spec.trial.seconds);
            parts.push(part(format!("/ {length}"), quiet, 5));
        }
        let presses = format!("{:>3}/{}", session.all_presses(), session.spec.trial.presses);
        parts.push(HeadPart { is_close: true, ..part(presses, text, 2) });
        parts.push(part("presses".to_string(), text, 7));
    }
    parts.extend(probe_keys::status(session, model).map(|probe| part(probe, quiet, 4)));
    parts.push(part(format!("{} served", session.served.len()), quiet, 6));
    parts.extend(facts(session, model).into_iter().enumerate().map(|(index, fact)| part(fact, quiet, 9 + index as u8)));
    let mut healths = healths(session, model);
    for ((text, _), columns) in healths.iter_mut().skip(1).zip(if is_small { SMALL_STATES } else { STATES }) {
        *text = format!("{text:<columns$}");
    }
    let needed = |healths: &[(String, TextRole)]| healths.iter().map(|(text, _)| width(text) + gap).sum::<u16>();
    // Of the states, those that are no alarm and stand behind the first three are left out before condition and trial.
    let least: u16 = parts.iter().filter(|part| part.rank <= TRIAL).map(|part| part.columns(gap)).sum();
    while area.width < 1 + least + needed(&healths)
        && healths.len() > ALWAYS
        && let Some(fine) = healths.iter().rposition(|(_, role)| matches!(role, TextRole::Text | TextRole::Quiet))
        && fine >= ALWAYS
    {
        healths.remove(fine);
    }
    let mut room = area.width.saturating_sub(1 + needed(&healths));
    let mut ranks: Vec<u8> = parts.iter().map(|part| part.rank).collect();
    ranks.sort_unstable();
    ranks.dedup();
    // A part that does not fit leaves its columns to those that are less important.
    for rank in ranks {
        let columns: u16 = parts.iter().filter(|part| part.rank == rank).map(|part| part.columns(gap)).sum();
        match rank == 0 || columns <= room {
            true => room = room.saturating_sub(columns),
            false => parts.retain(|part| part.rank != rank),
        }
    }
    let mut x = area.x + 1;
    for part in &parts {
        x = brush.styled(x, area.y, area.right().saturating_sub(x), &part.text, part.style) + part.gap(gap);
    }
    let mut right = area.right().saturating_sub(needed(&healths)).max(x);
    for (text, role) in healths {
        right = brush.text(right, area.y, area.right().saturating_sub(right), &text, role) + gap;
    }
}

impl HeadPart {
    fn columns(&self, gap: u16) -> u16 {
        width(&self.text) + self.gap(gap)
    }

    /// Columns after the part.
    fn gap(&self, gap: u16) -> u16 {
        if self.is_close { 1 } else { gap }
    }
}

/// Number of states at the right end that are never left out: recording or replay, gaze, robot.
const ALWAYS: usize = 3;
/// Highest rank of the parts that say which trial this is, and how far it is.
const TRIAL: u8 = 3;
/// Columns of the trial's phase, and of the states of gaze and robot: "gaze 120 Hz" and "robot slow" on small screens,
/// "GAZE UNUSABLE" and "PROTECTIVE STOP" on others.
const STAGE: usize = 10;
const SMALL_STATES: [usize; 2] = [11, 10];
const STATES: [usize; 2] = [13, 15];

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

/// Sender of signals in this condition, as lists of recordings name it: "unassisted", "ToM-Com", "wizard"; in a plan its arm, "wizard with advice".
pub(super) fn condition(session: &Session) -> &'static str {
    match session.spec.trial.condition {
        _ if session.step().is_some() => session.study_arm().title(),
        Condition::None => "unassisted",
        Condition::Assistant => session.study_arm().title(),
        Condition::Wizard => "wizard",
    }
}

/// Facts of the head line that do not change during a trial, the most important first.
fn facts(session: &Session, model: &ConsoleModel) -> Vec<String> {
    let name = model.playback.as_ref().map(|playback| playback.name.clone());
    name.into_iter().chain([session.kitchen.title.clone()]).chain(streamed(model)).collect()
}

/// States in words, with their styles: recording, gaze and robot, then those that only some sessions have.
pub(super) fn healths(session: &Session, model: &ConsoleModel) -> Vec<(String, TextRole)> {
    let recording = match &model.playback {
        Some(playback) => {
            let state = if playback.playing { "play" } else { "paused" };
            let follows = if playback.follows { " live" } else { "" };
            (format!("{state} {}{follows}", playback.speed_label()), TextRole::Strong)
        }
        None => match &model.recording {
            RecordingStatus::Off => ("not recorded".to_string(), TextRole::Quiet),
            RecordingStatus::On(_) => (format!("{} rec", model.theme.signs().recording), TextRole::Text),
            RecordingStatus::Lost => (" RECORDING LOST ".to_string(), TextRole::Alarm),
        },
    };
    let mut healths = vec![recording, gaze(session, model), robot(session)];
    if !model.focused && model.playback.is_none() {
        healths.push((" NO KEYBOARD ".to_string(), TextRole::Alarm));
    }
    if model.playback.as_ref().is_some_and(|playback| playback.excluded) || session.excluded.is_some() {
        healths.push((" EXCLUDED ".to_string(), TextRole::Strong));
    }
    match &model.playback {
        Some(playback) if !playback.follows && playback.running => {
            healths.push(("recording goes on: --follow".to_string(), TextRole::Strong));
        }
        Some(playback) if !playback.follows && playback.cut => {
            healths.push(("recording cut".to_string(), TextRole::Alarm));
        }
        _ => {}
    }
    if let Some((text, is_fine)) = model.display.as_ref().map(|display| display.line()) {
        healths.push((text, if is_fine { TextRole::Text } else { TextRole::Alarm }));
    }
    healths.extend(button_box(session, model));
    healths.extend(model.films.as_ref().map(films));
    if let Some(RerunStreamStatus { dropped: dropped @ 1.., .. }) = &model.viewers {
        healths.push((format!("RERUN {dropped} ROWS DROPPED"), TextRole::Alarm));
    }
    healths
}

/// State of the robot in words.
fn robot(session: &Session) -> (String, TextRole) {
    let mode = session.robot.safety_mode();
    let is_over = matches!(session.phase, TrialPhase::Over(_) | TrialPhase::Closed);
    let is_ready = !session.spec.robot.arm.is_real() || matches!(session.robot.arm.stage, Some((ArmStage::Ready, _)));
    let (words, role) = match (session.robot.stopped, session.robot.held) {
        _ if !is_ready && !is_over && !mode.is_stopped() => ("ARM NOT READY", TextRole::Alarm),
        (true, _) => (mode.name(), TextRole::Alarm),
        (false, true) => ("ROBOT HELD", TextRole::Strong),
        // In a pause and after the trial the arm rests.
        (false, false) if mode == SafetyMode::Safeguard && session.is_running() => (mode.name(), TextRole::Strong),
        (false, false) if mode == SafetyMode::Reduced && session.is_running() => ("robot slow", TextRole::Strong),
        (false, false) => ("robot ok", TextRole::Text),
    };
    (words.to_string(), role)
}

/// State of the participant's button box in words; `None` in a session without one.
fn button_box(session: &Session, model: &ConsoleModel) -> Option<(String, TextRole)> {
    session.spec.participant.button_box.as_ref()?;
    Some(match &session.button_box.link {
        DeviceConnection::Unknown => ("buttons idle".to_string(), TextRole::Quiet),
        DeviceConnection::Connected { .. } => ("buttons ok".to_string(), TextRole::Text),
        DeviceConnection::Lost { since, .. } => {
            (format!("NO BUTTONS {:.0} s", model.now.secs_since(*since)), TextRole::Alarm)
        }
    })
}

/// State of the cameras in words.
fn films(status: &FilmStatus) -> (String, TextRole) {
    let FilmStatus { cameras, filming, lost, is_on, .. } = status;
    match (is_on, lost) {
        (false, _) => ("film idle".to_string(), TextRole::Quiet),
        (true, 0) if filming < cameras => ("film opens".to_string(), TextRole::Quiet),
        (true, 0) => ("film ok".to_string(), TextRole::Text),
        (true, _) if *cameras == 1 => ("NO FILM".to_string(), TextRole::Alarm),
        (true, lost) => (format!("NO FILM {lost} OF {cameras}"), TextRole::Alarm),
    }
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
    match (GazeLoss::now(session, model.now), session.gaze_hz(model.now)) {
        (Some(loss), _) => (loss.capitals(model.now), TextRole::Alarm),
        (None, Some(hz)) => (format!("gaze {hz:>3.0} Hz"), TextRole::Text),
        (None, None) => ("gaze idle".to_string(), TextRole::Quiet),
    }
}
