//! What is wrong with a file: which file, the line, what was found and what would be right.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};

use super::place::place_of;
use crate::base::features::{Feature, NotBuilt};

/// What reading a file gives.
pub type FileResult<T> = Result<T, FileError>;

/// Something is wrong with a file.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum FileError {
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        path: PathBuf,
        reason: io::Error,
        #[help]
        remedy: String,
    },
    /// A folder or an option of the command line, or a file as a whole.
    #[error("{name}: found {found}")]
    Unfit {
        name: String,
        found: String,
        #[help]
        remedy: String,
    },
    #[error("{name}:{line}: found {found}")]
    Wrong {
        name: String,
        line: usize,
        found: String,
        #[source_code]
        text: Arc<NamedSource<String>>,
        #[label("here")]
        span: Option<SourceSpan>,
        #[help]
        remedy: String,
    },
}

impl FileError {
    /// An error at a place of a file's text.
    pub fn at(path: &Path, text: &str, span: Option<Range<usize>>, found: String, remedy: String) -> FileError {
        let name = path.display().to_string();
        let start = span.as_ref().map_or(0, |span| span.start.min(text.len()));
        let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let source = NamedSource::new(&name, text.to_string());
        FileError::Wrong { name, line, found, text: Arc::new(source), span: span.map(SourceSpan::from), remedy }
    }

    /// An error that has no place in a text: of a folder, an option, a file as a whole.
    pub fn from_finding(what: &Path, found: String, remedy: String) -> FileError {
        FileError::Unfit { name: what.display().to_string(), found, remedy }
    }

    /// The error about a session or a recording that takes a part of the program which this build does not have.
    pub fn not_built(what: &Path, missing: NotBuilt) -> FileError {
        let instead = if missing.0 == Feature::Physics { "; or, for a new session, --arm timed" } else { "" };
        let remedy = format!("{}{instead}", missing.remedy());
        FileError::from_finding(what, format!("a session for another build; this one is {missing}"), remedy)
    }

    /// An error of a file that cannot be read or written.
    pub fn unreadable(path: &Path, reason: io::Error, remedy: &str) -> FileError {
        FileError::Unreadable { path: path.to_path_buf(), reason, remedy: remedy.to_string() }
    }
}

/// The error about a file that a session file names and that cannot be read: the path of the setting, which of them it is (0
/// the first), and the name of the file.
pub(super) fn missing(
    session: &Path,
    text: &str,
    (path, nth, file): (&str, usize, &str),
    reason: io::Error,
    remedy: &str,
) -> FileError {
    let key = path.rsplit('.').next().unwrap_or(path);
    let found = format!("{key} = \"{file}\", which cannot be read: {reason}");
    FileError::at(session, text, place_of(text, path, nth), found, remedy.to_string())
}

/// The text of a file.
pub fn read_text(path: &Path) -> FileResult<String> {
    std::fs::read_to_string(path)
        .map_err(|reason| FileError::unreadable(path, reason, "the path of a readable text file (UTF-8)"))
}
