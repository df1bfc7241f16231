//! The recording of a session: a folder with `session.toml` (the settings as they were in force) and `events.jsonl` (the
//! log: a header line, then one event a line; the only source of truth).

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::files::{FileError, FileResult, compile_kitchen};
use crate::base::time::SessionTime;
use crate::kitchen::Kitchen;
use crate::session::header::{FORMAT, VERSION};
use crate::session::{Event, Header, Stamped};

/// The name of the log in its folder.
pub const LOG_NAME: &str = "events.jsonl";
/// The name of the settings in the folder of a recording.
pub const SETTINGS_NAME: &str = "session.toml";
/// Gaze samples wait at most so long, in session time, before they are handed to the operating system.
const FLUSH_AFTER: SessionTime = SessionTime(50_000_000);

/// No line of a log is longer, in bytes: what is longer is no log.
const MAX_LINE: usize = 1 << 24;

/// The log could not be written: what was acknowledged before is there, nothing after it.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{}: the recording cannot be written: {reason}", path.display())]
#[diagnostic(help("a folder that can be written to, on a disk with free space"))]
pub struct WriteError {
    pub path: PathBuf,
    pub reason: io::Error,
}

/// Writes the log of a session.
#[derive(Debug)]
pub struct LogWriter {
    folder: PathBuf,
    path: PathBuf,
    out: BufWriter<File>,
    /// Hand events to the operating system as they come, because somebody relies on them.
    prompt: bool,
    flushed_at: SessionTime,
}

impl LogWriter {
    /// Starts a live recording `<date>-<participant>-<n>` in `root`, with the first n that is free. What is appended is
    /// handed to the operating system at once, gaze within 50 ms of session time or by [`LogWriter::flush`].
    pub fn create_live(root: &Path, date: &str, header: &Header) -> Result<LogWriter, WriteError> {
        let failed = |path: &Path, reason| WriteError { path: path.to_path_buf(), reason };
        fs::create_dir_all(root).map_err(|reason| failed(root, reason))?;
        let mut n = 1;
        loop {
            let folder = root.join(format!("{date}-{}-{n}", header.session.participant.code));
            match fs::create_dir(&folder) {
                Ok(()) => return LogWriter::begin(folder, header, true),
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => n += 1,
                Err(reason) => return Err(failed(&folder, reason)),
            }
        }
    }

    /// Starts a simulated recording in this folder. One that was simulated before is replaced; a live one never is.
    pub fn create_simulated(folder: &Path, header: &Header) -> Result<LogWriter, WriteError> {
        let failed = |reason| WriteError { path: folder.to_path_buf(), reason };
        fs::create_dir_all(folder).map_err(failed)?;
        if folder.join(LOG_NAME).exists() && LogReader::open(folder).is_ok_and(|log| log.header.started.is_some()) {
            let reason = "a live recording is there already";
            return Err(failed(io::Error::new(io::ErrorKind::AlreadyExists, reason)));
        }
        LogWriter::begin(folder.to_path_buf(), header, false)
    }

    fn begin(folder: PathBuf, header: &Header, prompt: bool) -> Result<LogWriter, WriteError> {
        let path = folder.join(LOG_NAME);
        let failed = |reason| WriteError { path: path.clone(), reason };
        let settings = toml::to_string(&header.session).map_err(|error| failed(io::Error::other(error)))?;
        fs::write(folder.join(SETTINGS_NAME), settings).map_err(failed)?;
        let file = OpenOptions::new().write(true).create(true).truncate(true).open(&path).map_err(failed)?;
        let mut out = BufWriter::with_capacity(1 << 16, file);
        write_line(&mut out, header).and_then(|()| out.flush()).map_err(failed)?;
        Ok(LogWriter { folder, path, out, prompt, flushed_at: SessionTime::ZERO })
    }

    /// The folder of the recording.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Adds an event.
    pub fn append(&mut self, stamped: &Stamped) -> Result<(), WriteError> {
        let written = write_line(&mut self.out, stamped);
        written.map_err(|reason| WriteError { path: self.path.clone(), reason })?;
        let waits = matches!(stamped.event, Event::Gaze(_)) && stamped.time - self.flushed_at < FLUSH_AFTER;
        if self.prompt && !waits {
            self.flushed_at = stamped.time;
            self.flush()?;
        }
        Ok(())
    }

    /// Hands everything to the operating system.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.out.flush().map_err(|reason| WriteError { path: self.path.clone(), reason })
    }
}

fn write_line(out: &mut impl Write, value: &impl serde::Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut *out, value)?;
    out.write_all(b"\n")
}

/// The line of the log for an event, without its end.
pub fn event_line(stamped: &Stamped) -> String {
    serde_json::to_string(stamped).expect("events have no maps with other keys than strings")
}

/// A line of the log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Counted from 1, the header's line.
    pub number: usize,
    pub text: String,
    pub stamped: Stamped,
}

/// Reads a log, line by line. A log that is still being written can be read on when it has grown.
#[derive(Debug)]
pub struct LogReader {
    pub path: PathBuf,
    pub header: Header,
    pub kitchen: Arc<Kitchen>,
    input: BufReader<File>,
    number: usize,
    next_seq: u64,
    /// A last line without its end: cut, or not yet written in full.
    partial: Vec<u8>,
    ended: bool,
}

impl LogReader {
    /// Opens a recording, by its folder or its log.
    ///
    /// # Errors
    /// No such file, another format or version, or a header that is broken.
    pub fn open(recording: &Path) -> FileResult<LogReader> {
        let path = if recording.is_dir() { recording.join(LOG_NAME) } else { recording.to_path_buf() };
        let remedy = "the folder of a recording, with its events.jsonl";
        let file = File::open(&path).map_err(|reason| FileError::unreadable(&path, reason, remedy))?;
        let mut input = BufReader::with_capacity(1 << 16, file);
        let mut line = Vec::new();
        let read = input.by_ref().take(MAX_LINE as u64).read_until(b'\n', &mut line);
        read.map_err(|reason| FileError::unreadable(&path, reason, remedy))?;
        let text = String::from_utf8_lossy(&line).into_owned();
        let header = read_header(&path, text.trim_end())?;
        let layout = (Path::new(&header.layout.path), header.layout.text.clone());
        let recipes = (Path::new(&header.recipes.path), header.recipes.text.clone());
        let kitchen = Arc::new(compile_kitchen(layout, recipes)?.kitchen);
        Ok(LogReader { path, header, kitchen, input, number: 1, next_seq: 0, partial: Vec::new(), ended: false })
    }

    /// The next event; `None` where the log ends for now.
    ///
    /// # Errors
    /// A line that is no event, or not the next one.
    pub fn next_line(&mut self) -> FileResult<Option<LogLine>> {
        let room = (MAX_LINE - self.partial.len()) as u64;
        let read = self.input.by_ref().take(room).read_until(b'\n', &mut self.partial);
        read.map_err(|reason| FileError::unreadable(&self.path, reason, "a readable recording"))?;
        if self.partial.last() != Some(&b'\n') {
            self.number += usize::from(self.partial.len() == MAX_LINE);
            return match self.partial.len() {
                MAX_LINE => Err(self.wrong("", 0, "a line without an end")),
                _ => Ok(None),
            };
        }
        self.partial.pop();
        self.number += 1;
        let bytes = std::mem::take(&mut self.partial);
        let text = String::from_utf8(bytes).map_err(|error| {
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            self.wrong(&text, error.utf8_error().valid_up_to(), "bytes that are no text (UTF-8)")
        })?;
        let stamped: Stamped = serde_json::from_str(&text)
            .map_err(|error| self.wrong(&text, error.column().saturating_sub(1), &json_message(&error)))?;
        if stamped.seq != self.next_seq {
            return Err(self.wrong(&text, 0, &format!("seq {} where {} comes next", stamped.seq, self.next_seq)));
        }
        self.next_seq += 1;
        self.ended = stamped.event == Event::SessionEnded;
        Ok(Some(LogLine { number: self.number, text, stamped }))
    }

    /// Whether what was read so far lacks the session's end.
    pub fn is_cut(&self) -> bool {
        !self.ended
    }

    fn wrong(&self, text: &str, column: usize, found: &str) -> FileError {
        let remedy = "one event of a tomcom log, numbered without gaps";
        at_line(&self.path, self.number, text, column, found.to_string(), remedy.to_string())
    }
}

/// An error in one line of a long file: the excerpt keeps the number of the line.
pub fn at_line(path: &Path, number: usize, text: &str, column: usize, found: String, remedy: String) -> FileError {
    let is_boundary = |index: &usize| text.is_char_boundary(*index);
    let column = (0..=column.min(text.len())).rev().find(is_boundary).unwrap_or(0);
    let start = (0..=column.saturating_sub(60)).rev().find(is_boundary).unwrap_or(0);
    let end = (column + 60..text.len()).find(is_boundary).unwrap_or(text.len());
    let before = "\n".repeat(number - 1);
    let excerpt = format!("{before}{}", &text[start..end]);
    let place = before.len() + column - start;
    FileError::at(path, &excerpt, Some(place..place), found, remedy)
}

/// What serde_json says, without the line and column within the one line that it saw.
fn json_message(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.split(" at line ").next().unwrap_or(&message).to_string()
}

fn read_header(path: &Path, text: &str) -> FileResult<Header> {
    let wrong = |column: usize, found: String, remedy: String| at_line(path, 1, text, column, found, remedy);
    let is_log = "a log written by tomcom: its first line is a header".to_string();
    let value: serde_json::Value = serde_json::from_str(text)
        .map_err(|error| wrong(error.column().saturating_sub(1), json_message(&error), is_log.clone()))?;
    if value.get("format").and_then(|format| format.as_str()) != Some(FORMAT) {
        return Err(wrong(0, "no header of a tomcom log".to_string(), is_log));
    }
    match value.get("version").and_then(|version| version.as_u64()) {
        Some(version) if version == u64::from(VERSION) => {}
        version => {
            let found = version.map_or("no format version".to_string(), |version| format!("format version {version}"));
            let remedy = format!("format version {VERSION}, or the tomcom that wrote the log");
            return Err(wrong(0, found, remedy));
        }
    }
    let header: Header = serde_json::from_str(text)
        .map_err(|error| wrong(error.column().saturating_sub(1), json_message(&error), is_log.clone()))?;
    match header.session.check() {
        Ok(()) => Ok(header),
        Err(error) => Err(wrong(text.find(error.key).unwrap_or(0), error.found, error.remedy.to_string())),
    }
}
