//! Preflight checks at the console. If all are ok, the trial starts at once; else a list shows the problems with
//! remedies, and the wizard fixes or overrides them. The results are recorded.

use core::net::SocketAddr;
use std::ffi::OsStr;
use std::path::Path;

use crossterm::event::KeyCode;

use super::actions::{open_dialog, refuse, resume_robot};
use super::console_model::{
    ConsoleCommand, ConsoleModel, Dialog, LslStatus, NoticeLevel, RecordingStatus, RerunStreamStatus,
};
use super::key_action::{KeyAction, ManualAction};
use super::probe_keys::{ProbeAnswerer, answerer};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::robot::ArmStage;
use tomcom_session::admit::admit;
use tomcom_session::history::event_words;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, participant, recorded_gaze, space};
use tomcom_session::probes::of_trial;
use tomcom_session::settings::{ArmKind, GazeSource, ParticipantKind};
use tomcom_session::{Event, Session};

/// The key that overrides failed preflight checks and starts the trial.
pub const OVERRIDE: char = 'o';

/// Runs all preflight checks: participant, gaze, display, robot, recording, disk, keyboard, streams.
pub fn checks(session: &Session, model: &ConsoleModel) -> Vec<PreflightCheck> {
    let check_gaze = key(model, &KeyAction::Manual(ManualAction::Calibrate));
    let rejected = model.rejected_since(session.gaze.arrived);
    let mut checks = participant(session, model.now, &check_gaze, rejected);
    let path = session.spec.tracker.file.as_deref().unwrap_or_default();
    let file = Path::new(path).file_name().map_or_else(Default::default, OsStr::to_string_lossy);
    checks.extend(model.recorded_gaze.iter().flat_map(|found| recorded_gaze(&file, found)));
    checks.extend(model.gaze_pairing.as_ref().and_then(|pairing| pairing.check(session, model.now)));
    checks.extend(model.display.as_ref().map(|display| display.check(session.spec.participant.gaze)));
    checks.extend(model.observers.as_ref().map(ObserverStatus::check));
    checks.extend(probes(session, model));
    checks.extend(model.arm.iter().cloned());
    checks.extend([robot(session, model), recording(model), space(model.free_bytes), keyboard(model)]);
    checks.extend(model.films.as_ref().map(|films| films.check.clone()));
    checks.extend(model.viewers.as_ref().map(viewers));
    checks.extend(model.lsl.as_ref().map(lsl));
    checks
}

pub fn all_ok(checks: &[PreflightCheck]) -> bool {
    checks.iter().all(|check| check.verdict == PreflightVerdict::Ok)
}

fn key(model: &ConsoleModel, action: &KeyAction) -> String {
    model.keys.chord_for(action).map(|key| key.to_string()).unwrap_or_default()
}

/// What the wizard does about the stage in which a real arm is.
fn arm_remedy(model: &ConsoleModel, stage: ArmStage) -> String {
    match stage.asks() {
        Some(what) => format!("{} {what}", key(model, &KeyAction::Manual(ManualAction::ConfirmArm))),
        None if stage == ArmStage::Lost => "switch the controller on, and look at cable and address".to_string(),
        None => "wait; space stops the arm".to_string(),
    }
}

/// Preflight check of how far a real arm is; `None` if it is ready, or is no real one.
fn arm_stage(session: &Session, model: &ConsoleModel) -> Option<PreflightCheck> {
    let failed = |found: String, remedy| Some(PreflightCheck::failed("robot", found, remedy));
    match (session.spec.robot.arm, &session.robot.arm.stage) {
        (ArmKind::Ur(_), Some((ArmStage::Ready, _))) => None,
        (ArmKind::Ur(_), Some((stage, found))) => {
            failed(format!("arm: {}", event_words::arm_stage(*stage, found)), arm_remedy(model, *stage))
        }
        (ArmKind::Ur(address), None) => {
            failed(format!("the arm's controller at {address} has not answered yet"), arm_remedy(model, ArmStage::Lost))
        }
        (ArmKind::Timed | ArmKind::Physics, _) => None,
    }
}

fn robot(session: &Session, model: &ConsoleModel) -> PreflightCheck {
    if let Some(check) = arm_stage(session, model) {
        return check;
    }
    match (session.robot.stopped, session.robot.held) {
        (true, _) => {
            let resume = key(model, &KeyAction::ResumeRobot);
            PreflightCheck::failed("robot", "the robot is stopped", format!("{resume} resumes the robot"))
        }
        (false, true) => {
            let release = key(model, &KeyAction::Manual(ManualAction::HoldRobot));
            let remedy = format!("{release} releases the robot");
            PreflightCheck::warning("robot", "the robot is held before its first press", remedy)
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
            PreflightCheck::warning("probes", found("participant's page missing"), remedy)
        }
    })
}

fn recording(model: &ConsoleModel) -> PreflightCheck {
    let failed = |found| PreflightCheck::failed("recording", found, "quit tomcom and start it again");
    match &model.recording {
        RecordingStatus::On(folder) => PreflightCheck::ok("recording", folder.clone()),
        RecordingStatus::Off => failed("the session is not recorded"),
        RecordingStatus::Lost => failed("the recording cannot be written"),
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
    let warning = |found, remedy: &str| PreflightCheck::warning("rerun", found, remedy);
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
            PreflightCheck::warning("lsl", format!("{lost} lost; {found}"), remedy)
        }
    }
}

fn keyboard(model: &ConsoleModel) -> PreflightCheck {
    match model.focused {
        true => PreflightCheck::ok("keyboard", "this window has the keyboard focus"),
        false => {
            PreflightCheck::failed("keyboard", "this window does not have the keyboard focus", "click into this window")
        }
    }
}

/// Starts the trial if all preflight checks are ok; else opens the list of checks.
pub(super) fn start(model: &mut ConsoleModel, session: &Session) -> Option<ConsoleCommand> {
    match (all_ok(&checks(session, model)), admit(session, &Event::TrialStarted)) {
        (true, _) => go(model, session, false),
        (false, Err(reason)) => refuse(model, reason),
        (false, Ok(())) => open_dialog(model, Dialog::Preflight),
    }
}

fn go(model: &mut ConsoleModel, session: &Session, overridden: bool) -> Option<ConsoleCommand> {
    let checks = checks(session, model);
    if let Err(reason) = admit(session, &Event::TrialStarted) {
        return refuse(model, reason);
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
        (_, Some(KeyAction::ResumeRobot)) => resume_robot(model, session),
        (_, Some(KeyAction::Manual(repair @ (ManualAction::HoldRobot | ManualAction::ConfirmArm)))) if is_press => {
            super::interventions::act(model, session, repair)
        }
        (_, Some(KeyAction::Advance)) if is_press && is_ok => go(model, session, false),
        // If the problem has been fixed in the meantime, the start does not count as an override.
        (KeyCode::Char(OVERRIDE), _) if is_press => go(model, session, !is_ok),
        _ => None,
    }
}

/// State of the participant's display: the web page on the wall screen and its connection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticipantDisplayHealth {
    /// Address of the display's web page: "http://127.0.0.1:50022".
    pub url: String,
    /// Pairing code that the web page asks for; `None` if the page can only be opened at this computer.
    pub code: Option<String>,
    /// Size in pixels of the page that the participant uses; `None` if no such page is connected.
    pub page: Option<[u32; 2]>,
    /// Whether the page shows the layout of upright screens, on which gaze is not mapped.
    pub upright: bool,
    /// Round-trip time between the program and the page, in milliseconds.
    pub round_trip_ms: Option<f64>,
    /// Delay from the participant's last press to its effect on the screen, in milliseconds.
    pub redraw_ms: Option<f64>,
    /// Whether the page's browser can speak the session's language; `None` where signals are not spoken.
    pub voice: Option<bool>,
    pub watching: u64,
    pub malformed: u64,
    pub refused: u64,
}

/// Least size of the participant's page in pixels; a smaller screen is hard to read from where the participant stands.
const SMALL_PX: [u32; 2] = [1280, 720];
/// Round-trip time above which presses at the page are noticeably delayed, in milliseconds.
const SLOW_MS: f64 = 30.0;

impl ParticipantDisplayHealth {
    /// State of the participant's display for the console's head line; `true` if all is well.
    pub fn line(&self) -> (String, bool) {
        match (self.page, self.redraw_ms.or(self.round_trip_ms)) {
            (None, _) => ("NO DISPLAY".to_string(), false),
            (Some(_), None) => ("display ok".to_string(), true),
            (Some(_), Some(ms)) => (format!("display {ms:.0} ms"), true),
        }
    }

    fn address(&self) -> String {
        format!("open {} in a browser, full screen", self.url)
    }

    /// The text, followed by the pairing code if the participant's page asks for a code.
    fn with_code(&self, text: String) -> String {
        match &self.code {
            Some(code) => format!("{text}; pairing code {code}"),
            None => text,
        }
    }

    /// Address to open for the participant, with the pairing code, while no participant page is connected.
    fn to_open(&self) -> Option<String> {
        self.page.is_none().then(|| self.with_code(self.address()))
    }

    /// What the wizard is told wherever the participant's page is wanted and none is connected.
    pub fn missing(&self) -> Option<String> {
        self.to_open().map(|address| format!("the participant's page is not connected: {address}"))
    }

    /// Preflight check of the participant's display before a trial whose gaze comes from this source.
    pub fn check(&self, gaze: GazeSource) -> PreflightCheck {
        let Some([width, height]) = self.page else {
            let found = self.with_code("participant's page not connected".to_string());
            return PreflightCheck::failed("display", found, self.address());
        };
        let trip = self.round_trip_ms.map_or(String::new(), |ms| format!(", {ms:.0} ms round trip"));
        let others = match self.watching {
            0 => String::new(),
            watching => format!(", {watching} more watch the page"),
        };
        let wrong = match self.malformed + self.refused {
            0 => String::new(),
            _ => format!(", {} messages malformed, {} connections rejected", self.malformed, self.refused),
        };
        let upright = if self.upright { " upright" } else { "" };
        let found = format!("{width}x{height}{upright}{trip}{others}{wrong}");
        // Who holds an upright screen in the hand reads it from nearby.
        let is_small = !self.upright && (width < SMALL_PX[0] || height < SMALL_PX[1]);
        let is_slow = self.round_trip_ms.is_some_and(|ms| ms > SLOW_MS);
        let (verdict, remedy) = match (is_small, is_slow) {
            _ if self.voice == Some(false) => (
                PreflightVerdict::Warning,
                "signals are not spoken: the browser has no voice for the display's language; install one, or voice = false",
            ),
            _ if self.upright && gaze != GazeSource::None => {
                (PreflightVerdict::Warning, "turn the screen: on an upright page there is no gaze")
            }
            (true, _) => {
                (PreflightVerdict::Warning, "show the page in full screen (F11) on a display of at least 1280x720")
            }
            (false, true) => {
                (PreflightVerdict::Warning, "open the page on this computer, or use a cable instead of Wi-Fi")
            }
            (false, false) => (PreflightVerdict::Ok, ""),
        };
        PreflightCheck::new("display", verdict, found, remedy)
    }
}

pub fn is_wanted(session: &Session) -> bool {
    session.spec.participant.kind == ParticipantKind::Display
}

/// State of the observers' page of the wizard's screen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObserverStatus {
    /// Address of the page: "http://127.0.0.1:50023".
    pub url: String,
    /// Pairing code that the page asks for; `None` if it can only be opened at this computer.
    pub code: Option<String>,
    pub watching: u64,
    /// Largest number of observers.
    pub most: u64,
}

impl ObserverStatus {
    /// Entry of the preflight list with pairing code and address.
    fn check(&self) -> PreflightCheck {
        // The pairing code stands before the address, because small screens cut the line.
        let code = self.code.as_ref().map_or(String::new(), |code| format!("pairing code {code}; "));
        let ObserverStatus { url, watching, most, .. } = self;
        PreflightCheck::ok("observers", format!("{code}{watching} of at most {most} watch this screen at {url}"))
    }
}

/// Address and pairing code that a gaze sender at another computer needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GazePairing {
    /// Network address to which the sender sends its gaze: "192.168.1.5:50021".
    pub address: String,
    /// Pairing code that the sender has to send first.
    pub code: String,
}

impl GazePairing {
    /// Text with the pairing code for the gaze panel, while no gaze arrives.
    pub fn line(&self, session: &Session, now: SessionTime) -> Option<String> {
        session.gaze_hz(now).is_none().then(|| format!("pairing code {}", self.code))
    }

    /// Entry of the preflight list with pairing code and address, while no gaze arrives.
    pub fn check(&self, session: &Session, now: SessionTime) -> Option<PreflightCheck> {
        // The pairing code stands before the address, because small screens cut the line.
        let found = format!("pairing code {}; send gaze to {}", self.code, self.address);
        session.gaze_hz(now).is_none().then(|| PreflightCheck::ok("gaze pairing", found))
    }
}
