//! Preflight checks of participant, gaze, eye tracker and disk space.

use serde::{Deserialize, Serialize};

use crate::external::MindRole;
use crate::gaze_samples::{DUPLICATE, MALFORMED, TOO_FREQUENT, faults};
use crate::settings::{Condition, GazeSource, ParticipantKind};
use crate::stream_settings::LslGazeSpec;
use crate::tracker::DeviceConnection;
use crate::{Session, button_box};
use tomcom_core::base::text::count;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::calibration::{GOOD_DEG, USABLE_DEG};
use tomcom_core::gaze::recorded::RecordedGazeSummary;
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};
use tomcom_core::mind::model::HumanModel;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreflightVerdict {
    Ok,
    /// Usable with limitations.
    Warning,
    /// Not usable.
    Failed,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreflightCheck {
    /// What it is about: "display", "disk".
    pub name: String,
    pub verdict: PreflightVerdict,
    pub found: String,
    /// What the wizard can do about it; `None` if the verdict is ok.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
}

impl PreflightCheck {
    /// A check that is ok gets no remedy.
    pub fn new(
        name: &str,
        verdict: PreflightVerdict,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> PreflightCheck {
        let remedy = (verdict != PreflightVerdict::Ok).then(|| remedy.into());
        PreflightCheck { name: name.to_string(), verdict, found: found.into(), remedy }
    }

    pub fn ok(name: &str, found: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Ok, found, "")
    }

    pub fn warning(name: &str, found: impl Into<String>, remedy: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Warning, found, remedy)
    }

    pub fn failed(name: &str, found: impl Into<String>, remedy: impl Into<String>) -> PreflightCheck {
        PreflightCheck::new(name, PreflightVerdict::Failed, found, remedy)
    }
}

/// Rate below which short looks are missed.
const SLOW_HZ: f64 = 20.0;
/// Time without a usable sample after which gaze counts as missing.
const UNUSABLE_S: f64 = 1.0;
/// Free bytes below which the check warns, and below which it fails; a session of 15 min takes about 10 MB.
const FREE_BYTES: (u64, u64) = (1 << 30, 50 << 20);

/// `None` if the system does not say.
pub fn space(free_bytes: Option<u64>) -> PreflightCheck {
    let remedy = "free some space, or record elsewhere with --out";
    let Some(free) = free_bytes else {
        return PreflightCheck::warning("free space", "the system does not say how much space is free", remedy);
    };
    let verdict = match free {
        free if free >= FREE_BYTES.0 => PreflightVerdict::Ok,
        free if free >= FREE_BYTES.1 => PreflightVerdict::Warning,
        _ => PreflightVerdict::Failed,
    };
    PreflightCheck::new("free space", verdict, format!("{} MB free on the disk", free / 1_000_000), remedy)
}

/// Whether the settings are those of the study arm that the plan prescribes.
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
    Some(PreflightCheck::failed("condition", found, remedy))
}

/// How it differs from the named model, unless it is the default.
fn human_model(session: &Session) -> Option<PreflightCheck> {
    let human = &session.spec.human;
    (*human != HumanModel::default()).then(|| PreflightCheck::ok("human model", human.named()))
}

/// Whether an external mind has begun, and is still there.
fn external_mind(session: &Session, role: MindRole, command: &str) -> PreflightCheck {
    let external = &session.external;
    match (external.over.get(&role), external.names.get(&role)) {
        (Some(found), _) => {
            let remedy = "quit tomcom, and try in a shell whether the command starts; the trial would go on without it";
            PreflightCheck::failed(role.name(), found, remedy)
        }
        (None, Some(name)) => PreflightCheck::ok(role.name(), format!("{name} answers")),
        (None, None) => {
            let found = format!("no answer yet of {command}");
            PreflightCheck::warning(role.name(), found, "wait until the program has started")
        }
    }
}

/// Whether the participant reads the tutorial in another language than the rest of the page.
fn tutorial(session: &Session) -> Option<PreflightCheck> {
    let (tutorial, page) = (session.foreign_tutorial()?, session.spec.display.code());
    let found = format!("in the language \"{}\", the page in \"{page}\"", tutorial.language);
    let remedy = format!("translate the plan's tutorial, and name the file as the plan's with .{page}.toml");
    Some(PreflightCheck::warning("tutorial", found, remedy))
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RejectedGaze {
    /// Who was rejected, and why.
    pub told: String,
    pub remedy: String,
}

/// `check_gaze`: key that starts a gaze accuracy check; `rejected`: since the last gaze sample arrived.
pub fn participant(
    session: &Session,
    now: SessionTime,
    check_gaze: &str,
    rejected: Option<&RejectedGaze>,
) -> Vec<PreflightCheck> {
    let spec = &session.spec.participant;
    let who = match spec.kind {
        ParticipantKind::Simulated => "simulated",
        ParticipantKind::Keyboard => "at this keyboard",
        ParticipantKind::Display => "at the wall display",
        ParticipantKind::External => "a program",
    };
    let mut checks: Vec<PreflightCheck> = condition(session).into_iter().collect();
    checks.push(PreflightCheck::ok("participant", format!("{}, {who}", spec.code)));
    let participant = spec.external.as_ref();
    checks.extend(participant.map(|command| external_mind(session, MindRole::Participant, command)));
    checks.extend(human_model(session));
    let concept = session.spec.external_concept();
    checks.extend(concept.map(|mind| external_mind(session, MindRole::Concept, &mind.external)));
    checks.extend(tutorial(session));
    checks.extend(button_box::check(session, now));
    match spec.gaze {
        GazeSource::Simulated => checks.push(PreflightCheck::ok("gaze", "simulated gaze: it comes with the trial")),
        GazeSource::None => checks.push(PreflightCheck::ok("gaze", "this session uses no gaze")),
        // The check of recorded gaze needs the file, which the session does not know.
        GazeSource::File => {}
        source @ (GazeSource::Mouse | GazeSource::Json | GazeSource::Lsl | GazeSource::Pupil) => {
            checks.extend((source == GazeSource::Lsl).then(|| stream(session)));
            checks.extend((source == GazeSource::Pupil).then(|| tracker(session)));
            checks.extend(gaze(session, now, rejected));
            checks.extend((source != GazeSource::Mouse).then(|| calibration(session, check_gaze)));
        }
    }
    checks
}

/// One check of the numbers, and one for each remark about the file. A file without any sample is refused when it is
/// read.
pub fn recorded_gaze(file: &str, found: &RecordedGazeSummary) -> Vec<PreflightCheck> {
    let look = "look at the line that is named; docs/tracker-recorded.md says what is read, and how";
    let (verdict, remedy) = match found {
        found if found.usable == 0 => (
            PreflightVerdict::Failed,
            "a file with gaze on the display; missing_confidence = \"good\" under [tracker], if the tracker knows no \
             confidence",
        ),
        found if found.malformed * 20 > found.samples => (PreflightVerdict::Warning, look),
        _ => (PreflightVerdict::Ok, ""),
    };
    let numbers = PreflightCheck::new("gaze", verdict, format!("{file}: {}", found.words()), remedy);
    let odd = |remark: &String| PreflightCheck::warning("gaze file", remark, look);
    [numbers].into_iter().chain(found.remarks.iter().map(odd)).collect()
}

fn gaze(session: &Session, now: SessionTime, rejected: Option<&RejectedGaze>) -> Vec<PreflightCheck> {
    let mends = match session.spec.participant.gaze {
        GazeSource::Json => format!("start the program that sends gaze to port {}", session.spec.participant.gaze_port),
        GazeSource::Pupil => {
            "let the participant look at the wall display; Pupil Capture needs a calibration".to_string()
        }
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
            let found = format!("{} arrived, and the last were no gaze samples", count(malformed, "line", "lines"));
            let remedy = "send a line for each sample: {\"x\": 0 to 1, \"y\": 0 to 1, \"confidence\": 0 to 1}, \"t\" \
                          in seconds if there is a clock";
            return vec![PreflightCheck::failed("gaze", found, remedy)];
        }
        if let Some(RejectedGaze { told, remedy }) = rejected {
            return vec![PreflightCheck::failed("gaze", told.clone(), remedy.clone())];
        }
        return vec![PreflightCheck::new("gaze", verdict, "no gaze sample arrives", mends)];
    };
    let verdict = if hz < SLOW_HZ { PreflightVerdict::Warning } else { PreflightVerdict::Ok };
    let found = format!("{hz:.0} gaze samples a second");
    let rate = PreflightCheck::new("gaze", verdict, found, "use an eye tracker with 60 samples a second or more");
    let usable = session.gaze.last.filter(|(at, _)| now.secs_since(*at) <= UNUSABLE_S);
    let quality = match usable {
        Some((_, sample)) => {
            PreflightCheck::ok("gaze quality", format!("gaze is usable, confidence {:.2}", sample.confidence))
        }
        None => unusable(session),
    };
    let mut checks = vec![rate, quality];
    if let Some(fault) = session.tracker.stamp_fault {
        let found = format!("{}: gaze counts as taken when it arrives", fault.words());
        let remedy = match session.spec.participant.gaze {
            GazeSource::Lsl => "let the sender stamp each sample with LSL's clock when it is taken",
            _ => "send t in seconds of a clock, read when the sample is taken; or leave t out",
        };
        checks.push(PreflightCheck::warning("gaze times", found, remedy));
    }
    checks.extend(stream_faults(session));
    checks
}

/// Coordinates that are farther from the display than this, in fractions of it, are those of another unit.
const OTHER_UNIT: f64 = 1.0;

/// Why no sample of the last second was usable, told by the latest one.
fn unusable(session: &Session) -> PreflightCheck {
    let tracker = "set up the eye tracker again, or calibrate it";
    let Some(GazeSample { x, y, confidence, .. }) = session.gaze.latest_unusable else {
        let found = "no gaze sample is on the display with enough confidence";
        return PreflightCheck::warning("gaze quality", found, tracker);
    };
    let (mut found, mut remedies) = (Vec::new(), Vec::new());
    let source = session.spec.participant.gaze;
    let is_other_unit = [x, y].iter().any(|value| !(-OTHER_UNIT..=1.0 + OTHER_UNIT).contains(value));
    let point = format!("{}, {}", (x * 100.0).round() / 100.0, (y * 100.0).round() / 100.0);
    if is_other_unit && matches!(source, GazeSource::Json | GazeSource::Lsl) {
        found.push(format!("x, y are {point}; on the display they are 0 to 1"));
        remedies.push(match source {
            GazeSource::Lsl => "set unit, size and origin under [lsl.gaze] to those of the stream",
            _ => "send fractions of the display: pixels by its width and height in pixels, percent by 100",
        });
    } else if !(0.0..=1.0).contains(&x) || !(0.0..=1.0).contains(&y) {
        found.push(format!("x, y are {point}: beside the display, where they are 0 to 1"));
        remedies.push("let the participant look at the display; check the gaze with targets, or calibrate the tracker");
    }
    if confidence < MIN_CONFIDENCE {
        found.push(format!("the confidence is {confidence:.2}, and must be {MIN_CONFIDENCE} or more"));
        remedies.push(tracker);
        remedies.push("set missing_confidence = \"good\" under [tracker], if it knows no confidence");
    }
    let found = format!("the last sample is not usable: {}", found.join("; "));
    PreflightCheck::warning("gaze quality", found, remedies.join("; "))
}

/// Real gaze streams have some faulty samples; they are ignored, and matter only if there are many.
fn stream_faults(session: &Session) -> Option<PreflightCheck> {
    let faults = faults(session);
    let (samples, wrong) = (session.gaze.samples, faults.iter().map(|(count, _)| count).sum::<u64>());
    let (_, worst) = faults.iter().max_by_key(|(count, _)| *count)?;
    let verdict = if wrong * 20 > samples { PreflightVerdict::Warning } else { PreflightVerdict::Ok };
    let kinds: Vec<String> = faults.iter().map(|(count, kind)| format!("{count} {kind}")).collect();
    let found = format!("{samples} gaze samples; {}", kinds.join(", "));
    let remedy = match *worst {
        MALFORMED => "check what the tracker sends: values are missing, or are no numbers",
        TOO_FREQUENT => "send at most 2000 gaze samples a second",
        DUPLICATE => "send each sample once, with a t of its own: many have the time and place of an earlier one",
        // Delayed samples come from a slow computer or network, not from wrong values.
        _ if session.tracker.stamp_fault.is_none() => {
            "end other programs on the tracker's computer, or use a better network"
        }
        _ => "mend the times of the samples: see gaze times",
    };
    Some(PreflightCheck::new("gaze stream", verdict, found, remedy))
}

fn tracker(session: &Session) -> PreflightCheck {
    let spec = &session.spec.tracker;
    let name = "eye tracker";
    match (&session.tracker.link, session.tracker.sees_display) {
        (DeviceConnection::Connected { device }, Some(true)) => {
            PreflightCheck::ok(name, format!("{device}, sees the display"))
        }
        (DeviceConnection::Connected { device }, _) => {
            let others: Vec<String> =
                session.tracker.other_surfaces.iter().map(|other| format!("\"{other}\"")).collect();
            let (found, remedy) = match others.first() {
                None => (
                    format!("{device}, does not see \"{}\"", spec.surface),
                    format!(
                        "keep the display tags in view and lit; define a surface \"{}\" in Capture's Surface Tracker",
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
            PreflightCheck::failed(name, found, remedy)
        }
        _ => {
            let remedy = format!("start Pupil Capture on {}, with Pupil Remote on port {}", spec.address, spec.port);
            PreflightCheck::failed(name, "Pupil Capture does not answer", remedy)
        }
    }
}

fn stream(session: &Session) -> PreflightCheck {
    let wanted = session.spec.lsl.as_ref().and_then(|lsl| lsl.gaze.as_ref()).map_or(String::new(), LslGazeSpec::title);
    if let streams @ [_, _, ..] = &session.tracker.several_streams[..] {
        let found = format!("{} streams {wanted}: {}", streams.len(), streams.join("; "));
        let remedy = "set source_id or host under [lsl.gaze] to those of the tracker, or end the others";
        return PreflightCheck::failed("eye tracker", found, remedy);
    }
    let found = match &session.tracker.link {
        DeviceConnection::Connected { device } => return PreflightCheck::ok("eye tracker", device.clone()),
        DeviceConnection::Lost { reason, .. } => reason.clone(),
        DeviceConnection::Unknown => format!("no stream {wanted} is in the Lab Streaming Layer"),
    };
    let remedy = "start the program that sends the stream, or set name, x, y and confidence under [lsl.gaze]; tomcom \
                  doctor lists streams and channels";
    PreflightCheck::failed("eye tracker", found, remedy)
}

fn calibration(session: &Session, check_gaze: &str) -> PreflightCheck {
    let Some(accuracy_deg) = session.calibrated.as_ref().map(|checked| checked.accuracy_deg()) else {
        let remedy = format!("{check_gaze} checks gaze accuracy with targets (check_gaze in the key file)");
        return PreflightCheck::warning("calibration", "gaze accuracy is not checked", remedy);
    };
    let verdict = match accuracy_deg {
        deg if deg <= GOOD_DEG => PreflightVerdict::Ok,
        deg if deg <= USABLE_DEG => PreflightVerdict::Warning,
        _ => PreflightVerdict::Failed,
    };
    let remedy = format!("calibrate the tracker again, then check its accuracy with targets ({check_gaze})");
    PreflightCheck::new("calibration", verdict, format!("gaze is off by {accuracy_deg:.1} deg"), remedy)
}
