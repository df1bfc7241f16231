//! Errors in files: which file, which line, what was found and what would be valid.

use std::fs::{self, File};
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};
use toml::de::{DeTable, DeValue};

use crate::features::{Feature, MissingFeature};
use crate::files::{carried, near_path};
use tomcom_core::base::text::{printable, printable_lines};

pub type FileResult<T> = Result<T, FileError>;

/// Boxed, so that results stay small.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error(transparent)]
#[diagnostic(transparent)]
pub struct FileError(Box<FileFault>);

#[derive(Debug, thiserror::Error, Diagnostic)]
enum FileFault {
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        path: PathBuf,
        reason: String,
        #[help]
        remedy: String,
    },
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        path: PathBuf,
        reason: io::Error,
        #[help]
        remedy: String,
    },
    /// A folder, a command-line option, or a file as a whole is unsuitable.
    #[error("{name}: found {found}")]
    Unfit {
        name: String,
        found: String,
        #[help]
        remedy: String,
    },
    /// A text file is invalid in one place.
    #[error("{name}:{line}: found {found}")]
    Wrong {
        name: String,
        /// From 1.
        line: usize,
        found: String,
        /// For the excerpt in the message.
        #[source_code]
        text: Arc<NamedSource<String>>,
        /// In bytes.
        #[label("here")]
        span: Option<SourceSpan>,
        #[help]
        remedy: String,
    },
}

impl From<FileFault> for FileError {
    fn from(fault: FileFault) -> FileError {
        FileError(Box::new(fault))
    }
}

impl FileError {
    /// An error at one place of a file's text. Control characters in the message are escaped.
    pub fn at(
        path: &Path,
        text: &str,
        span: Option<Range<usize>>,
        found: String,
        remedy: impl Into<String>,
    ) -> FileError {
        let name = name_of(path);
        let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
        let start = span.as_ref().map_or(0, |span| boundary(span.start));
        let line = text.as_bytes()[..start].iter().filter(|&&byte| byte == b'\n').count() + 1;
        let span = span.map(|span| {
            let length = printable_lines(&text[start..boundary(span.end).max(start)]).len();
            SourceSpan::from((printable_lines(&text[..start]).len(), length))
        });
        let source = NamedSource::new(&name, printable_lines(text).into_owned());
        let (found, text, remedy) = (one_line(found), Arc::new(source), remedy.into());
        FileFault::Wrong { name, line, found, text, span, remedy }.into()
    }

    pub fn remedy(&self) -> &str {
        let (FileFault::Unreadable { remedy, .. }
        | FileFault::Unwritable { remedy, .. }
        | FileFault::Unfit { remedy, .. }
        | FileFault::Wrong { remedy, .. }) = &*self.0;
        remedy
    }

    /// On one line with its remedy, for places that show no help below a message.
    pub fn with_remedy(&self) -> String {
        format!("{self}; wanted: {}", self.remedy())
    }

    /// An error of a folder, an option, or a file as a whole, for which no line can be named.
    pub fn from_finding(what: &Path, found: impl Into<String>, remedy: impl Into<String>) -> FileError {
        FileFault::Unfit { name: name_of(what), found: one_line(found.into()), remedy: remedy.into() }.into()
    }

    /// A session or a recording needs an optional part which this build lacks.
    pub fn not_built(what: &Path, missing: MissingFeature) -> FileError {
        let instead = if matches!(missing.0, Feature::Physics | Feature::Ur) {
            "; or, for a new session, --arm timed"
        } else {
            ""
        };
        let found = format!("a session that needs another build of tomcom; this build is {missing}");
        FileError::from_finding(what, found, format!("{}{instead}", missing.remedy()))
    }

    pub fn unreadable(path: &Path, reason: io::Error, remedy: &str) -> FileError {
        let reason = format!("{reason}{}", near_path::did_you_mean(path, Path::new("")));
        FileFault::Unreadable { path: path.to_path_buf(), reason, remedy: remedy.to_string() }.into()
    }

    /// An output file whose name the user chose.
    pub fn unwritable(path: &Path, reason: io::Error) -> FileError {
        FileError::not_written(path, reason, "give another name for the file, in a folder that can be written to")
    }

    pub fn not_written(path: &Path, reason: io::Error, remedy: &str) -> FileError {
        FileFault::Unwritable { path: path.to_path_buf(), reason, remedy: remedy.to_string() }.into()
    }
}

/// A file that a session file names cannot be read. The setting that names it: its dotted path, its index among
/// settings with this path (from 0), and its value.
pub fn missing(
    session: &Path,
    text: &str,
    (path, nth, file): (&str, usize, &str),
    reason: io::Error,
    remedy: &str,
) -> FileError {
    let key = path.rsplit('.').next().unwrap_or(path);
    let folder = session.parent().unwrap_or(Path::new("."));
    let near = near_path::did_you_mean(&folder.join(file), folder);
    let found = format!("{key} = \"{file}\", which cannot be read: {reason}{near}");
    FileError::at(session, text, place_of(text, path, nth), found, remedy)
}

fn name_of(path: &Path) -> String {
    one_line(path.display().to_string())
}

fn one_line(text: String) -> String {
    printable(&text).into_owned()
}

/// Largest size of a file that people write, and of a file that is read as a whole, in bytes.
pub const MAX_TEXT: u64 = 16 << 20;

/// Opens a regular file. Pipes and devices are refused: they may never end, and opening a pipe could block forever.
pub fn open_regular(path: &Path) -> io::Result<File> {
    match fs::metadata(path)?.is_file() {
        true => File::open(path),
        false => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "it is no regular file, but a pipe, device or folder"))
        }
    }
}

/// Reads a regular file of at most `most` bytes.
pub fn read_bytes(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it has more than {} MB", most >> 20)));
    }
    Ok(bytes)
}

/// Reads the text (UTF-8) of a regular file of at most [`MAX_TEXT`] bytes: settings, notes, decisions.
pub fn read_regular(path: &Path) -> io::Result<String> {
    let bytes = read_bytes(path, MAX_TEXT)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error()))
}

/// Reads the text of a file that people write, as [`read_regular`] does, or of one that the program carries.
pub fn read_text(path: &Path) -> FileResult<String> {
    carried::read(path).map_err(|reason| {
        let remedy = match reason.kind() == io::ErrorKind::NotFound && carried::has(path) {
            true => carried::REMEDY,
            false => "the path of a readable text file (UTF-8)",
        };
        FileError::unreadable(path, reason, remedy)
    })
}

/// Byte range of the `nth` setting (from 0) with this dotted path in a TOML text, outermost table first:
/// "rerun.address". Inner tables may be left out: "human.tau". `None` if the text has no such setting.
pub fn place_of(text: &str, path: &str, nth: usize) -> Option<Range<usize>> {
    let document = DeTable::parse(text).ok()?;
    let names: Vec<&str> = path.split('.').collect();
    let mut places = Vec::new();
    collect(document.get_ref(), &names, &mut places);
    places.sort_by_key(|place| place.start);
    places.into_iter().nth(nth)
}

fn collect(table: &DeTable, names: &[&str], places: &mut Vec<Range<usize>>) {
    let Some((first, rest)) = names.split_first() else { return };
    for (name, value) in table {
        let is_it = name.get_ref() == first;
        if is_it && rest.is_empty() {
            places.push(name.span().start..name.span().end.max(value.span().end));
            continue;
        }
        within(value.get_ref(), if is_it { rest } else { names }, places);
    }
}

fn within(value: &DeValue, names: &[&str], places: &mut Vec<Range<usize>>) {
    match value {
        DeValue::Table(table) => collect(table, names, places),
        DeValue::Array(values) => values.iter().for_each(|value| within(value.get_ref(), names, places)),
        _ => {}
    }
}
