//! Failures of commands, and their messages.

use std::path::Path;

use crate::run::error::{LiveError, ReviewError};
use crate::run::forget::ParticipantDeletionError;
use tomcom_session::features::MissingFeature;
use tomcom_session::files::file_error::FileError;
use tomcom_session::log::RecordingError;
use tomcom_session::log::{DecisionError, RecordingWriteError};
use tomcom_session::settings::SettingError;

/// Failure of a command, which decides the program's exit code and message.
#[derive(Debug)]
pub(super) enum Failure {
    /// Arguments or files of the command are invalid.
    Wrong(miette::Report),
    /// The command could not do its work.
    Failed(miette::Report),
    /// The command ran, and the result of its check is negative; the result has been printed.
    No,
    /// The program that reads the output has closed the pipe, as `head` does.
    Unread,
}

impl From<MissingFeature> for Failure {
    fn from(missing: MissingFeature) -> Failure {
        Failure::Wrong(miette::miette!(help = missing.remedy(), "{missing}"))
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Failure {
        Failure::Wrong(miette::Report::new(error))
    }
}

impl From<RecordingWriteError> for Failure {
    fn from(error: RecordingWriteError) -> Failure {
        Failure::Failed(miette::Report::new(error))
    }
}

impl From<DecisionError> for Failure {
    fn from(error: DecisionError) -> Failure {
        match error {
            DecisionError::Recording(error) => Failure::from(error),
            error => Failure::Wrong(miette::Report::new(error)),
        }
    }
}

impl From<ParticipantDeletionError> for Failure {
    fn from(error: ParticipantDeletionError) -> Failure {
        Failure::Failed(miette::Report::new(error))
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Failure {
        match error {
            RecordingError::File(error) => Failure::from(error),
            RecordingError::Recording(error) => Failure::from(error),
        }
    }
}

impl From<LiveError> for Failure {
    fn from(error: LiveError) -> Failure {
        match error {
            LiveError::Resume(error) => Failure::Wrong(miette::Report::new(error)),
            LiveError::File(error) => Failure::from(error),
            error @ LiveError::Plan(_) => Failure::Wrong(miette::Report::new(error)),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

impl From<ReviewError> for Failure {
    fn from(error: ReviewError) -> Failure {
        match error {
            ReviewError::File(error) => Failure::from(error),
            error => Failure::Failed(miette::Report::new(error)),
        }
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Failure {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure::Unread,
            _ => Failure::Failed(miette::miette!("the result cannot be printed: {error}")),
        }
    }
}

/// The failure of a command because a setting on the command line is invalid.
pub(super) fn wrong_setting(error: SettingError) -> Failure {
    Failure::Wrong(miette::miette!(help = error.remedy, "found {}", error.found))
}

/// The failure of a command because an argument is invalid for this file.
pub(super) fn wrong_argument(path: &Path, found: String, remedy: &str) -> Failure {
    Failure::Wrong(miette::miette!(help = remedy.to_string(), "{}: found {found}", path.display()))
}

/// The failure of a simulation in which no trial of a program of other people came to its end.
pub(super) fn every_trial_failed(why: &str) -> Failure {
    let help =
        "a program that answers each question; delete the failed recordings before the next try, since they are kept";
    Failure::Failed(miette::miette!(help = help, "every trial failed: {why}"))
}
