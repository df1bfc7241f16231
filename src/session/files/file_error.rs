//! Errors in files: which file, which line, what was found and what would be valid.

use std::fs::{self, File};
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};

use super::place::place_of;
use crate::features::{Feature, MissingFeature};
use tomcom_core::base::text::{printable, printable_lines};

/// Result of reading a file, with an error that explains what is wrong with the file.
pub type FileResult<T> = Result<T, FileError>;

/// An error of a file that the program reads or writes: unreadable, unsuitable as a whole, or invalid in one place.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum FileError {
    /// The file cannot be read at all.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// Path of the file that cannot be read.
        path: PathBuf,
        /// Why the file cannot be read.
        reason: io::Error,
        /// What a valid file would be.
        #[help]
        remedy: String,
    },
    /// The file cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// Path of the file or folder that cannot be written.
        path: PathBuf,
        /// Why the file or folder cannot be written.
        reason: io::Error,
        /// What a suitable name or place for the file would be.
        #[help]
        remedy: String,
    },
    /// A folder, a command-line option, or a file as a whole is unsuitable.
    #[error("{name}: found {found}")]
    Unfit {
        /// Name of the folder, option or file.
        name: String,
        /// What is wrong with the folder, option or file.
        found: String,
        /// What folder, option or file would be valid.
        #[help]
        remedy: String,
    },
    /// A text file is invalid in one place.
    #[error("{name}:{line}: found {found}")]
    Wrong {
        /// Name of the invalid file, as messages show it.
        name: String,
        /// Line of the error in the file, counted from 1.
        line: usize,
        /// What is wrong in that line of the file.
        found: String,
        /// Text of the file, for the excerpt in the message.
        #[source_code]
        text: Arc<NamedSource<String>>,
        /// Place of the error in the file's text, in bytes.
        #[label("here")]
        span: Option<SourceSpan>,
        /// What would be valid at this place of the file.
        #[help]
        remedy: String,
    },
}

impl FileError {
    /// An error at one place of a file's text. Control characters in the message are escaped.
    pub fn at(path: &Path, text: &str, span: Option<Range<usize>>, found: String, remedy: String) -> FileError {
        let name = name_of(path);
        let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let start = span.as_ref().map_or(0, |span| boundary(span.start));
        let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let span = span.map(|span| {
            let length = printable_lines(&text[start..boundary(span.end).max(start)]).len();
            SourceSpan::from((printable_lines(&text[..start]).len(), length))
        });
        let source = NamedSource::new(&name, printable_lines(text).into_owned());
        FileError::Wrong { name, line, found: one_line(found), text: Arc::new(source), span, remedy }
    }

    /// The error on one line with what would be right, for places that show no help below a message.
    pub fn with_remedy(&self) -> String {
        let (FileError::Unreadable { remedy, .. }
        | FileError::Unwritable { remedy, .. }
        | FileError::Unfit { remedy, .. }
        | FileError::Wrong { remedy, .. }) = self;
        format!("{self}; wanted: {remedy}")
    }

    /// An error of a folder, an option, or a file as a whole, for which no line can be named.
    pub fn from_finding(what: &Path, found: String, remedy: String) -> FileError {
        FileError::Unfit { name: name_of(what), found: one_line(found), remedy }
    }

    /// The error about a session or a recording that needs an optional part of the program which this build lacks.
    pub fn not_built(what: &Path, missing: MissingFeature) -> FileError {
        let instead = if missing.0 == Feature::Physics { "; or, for a new session, --arm timed" } else { "" };
        let remedy = format!("{}{instead}", missing.remedy());
        FileError::from_finding(
            what,
            format!(
                "a session that needs another build of tomcom; this build is \
                                               {missing}"
            ),
            remedy,
        )
    }

    /// The error about a file that cannot be read.
    pub fn unreadable(path: &Path, reason: io::Error, remedy: &str) -> FileError {
        FileError::Unreadable { path: path.to_path_buf(), reason, remedy: remedy.to_string() }
    }

    /// The error about an output file, whose name the user chose, that cannot be written.
    pub fn unwritable(path: &Path, reason: io::Error) -> FileError {
        FileError::not_written(path, reason, "give another name for the file, in a folder that can be written to")
    }

    /// The error about a file or folder that cannot be written, with what would be right in its place.
    pub fn not_written(path: &Path, reason: io::Error, remedy: &str) -> FileError {
        FileError::Unwritable { path: path.to_path_buf(), reason, remedy: remedy.to_string() }
    }
}

/// The error about a file that a session file names and that cannot be read. Arguments are the dotted path of the
/// setting that names the file, the index among settings with this path (0 is the first), and the file's name.
pub fn missing(
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

fn name_of(path: &Path) -> String {
    one_line(path.display().to_string())
}

fn one_line(text: String) -> String {
    printable(&text).into_owned()
}

/// Largest size of a file that people write, and of a file that is read as a whole, in bytes.
pub const MAX_TEXT: u64 = 16 << 20;

/// Opens a regular file for reading. Pipes and devices are refused, since they may never end, and opening a pipe could
/// block forever.
///
/// # Errors
/// The file does not exist, cannot be opened, or is no regular file.
pub fn open_regular(path: &Path) -> io::Result<File> {
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file, but a pipe, device or folder"))
        }
    }
}

/// Reads a regular file as a whole.
///
/// # Errors
/// The errors of [`open_regular`], or the file has more than `most` bytes.
pub fn read_bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {} MB", most >> 20)));
    }
    Ok(bytes)
}

/// Reads the text of a regular file of at most [`MAX_TEXT`] bytes: settings, notes, decisions.
///
/// # Errors
/// The errors of [`read_bytes`], or the file is not UTF-8.
pub fn read_regular(path: &Path) -> io::Result<String> {
    let bytes = read_bytes(path, MAX_TEXT)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

/// Reads the text of a file that people write, as [`read_regular`] does.
pub fn read_text(path: &Path) -> FileResult<String> {
    read_regular(path).map_err(|reason| FileError::unreadable(path, reason, "the path of a readable text file (UTF-8)"))
}
