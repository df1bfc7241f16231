//! Preflight checks of participant, gaze, eye tracker and disk space.

use super::condition::Condition;
use super::fitted_parameters::ParameterSource;
use super::gaze_samples::faults;
use super::lsl_settings::LslGazeSpec;
use super::participant_settings::{GazeSource, ParticipantKind};
pub use super::preflight_check::{PreflightCheck, PreflightVerdict};
use super::session_state::Session;
use super::tracker::TrackerConnection;
use crate::base::time::SessionTime;
use crate::gaze::calibration::{GOOD_DEG, USABLE_DEG};
use crate::mind::model::HumanModel;

/// Sampling rate of the gaze below which short looks are missed, in Hz.
const SLOW_HZ: f64 = 20.0;
/// Time without a usable gaze sample after which gaze counts as missing, in seconds.
const UNUSABLE_S: f64 = 1.0;
/// Free disk space, in bytes, below which the preflight check warns, and below which it fails; a session of 15 min
/// takes about 10 MB.
const FREE_BYTES: (u64, u64) = (1 << 30, 50 << 20);

/// Checks the free disk space for a recording; `None` if the system does not report it.
pub fn space(free_bytes: Option<u64>) -> PreflightCheck {
    let remedy = "free some space, or record elsewhere with --out";
    let Some(free) = free_bytes else {
        return PreflightCheck::new(
            "free space",
            PreflightVerdict::Warning,
            "the system does not say how much space is free",
            remedy,
        );
    };
    let verdict = match free {
        free if free >= FREE_BYTES.0 => PreflightVerdict::Ok,
        free if free >= FREE_BYTES.1 => PreflightVerdict::Warning,
        _ => PreflightVerdict::Failed,
    };
    PreflightCheck::new("free space", verdict, format!("{} MB free on the disk", free / 1_000_000), remedy)
}

/// Checks whether the trial's settings are those of the study arm that the plan prescribes; `None` outside of plans.
fn condition(session: &Session) -> Option<PreflightCheck> {
    let spec = &session.spec;
    let planned = spec.step.as_ref()?.arm?;
    let arm = session.study_arm();
    let sees = match spec.trial.condition {
        Condition::Wizard => format!(", who sees {}", spec.console.visibility.title()),
        Condition::None | Condition::Assistant => String::new(),
    };
    if arm == planned {
        return Some(PreflightCheck::ok("condition", format!("{}{sees}", arm.title())));
    }
    let found = format!("{}{sees}; planned: {}", arm.title(), planned.title());
    let remedy = "what the wizard sees is part of the condition: start the trial anew with the plan's settings";
    Some(PreflightCheck::new("condition", PreflightVerdict::Failed, found, remedy))
}

/// Says which human model the session has, unless it is the default, and whose parameters (the participant's or the
/// population's), if its file has some of persons.
fn human_model(session: &Session) -> Option<PreflightCheck> {
    let spec = &session.spec;
    let file = spec.human_model.as_deref().unwrap_or("its file");
    let Some(source) = spec.parameters_of else {
        let told = [vec![spec.human.model.name().to_string()], spec.human.differences()].concat().join("; ");
        return (spec.human != HumanModel::default()).then(|| PreflightCheck::ok("human model", told));
    };
    let found = match source {
        ParameterSource::Person => format!("parameters of the person {}, from {file}", spec.participant.code),
        ParameterSource::Population => {
            format!("parameters of the population: {file} has none of {}", spec.participant.code)
        }
    };
    Some(PreflightCheck::ok("human model", found))
}

/// Checks condition, participant, human model, gaze source and gaze accuracy; `check_gaze` is the key that starts a
/// gaze accuracy check.
pub fn participant(session: &Session, now: SessionTime, check_gaze: &str) -> Vec<PreflightCheck> {
    let spec = &session.spec.participant;
    let who = match spec.kind {
        ParticipantKind::Simulated => "simulated",
        ParticipantKind::Keyboard => "at this keyboard",
        ParticipantKind::Display => "at the wall display",
    };
    let mut checks: Vec<PreflightCheck> = condition(session).into_iter().collect();
    checks.push(PreflightCheck::ok("participant", format!("{}, {who}", spec.code)));
    checks.extend(human_model(session));
    match spec.gaze {
        GazeSource::Simulated => checks.push(PreflightCheck::ok("gaze", "simulated gaze: it comes with the trial")),
        GazeSource::None => checks.push(PreflightCheck::ok("gaze", "this session uses no gaze")),
        GazeSource::File => {
            let file = session.spec.tracker.file.clone().unwrap_or_default();
            checks.push(PreflightCheck::ok("gaze", format!("gaze from {file}: it comes with the trial")));
        }
        GazeSource::Mouse => checks.extend(gaze(session, now)),
        GazeSource::Json => {
            checks.extend(gaze(session, now));
            checks.extend(calibration(session, check_gaze));
        }
        GazeSource::Lsl => {
            checks.push(stream(session));
            checks.extend(gaze(session, now));
            checks.extend(calibration(session, check_gaze));
        }
        GazeSource::Pupil => {
            checks.push(tracker(session));
            checks.extend(gaze(session, now));
            checks.push(calibration(session, check_gaze).unwrap_or_else(|| unchecked(check_gaze)));
        }
    }
    checks
}

fn gaze(session: &Session, now: SessionTime) -> Vec<PreflightCheck> {
    let mends = match session.spec.participant.gaze {
        GazeSource::Json => format!("start the program that sends gaze to port {}", session.spec.participant.gaze_port),
        GazeSource::Pupil => "let the participant look at the wall display; Pupil Capture needs a \
                              calibration"
            .to_string(),
        GazeSource::Lsl => "let the participant look at the display: the stream has no gaze".to_string(),
        GazeSource::Mouse | GazeSource::Simulated | GazeSource::File | GazeSource::None => {
            "move the pointer over the kitchen".to_string()
        }
    };
    let Some(hz) = session.gaze_hz(now) else {
        let is_mouse = session.spec.participant.gaze == GazeSource::Mouse;
        let verdict = if is_mouse { PreflightVerdict::Warning } else { PreflightVerdict::Failed };
        let malformed = session.tracker.dropped.malformed;
        if malformed > 0 && session.spec.participant.gaze == GazeSource::Json {
            let found = format!("{malformed} lines arrived, and the last of them were no gaze samples");
            let remedy = "send a line for each sample: {\"x\": 0 to 1, \"y\": 0 to 1, \"confidence\": 0 to 1}, \"t\" \
                          in seconds if there is a clock";
            return vec![PreflightCheck::new("gaze", PreflightVerdict::Failed, found, remedy)];
        }
        return vec![PreflightCheck::new("gaze", verdict, "no gaze sample arrives", mends)];
    };
    let verdict = if hz < SLOW_HZ { PreflightVerdict::Warning } else { PreflightVerdict::Ok };
    let rate = PreflightCheck::new(
        "gaze",
        verdict,
        format!("{hz:.0} gaze samples a second"),
        "use an eye tracker with 60 samples a second or more",
    );
    let usable = session.gaze.last.filter(|(at, _)| now.secs_since(*at) <= UNUSABLE_S);
    let quality = match usable {
        Some((_, sample)) => {
            PreflightCheck::ok("gaze quality", format!("gaze is usable, confidence {:.2}", sample.confidence))
        }
        None => {
            let found = "no gaze sample is on the display with enough confidence";
            PreflightCheck::new(
                "gaze quality",
                PreflightVerdict::Warning,
                found,
                "set up the eye tracker again, or calibrate it",
            )
        }
    };
    let mut checks = vec![rate, quality];
    let faults = faults(session);
    let (samples, wrong) = (session.gaze.samples, faults.iter().map(|(count, _)| count).sum::<u64>());
    if wrong > 0 {
        // Real gaze streams have some faulty samples; faulty samples are ignored, and matter only if there are many.
        let verdict = if wrong * 20 > samples { PreflightVerdict::Warning } else { PreflightVerdict::Ok };
        let kinds: Vec<String> = faults.iter().map(|(count, kind)| format!("{count} {kind}")).collect();
        let found = format!("{samples} gaze samples; {}", kinds.join(", "));
        // Delayed samples come from a slow computer or network, not from wrong values.
        let remedy = match session.tracker.dropped.malformed * 2 > wrong {
            true => "check what the tracker sends: values are missing, or are no numbers",
            false => "end other programs on the tracker's computer, or use a better network",
        };
        checks.push(PreflightCheck::new("gaze stream", verdict, found, remedy));
    }
    checks
}

/// Checks the connection to the eye tracker, and whether it detects the display.
fn tracker(session: &Session) -> PreflightCheck {
    let spec = &session.spec.tracker;
    let name = "eye tracker";
    match (&session.tracker.link, session.tracker.sees_display) {
        (TrackerConnection::Connected { device }, Some(true)) => {
            PreflightCheck::ok(name, format!("{device}, sees the display"))
        }
        (TrackerConnection::Connected { device }, _) => {
            let others: Vec<String> =
                session.tracker.other_surfaces.iter().map(|other| format!("\"{other}\"")).collect();
            let (found, remedy) = match others.first() {
                None => (
                    format!("{device}, does not see \"{}\"", spec.surface),
                    format!(
                        "keep the display tags in view and lit; define a surface \"{}\" in Capture's Surface \
                             Tracker",
                        spec.surface
                    ),
                ),
                Some(first) => (
                    format!("{device}, sees {first}, not \"{}\"", spec.surface),
                    format!(
                        "set surface = {} under [tracker], or name the surface \"{}\" in Capture",
                        others.join(" or "),
                        spec.surface
                    ),
                ),
            };
            PreflightCheck::new(name, PreflightVerdict::Failed, found, remedy)
        }
        _ => {
            let remedy = format!("start Pupil Capture on {}, with Pupil Remote on port {}", spec.address, spec.port);
            PreflightCheck::new(name, PreflightVerdict::Failed, "Pupil Capture does not answer", remedy)
        }
    }
}

/// Checks the gaze stream from the Lab Streaming Layer.
fn stream(session: &Session) -> PreflightCheck {
    let wanted = session.spec.lsl.as_ref().and_then(|lsl| lsl.gaze.as_ref()).map_or(String::new(), LslGazeSpec::title);
    let found = match &session.tracker.link {
        TrackerConnection::Connected { device } => return PreflightCheck::ok("eye tracker", device.clone()),
        TrackerConnection::Lost { reason, .. } => reason.clone(),
        TrackerConnection::Unknown => format!("no stream {wanted} is in the Lab Streaming Layer"),
    };
    let remedy = "start the program that sends the stream, or set name, x, y and confidence under [lsl.gaze]; tomcom \
                  doctor lists streams and channels";
    PreflightCheck::new("eye tracker", PreflightVerdict::Failed, found, remedy)
}

/// Checks the result of the last gaze accuracy check, if there was one.
fn calibration(session: &Session, check_gaze: &str) -> Option<PreflightCheck> {
    let accuracy_deg = session.calibrated.as_ref()?.accuracy_deg();
    let verdict = match accuracy_deg {
        deg if deg <= GOOD_DEG => PreflightVerdict::Ok,
        deg if deg <= USABLE_DEG => PreflightVerdict::Warning,
        _ => PreflightVerdict::Failed,
    };
    let remedy = format!("calibrate the tracker again, then check its accuracy with targets ({check_gaze})");
    Some(PreflightCheck::new("calibration", verdict, format!("gaze is off by {accuracy_deg:.1} deg"), remedy))
}

fn unchecked(check_gaze: &str) -> PreflightCheck {
    let remedy = format!("{check_gaze} checks gaze accuracy with targets (check_gaze in the key file)");
    PreflightCheck::new("calibration", PreflightVerdict::Warning, "gaze accuracy is not checked", remedy)
}
