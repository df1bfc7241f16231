//! Errors of commands that read recordings, and of running a console.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::path::PathBuf;

use super::resume::ResumeError;
use crate::console::key_action::KeyError;
use tomcom_core::gaze::tags::TagError;
use tomcom_devices::lsl::LslError;
use tomcom_session::files::file_error::FileError;
use tomcom_session::log::RecordingWriteError;

/// Error of the terminal: there is none, it was closed, or the operating system lacks something that the console needs.
#[derive(Debug, thiserror::Error)]
#[error("the console cannot be opened: {0}")]
pub struct TerminalError(pub io::Error);

/// Error of a live session: a device, a file or the recording fails.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LiveError {
    #[error(transparent)]
    #[diagnostic(help("run it in a terminal; without one: tomcom simulate sessions/default.toml"))]
    Terminal(#[from] TerminalError),
    #[error(transparent)]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error("the port for gaze samples at {at} cannot be opened: {reason}")]
    #[diagnostic(help("set another gaze_port in the session file, or an address of this computer as gaze_listen"))]
    Gaze { at: SocketAddr, reason: io::Error },
    #[error(transparent)]
    #[diagnostic(help("{}", .0.remedy()))]
    Lsl(#[from] LslError),
    #[error("the address {address}, port {port}, for the participant's display cannot be opened: {reason}")]
    #[diagnostic(help("set another port in the session file (port under [display]), or an address of this computer"))]
    Display { address: IpAddr, port: u16, reason: io::Error },
    #[error("the driver of the arm cannot be started: {0}")]
    #[diagnostic(help("end other programs, and start tomcom again"))]
    Arm(io::Error),
    #[error("the address {at} for observers cannot be opened: {reason}")]
    #[diagnostic(help("give another port, or an address of this computer, as in --observe=127.0.0.1:50024"))]
    Observers { at: SocketAddr, reason: io::Error },
    /// The display tags do not fit on the display, so that the eye tracker could not find the display.
    #[error("the eye tracker has no surface to look for: found {}", .0.found)]
    #[diagnostic(help("{}; or set a surface of your own, with its corners, in [tracker]", .0.remedy))]
    Tags(TagError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Resume(#[from] ResumeError),
    /// Recordings do not belong to the study plan, for this reason.
    #[error("found {0}")]
    #[diagnostic(help(
        "keep the plan as it was, or give another folder with --out for another plan; tomcom plan SESSION shows the \
         plan"
    ))]
    Plan(String),
    /// A recording was corrected to the code of somebody who is not in the study plan.
    #[error("found {found}")]
    #[diagnostic(help(
        "take the correction back: tomcom correct {} --undo; or correct it to a code of the plan: --code CODE --reason …",
        recording.display()
    ))]
    Corrected { found: String, recording: PathBuf },
}

/// Error while a recording is shown at the console.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReviewError {
    #[error(transparent)]
    #[diagnostic(help("run it in a terminal; `tomcom replay RECORDING` tells a recording in words through a pipe"))]
    Terminal(#[from] TerminalError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] RecordingWriteError),
    #[error("{}: the training cannot be recorded: {reason}", path.display())]
    #[diagnostic(help("give a folder that can be written to with --out"))]
    Training { path: PathBuf, reason: io::Error },
    #[error("the header of the recording: {0}")]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
}
