//! The dashboard server's commands: a line in, a line out.

use super::controller::{Level, ProgramState, SimulatedController};
use super::variables::safety_codes;

/// What the server says to a new client.
pub const GREETING: &str = "Connected: Universal Robots Dashboard Server";
/// What the server says before it closes a connection.
pub const GOODBYE: &str = "Disconnected";
/// Longest command, in bytes.
pub const MOST_BYTES: usize = 4096;

/// The answer to a command; `None` closes the connection after [`GOODBYE`].
pub fn answer(command: &str, controller: &mut SimulatedController) -> Option<String> {
    let command = command.trim();
    let (word, rest) = command.split_once(' ').unwrap_or((command, ""));
    let failed =
        |worked: bool, done: &str| if worked { done.to_string() } else { format!("Failed to execute: {command}") };
    let [major, minor, bugfix, build] = controller.series.version();
    Some(match (command, word) {
        ("quit", _) => return None,
        ("power on", _) => {
            controller.power_on();
            "Powering on".to_string()
        }
        ("power off", _) => {
            controller.power_off();
            "Powering off".to_string()
        }
        ("brake release", _) => {
            controller.release_brakes();
            "Brake releasing".to_string()
        }
        ("unlock protective stop", _) => match controller.unlock() {
            Ok(()) => "Protective stop releasing".to_string(),
            Err(why) => why.to_string(),
        },
        ("restart safety", _) => {
            controller.restart_safety();
            "Restarting safety".to_string()
        }
        ("robotmode", _) => format!("Robotmode: {}", controller.mode()),
        ("safetymode", _) => format!("Safetymode: {}", safety_codes(controller.safety()).0),
        ("safetystatus", _) => format!("Safetystatus: {}", safety_codes(controller.safety()).0),
        ("programState", _) => {
            format!("{} {}", controller.state(), controller.program_name().unwrap_or("<unnamed>"))
        }
        ("running", _) => format!("Program running: {}", controller.state() == ProgramState::Playing),
        ("play", _) => {
            let plays = controller.play();
            failed(plays, "Starting program")
        }
        ("pause", _) => {
            let pauses = controller.pause_program();
            failed(pauses, "Pausing program")
        }
        ("stop", _) => {
            let runs = controller.state() != ProgramState::Stopped;
            controller.stop_program("the dashboard server was told to stop it");
            failed(runs, "Stopped")
        }
        ("get loaded program", _) => controller
            .loaded()
            .map_or("No program loaded".to_string(), |name| format!("Loaded program: /programs/{name}")),
        ("isProgramSaved", _) => format!("true {}", controller.loaded().unwrap_or("<unnamed>")),
        ("PolyscopeVersion", _) => format!("URSoftware {major}.{minor}.{bugfix}.{build} (simulated by tomcom)"),
        ("version", _) => format!("{major}.{minor}.{bugfix}.{build}"),
        ("get serial number", _) => "20175000001".to_string(),
        ("get robot model", _) => "UR5".to_string(),
        ("is in remote control", _) => "true".to_string(),
        ("get operational mode", _) => "NONE".to_string(),
        ("close popup", _) => "closing popup".to_string(),
        ("close safety popup", _) => "closing safety popup".to_string(),
        (_, "load") if !rest.is_empty() && !rest.starts_with("installation") => match controller.load(rest) {
            true => format!("Loading program: {rest}"),
            false => format!("File not found: {rest}"),
        },
        (_, "popup") => {
            controller.tell(Level::Info, format!("popup: {rest}"));
            "showing popup".to_string()
        }
        (_, "addToLog") => {
            controller.tell(Level::Info, format!("log: {rest}"));
            "Added log message".to_string()
        }
        _ => format!("could not understand: '{command}'"),
    })
}
