//! Why something could not be done with recordings.

use crate::edge::file_error::FileError;
use crate::edge::log::WriteError;

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
