//! Checks of the participant's page and button box, of the gaze source, of a real arm and of the Lab Streaming Layer for `tomcom doctor`, where the
//! session uses them.

use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::path::Path;

use tomcom_core::base::text::printable;
use tomcom_core::gaze::tags::TagError;
use tomcom_core::kitchen::Kitchen;
use tomcom_devices::lsl::{self, DiscoveredLslStream};
#[cfg(feature = "ur")]
use tomcom_devices::ur::{driver::UrDriver, link, server::PORTS};
use tomcom_devices::{button_box, gaze_file, pupil};
use tomcom_session::SessionSpec;
use tomcom_session::button_box::REMEDY;
use tomcom_session::preflight_checks::{PreflightCheck, recorded_gaze};
#[cfg(feature = "ur")]
use tomcom_session::settings::{ArmKind, RobotSpec};
use tomcom_session::settings::{GazeSource, ParticipantKind, ParticipantSpec};
use tomcom_session::tracker::TrackerSpec;

/// Time limit for finding streams of the Lab Streaming Layer and for reading their channels, in seconds.
const STREAM_S: f64 = 3.0;

pub(super) fn display(spec: &SessionSpec) -> Option<PreflightCheck> {
    if spec.participant.kind != ParticipantKind::Display {
        return None;
    }
    let address = SocketAddr::new(spec.display.listen, spec.display.port);
    let remedy = "end the program that uses the port, or set another address or port under [display]";
    Some(match TcpListener::bind(address) {
        Ok(_) => PreflightCheck::ok("wall display", format!("{address} is free for the participant's page")),
        Err(reason) => PreflightCheck::failed("wall display", format!("{address}: {reason}"), remedy),
    })
}

/// Checks of a real arm and its controller; nothing moves.
#[cfg(feature = "ur")]
pub(super) fn arm(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<PreflightCheck> {
    let ArmKind::Ur(address) = spec.robot.arm else { return Vec::new() };
    let driver = UrDriver::new(kitchen, spec.robot.speed.unwrap_or(RobotSpec::SPEED), false);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let found = runtime.map_err(|error| error.to_string());
    found.and_then(|runtime| runtime.block_on(link::examine(address, PORTS, driver))).unwrap_or_else(|why| {
        let remedy = "switch the controller on, and set its address under [robot]: arm = { ur = \"192.168.1.10\" }";
        vec![PreflightCheck::failed("controller", why, remedy)]
    })
}

pub(super) fn button_box(spec: &SessionSpec) -> Option<PreflightCheck> {
    let path = spec.participant.button_box.as_ref()?;
    Some(match button_box::open(path) {
        Ok(_) => PreflightCheck::ok(
            "button box",
            format!("{path} can be read; the console tells each press before the trial"),
        ),
        Err(reason) => {
            let here = button_box::lines_here();
            let here = if here.is_empty() { "none".to_string() } else { here.join(", ") };
            let found = format!("{path}: {reason}; serial lines of this computer: {here}");
            PreflightCheck::failed("button box", found, REMEDY)
        }
    })
}

pub(super) fn gaze(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<PreflightCheck> {
    match spec.participant.gaze {
        GazeSource::Pupil => vec![eye_tracker(&spec.tracker)],
        GazeSource::Json => vec![lines(&spec.participant)],
        GazeSource::Lsl => vec![stream(spec)],
        GazeSource::File => file(&spec.tracker, kitchen),
        GazeSource::Simulated | GazeSource::Mouse | GazeSource::None => Vec::new(),
    }
}

fn eye_tracker(tracker: &TrackerSpec) -> PreflightCheck {
    let (address, port) = (&tracker.address, tracker.port);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let answer = runtime.and_then(|runtime| runtime.block_on(pupil::version(address, port)));
    let remedy = "start Pupil Capture with Pupil Remote on; if it runs on another computer, set its address under \
                  [tracker]";
    match answer {
        Ok(version) => PreflightCheck::ok("eye tracker", format!("{version} answers at {address}:{port}")),
        Err(reason) => {
            let found = format!("no eye tracker answers at {address}:{port} ({reason})");
            PreflightCheck::failed("eye tracker", found, remedy)
        }
    }
}

fn lines(spec: &ParticipantSpec) -> PreflightCheck {
    let address = SocketAddr::new(spec.gaze_listen, spec.gaze_port);
    match TcpListener::bind(address).and_then(|_| UdpSocket::bind(address)) {
        Ok(_) => {
            let asks_code = !spec.gaze_listen.is_loopback() && spec.gaze_from.is_empty();
            let who = if asks_code { "; other computers need the pairing code" } else { "" };
            PreflightCheck::ok("gaze", format!("{address} is free for gaze as lines of JSON{who}"))
        }
        Err(reason) => {
            let remedy = "end the program that uses the port, or set another gaze_port or gaze_listen under \
                          [participant]";
            PreflightCheck::failed("gaze", format!("{address}: {reason}"), remedy)
        }
    }
}

pub(super) fn lsl(spec: &SessionSpec) -> Option<PreflightCheck> {
    spec.uses_lsl().then(|| match lsl::load(spec.lsl.as_ref()) {
        Ok(library) => {
            PreflightCheck::ok("lsl", format!("liblsl {:.2} can be loaded", f64::from(library.version) / 100.0))
        }
        Err(error) => {
            // The error text is put on one line, since the operating system's loader writes long texts.
            let found = printable(&error.to_string()).into_owned();
            PreflightCheck::failed("lsl", found, error.remedy())
        }
    })
}

/// Checks whether the Lab Streaming Layer offers the session's gaze stream, and lists the available streams with their
/// channels.
fn stream(spec: &SessionSpec) -> PreflightCheck {
    let failed = |found: &str, remedy: &str| PreflightCheck::failed("gaze", found, remedy);
    let Some(wanted) = spec.lsl.as_ref().and_then(|lsl| lsl.gaze.as_ref()) else {
        return failed("no [lsl.gaze] in the session file", "set name and channels of the stream under [lsl.gaze]");
    };
    let Ok(library) = lsl::load(spec.lsl.as_ref()) else {
        return failed("no stream of gaze, since liblsl cannot be loaded", "see the check lsl above");
    };
    let streams = lsl::streams_of_numbers(library, STREAM_S);
    let there: Vec<(&DiscoveredLslStream, Vec<String>)> =
        streams.iter().map(|found| (found, lsl::channel_names(found, STREAM_S).unwrap_or_default())).collect();
    let told = |(found, channels): &(&DiscoveredLslStream, Vec<String>)| {
        format!("{}: {}", lsl::described(found), channels.join(", "))
    };
    let is_wanted = |(found, _): &&(&DiscoveredLslStream, Vec<String>)| {
        let [name, content, host] = found.identity();
        let wanted = [&wanted.name, &wanted.content, &wanted.host, &wanted.source_id];
        let found = [name, content, host, found.source()];
        wanted.iter().zip(found).all(|(wanted, found)| wanted.as_ref().is_none_or(|wanted| *wanted == found))
    };
    let fitting: Vec<_> = there.iter().filter(is_wanted).collect();
    if let [_, _, ..] = fitting[..] {
        let all: Vec<String> = fitting.into_iter().map(told).collect();
        let found = format!("{} LSL streams {}: {}", all.len(), wanted.title(), all.join("; "));
        let remedy = "set source_id or host under [lsl.gaze] to those of one of them, or end the others";
        return failed(&found, remedy);
    }
    if let Some(one) = fitting.first() {
        let remedy = "set x, y and confidence under [lsl.gaze] to labels of channels, or to their numbers from 1";
        return match lsl::missing_channel(wanted, &one.1) {
            None => PreflightCheck::ok("gaze", told(one)),
            Some(missing) => failed(&format!("the stream has no channel \"{missing}\"; it has {}", told(one)), remedy),
        };
    }
    let others: Vec<String> = there.iter().map(told).collect();
    let found = match others.is_empty() {
        true => format!("no LSL stream {}, and no other stream of numbers", wanted.title()),
        false => format!("no LSL stream {}; the streams of numbers are {}", wanted.title(), others.join("; ")),
    };
    failed(&found, "start the program that sends the stream; its name and type are set under [lsl.gaze]")
}

fn file(tracker: &TrackerSpec, kitchen: &Kitchen) -> Vec<PreflightCheck> {
    let path = tracker.file.as_deref().unwrap_or_default();
    let failed = |found: String, remedy| vec![PreflightCheck::failed("gaze", found, remedy)];
    let map = match tracker.surface_map(kitchen) {
        Ok(map) => map,
        Err(TagError { found, remedy }) => return failed(found, remedy),
    };
    match gaze_file::read(Path::new(path), &map, tracker) {
        Ok(found) => recorded_gaze(path, &found.summary),
        Err(error) => failed(error.to_string(), error.remedy().to_string()),
    }
}
