//! Why something could not be done with recordings, and why a console could not be run.

use std::io;
use std::net::IpAddr;
use std::path::PathBuf;

use super::resume::ResumeError;
use crate::console::key_action::KeyError;
use crate::edge::file_error::FileError;
use crate::edge::log::WriteError;
use crate::gaze::tags::TagError;

/// What is needed cannot be read, or what comes of it cannot be written.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] WriteError),
}

impl From<FileError> for RunError {
    fn from(error: FileError) -> RunError {
        RunError::File(Box::new(error))
    }
}

/// There is no terminal, or it is gone, or what a console needs of the operating system beside it is not there.
#[derive(Debug, thiserror::Error)]
#[error("the console cannot be opened: {0}")]
pub struct TerminalError(pub io::Error);

/// Why a live session could not be run, or not to its end.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum LiveError {
    #[error(transparent)]
    #[diagnostic(help("run it in a terminal, not through a pipe"))]
    Terminal(#[from] TerminalError),
    #[error(transparent)]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error("nothing can listen on port {port} of localhost for gaze: {reason}")]
    #[diagnostic(help("another port as gaze_port in the session file"))]
    Gaze { port: u16, reason: io::Error },
    #[error("nothing can listen on {address}, port {port}, for the participant's display: {reason}")]
    #[diagnostic(help("another port in the session file (port under [display]), or an address of this computer"))]
    Display { address: IpAddr, port: u16, reason: io::Error },
    #[error("the eye tracker has no surface to look for: found {}", .0.found)]
    #[diagnostic(help("{}; or a surface of your own, with its corners in [tracker]", .0.remedy))]
    Tags(TagError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recording(#[from] WriteError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Resume(#[from] ResumeError),
    #[error("found {0}")]
    #[diagnostic(help(
        "the plan as it was, or another folder with --out for another plan; tomcom plan SESSION shows it"
    ))]
    Plan(String),
}

impl From<FileError> for LiveError {
    fn from(error: FileError) -> LiveError {
        LiveError::File(Box::new(error))
    }
}

/// Why a recording could not be shown.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ReviewError {
    #[error(transparent)]
    #[diagnostic(help("run it in a terminal; `tomcom replay RECORDING` tells a recording in words through a pipe"))]
    Terminal(#[from] TerminalError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    #[error("{}: the training cannot be recorded: {reason}", path.display())]
    #[diagnostic(help("a folder that can be written to, with --out"))]
    Training { path: PathBuf, reason: io::Error },
    #[error("the header of the recording: {0}")]
    #[diagnostic(help("{}", .0.remedy))]
    Keys(#[from] KeyError),
}

impl From<FileError> for ReviewError {
    fn from(error: FileError) -> ReviewError {
        ReviewError::File(Box::new(error))
    }
}
