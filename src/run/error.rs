//! Errors of commands on recordings, and of running a console.

use std::io;
use std::net::IpAddr;
use std::path::PathBuf;

use super::resume::ResumeError;
use crate::console::key_action::KeyError;
use crate::edge::file_error::FileError;
use crate::edge::log::WriteError;
use crate::gaze::tags::TagError;

/// A file cannot be read, or a result cannot be written.
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

/// There is no terminal, it was closed, or the operating system lacks something that the console needs.
#[derive(Debug, thiserror::Error)]
#[error("the console cannot be opened: {0}")]
pub struct TerminalError(pub io::Error);

/// Error of a live session.
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

/// Error of showing a recording.
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
