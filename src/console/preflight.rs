//! Preflight checks at the console. If all are ok, the trial starts at once; else a list shows the problems with
//! remedies, and the wizard fixes or overrides them. The results are recorded.

use core::net::SocketAddr;
use std::ffi::OsStr;
use std::path::Path;

use crossterm::event::KeyCode;

use super::console_message::ConsoleCommand;
use super::console_model::{ConsoleModel, Dialog, LslStatus, RecordingStatus, RerunStreamStatus};
use super::display_status::is_wanted;
use super::key_action::KeyAction;
use super::key_action::ManualAction;
use super::notice::NoticeLevel;
use super::probe_keys::{ProbeAnswerer, answerer};
use tomcom_core::base::text::count;
use tomcom_session::admit::admit;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, participant, recorded_gaze, space};
use tomcom_session::probes::of_trial;
use tomcom_session::{Event, Session};

/// The key that overrides failed preflight checks and starts the trial.
pub const OVERRIDE: char = 'o';

/// Runs all preflight checks: participant, gaze, display, robot, recording, disk, keyboard, streams.
pub fn checks(session: &Session, model: &ConsoleModel) -> Vec<PreflightCheck> {
    let check_gaze = key(model, &KeyAction::Hand(ManualAction::Calibrate));
    let rejected = model.rejected_since(session.gaze.arrived);
    let mut checks = participant(session, model.now, &check_gaze, rejected);
    let path = session.spec.tracker.file.as_deref().unwrap_or_default();
    let file = Path::new(path).file_name().map_or_else(Default::default, OsStr::to_string_lossy);
    checks.extend(model.recorded_gaze.iter().flat_map(|found| recorded_gaze(&file, found)));
    checks.extend(model.gaze_pairing.as_ref().and_then(|pairing| pairing.check(session, model.now)));
    checks.extend(model.display.as_ref().map(|display| display.check(session.spec.participant.gaze)));
    checks.extend(probes(session, model));
    checks.extend([robot(session, model), recording(model), space(model.free_bytes), keyboard(model)]);
    checks.extend(model.viewers.as_ref().map(viewers));
    checks.extend(model.lsl.as_ref().map(lsl));
    checks
}

/// Whether all preflight checks are ok.
pub fn all_ok(checks: &[PreflightCheck]) -> bool {
    checks.iter().all(|check| check.verdict == PreflightVerdict::Ok)
}

/// Name of the key that carries out an action.
fn key(model: &ConsoleModel, action: &KeyAction) -> String {
    model.keys.chord_for(action).map(|key| key.to_string()).unwrap_or_default()
}

fn robot(session: &Session, model: &ConsoleModel) -> PreflightCheck {
    match (session.robot.stopped, session.robot.held) {
        (true, _) => {
            let resume = key(model, &KeyAction::ResumeRobot);
            PreflightCheck::new(
                "robot",
                PreflightVerdict::Failed,
                "the robot is stopped",
                format!("{resume} resumes the robot"),
            )
        }
        (false, true) => {
            let release = key(model, &KeyAction::Hand(ManualAction::HoldRobot));
            PreflightCheck::new(
                "robot",
                PreflightVerdict::Warning,
                "the robot is held before its first press",
                format!("{release} releases the robot"),
            )
        }
        (false, false) => PreflightCheck::ok("robot", "the robot is ready"),
    }
}

/// Preflight check of the trial's freeze probes: their number, and where they are answered.
fn probes(session: &Session, model: &ConsoleModel) -> Option<PreflightCheck> {
    let probes = of_trial(&session.spec)?;
    let minutes = session.spec.trial.seconds / 60.0;
    let found = |where_: &str| {
        format!("{} freeze probes in {} min, {where_}", probes.per_trial, (10.0 * minutes).round() / 10.0)
    };
    Some(match answerer(session, model) {
        ProbeAnswerer::Display => PreflightCheck::ok("probes", found("answered on the display")),
        ProbeAnswerer::Simulated => PreflightCheck::ok("probes", found("answered by the simulated participant")),
        ProbeAnswerer::Console if !is_wanted(session) => PreflightCheck::ok("probes", found("answered at the console")),
        ProbeAnswerer::Console => {
            let remedy = "open the participant's page, or read the questions out and enter the answers here";
            PreflightCheck::new("probes", PreflightVerdict::Warning, found("participant's page missing"), remedy)
        }
    })
}

fn recording(model: &ConsoleModel) -> PreflightCheck {
    match &model.recording {
        RecordingStatus::On(folder) => PreflightCheck::ok("recording", folder.clone()),
        RecordingStatus::Off => PreflightCheck::new(
            "recording",
            PreflightVerdict::Failed,
            "the session is not recorded",
            "quit tomcom and start it again",
        ),
        RecordingStatus::Lost => PreflightCheck::new(
            "recording",
            PreflightVerdict::Failed,
            "the recording cannot be written",
            "quit tomcom and start it again",
        ),
    }
}

fn viewers(viewers: &RerunStreamStatus) -> PreflightCheck {
    let RerunStreamStatus { address, dropped, .. } = viewers;
    let is_open = |address: &String| address.parse::<SocketAddr>().is_ok_and(|address| !address.ip().is_loopback());
    let found = match address {
        Some(address) if is_open(address) => format!("Rerun viewers at {address} need no password"),
        Some(address) => format!("Rerun viewers connect at {address}"),
        None => "stream for Rerun is recorded, no viewer can connect".to_string(),
    };
    let warning = |found, remedy: &str| PreflightCheck::new("rerun", PreflightVerdict::Warning, found, remedy);
    match (dropped, address.as_ref().is_some_and(is_open)) {
        (0, false) => PreflightCheck::ok("rerun", found),
        (0, true) => warning(
            found,
            "whoever reaches this address can watch the session; start with --rerun-listen 127.0.0.1:9876 to let only \
             this computer watch",
        ),
        (dropped, _) => warning(
            format!("{found}; {} dropped", count(*dropped, "row", "rows")),
            "close other programs that use the processor; tomcom review makes the Rerun stream again from the log",
        ),
    }
}

fn lsl(status: &LslStatus) -> PreflightCheck {
    let found = format!("any computer in the network can read the streams {}", status.streams.join(", "));
    match status.lost {
        0 => PreflightCheck::ok("lsl", found),
        lost => {
            let remedy = "close other programs that use the processor; the recording itself has every event";
            let lost = count(lost, "sample", "samples");
            PreflightCheck::new("lsl", PreflightVerdict::Warning, format!("{lost} lost; {found}"), remedy)
        }
    }
}

fn keyboard(model: &ConsoleModel) -> PreflightCheck {
    match model.focused {
        true => PreflightCheck::ok("keyboard", "this window has the keyboard focus"),
        false => PreflightCheck::new(
            "keyboard",
            PreflightVerdict::Failed,
            "this window does not have the keyboard focus",
            "click into this window",
        ),
    }
}

/// Starts the trial if all preflight checks are ok; else opens the list of checks.
pub(super) fn start(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    match all_ok(&checks(session, model)) {
        true => go(model, session, false),
        false => {
            if let Err(reason) = admit(session, &Event::TrialStarted) {
                model.say(NoticeLevel::Refused, reason);
                return None;
            }
            model.dialog = Some(Dialog::Preflight);
            None
        }
    }
}

fn go(model: &mut ConsoleModel, session: &Session, overridden: bool) -> Option<ConsoleCommand> {
    let checks = checks(session, model);
    if let Err(reason) = admit(session, &Event::TrialStarted) {
        model.say(NoticeLevel::Refused, reason);
        return None;
    }
    model.dialog = None;
    let words =
        if overridden { "the trial runs, although not all checks are ok" } else { "all checks are ok: the trial runs" };
    model.say(NoticeLevel::Done, words);
    Some(ConsoleCommand::Start(Event::Preflight { checks, overridden }))
}

/// Handles a key while the list of preflight checks is open.
pub(super) fn answer(
    model: &mut ConsoleModel,
    session: &Session,
    code: KeyCode,
    action: Option<KeyAction>,
    is_press: bool,
) -> Option<ConsoleCommand> {
    let is_ok = all_ok(&checks(session, model));
    match (code, action) {
        (KeyCode::Esc, _) => {
            model.dialog = None;
            None
        }
        // Keys that fix a problem also work in the list of preflight checks.
        (_, Some(KeyAction::ResumeRobot)) => super::sending::resume_robot(model, session),
        (_, Some(KeyAction::Hand(ManualAction::HoldRobot))) if is_press => {
            super::hands::act(model, session, ManualAction::HoldRobot)
        }
        (_, Some(KeyAction::Advance)) if is_press && is_ok => go(model, session, false),
        // If the problem has been fixed in the meantime, the start does not count as an override.
        (KeyCode::Char(OVERRIDE), _) if is_press => go(model, session, !is_ok),
        _ => None,
    }
}
