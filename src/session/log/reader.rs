//! Reader of recordings, including recordings that are still being written and recordings that consist of several
//! parts.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::apply::ApplyError;
use crate::files::compile_kitchen;
use crate::files::file_error::{FileError, FileResult, open_regular};
use crate::header::{FORMAT, PreviousPart, VERSION};
use crate::log::decisions::correct_header;
use crate::log::lock::is_same;
use crate::log::{LOG_NAME, RecordingLock};
use crate::settings::SettingError;
use crate::{Event, LogHeader, Session, TimestampedEvent};
use tomcom_core::kitchen::Kitchen;

/// In bytes; a file with a longer line is no log.
pub const MAX_LINE: usize = 1 << 24;
/// Number of bytes at a log's end among which the last event is searched.
const TAIL: u64 = 1 << 16;
const MAX_PARTS: usize = 100;

#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// In its file, from 1; line 1 is the header.
    pub number: usize,
    /// Without its line end.
    pub text: String,
    pub stamped: TimestampedEvent,
}

/// From which events of a recording can be read again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogPlace {
    path: Arc<Path>,
    /// Number of bytes of the file before the event's line.
    offset: u64,
}

impl LogPlace {
    pub fn is_in_file_of(&self, other: &LogPlace) -> bool {
        self.path == other.path
    }

    /// Reads this number of events again, all of one file; an error if the file has changed.
    pub fn read_again(&self, number: usize) -> FileResult<Vec<TimestampedEvent>> {
        let unreadable =
            |reason| FileError::unreadable(&self.path, reason, "the recording as it was when it was opened");
        let mut file = open_regular(&self.path).map_err(unreadable)?;
        file.seek(SeekFrom::Start(self.offset)).map_err(unreadable)?;
        let mut input = BufReader::with_capacity(1 << 16, file);
        let mut line = Vec::new();
        let mut read = || {
            line.clear();
            input.by_ref().take(MAX_LINE as u64).read_until(b'\n', &mut line).map_err(unreadable)?;
            serde_json::from_slice(&line).map_err(|error| unreadable(io::Error::new(io::ErrorKind::InvalidData, error)))
        };
        (0..number).map(|_| read()).collect()
    }
}

/// As far as its events have been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogEnding {
    Closed,
    /// A program is still writing, so more events will come.
    Running,
    /// The session's end is missing, and no program is writing.
    Cut,
}

/// Reads a log line by line, after the earlier parts that the log continues. Reading can go on when a log that is still
/// being written has grown.
#[derive(Debug)]
pub struct LogReader {
    /// Of this part of the recording.
    pub header: LogHeader,
    pub kitchen: Arc<Kitchen>,
    path: Arc<Path>,
    /// Number of bytes of the file before the next line.
    offset: u64,
    /// The previous part, until all of its continued events are read.
    before: Option<Box<LogReader>>,
    input: BufReader<File>,
    number: usize,
    next_seq: u64,
    /// A last line that was cut off, or is not yet written completely.
    partial: Vec<u8>,
    /// Number of the first empty line since the last event. At the end of a log such lines are no damage: an editor or
    /// a copy can add them.
    blank: Option<usize>,
    ended: bool,
    /// Whether the session's end is left out.
    without_end: bool,
}

impl LogReader {
    /// Opens a recording by its folder or its log, to be read from its first part on. It is an error if a log has
    /// another format or version or a damaged header, or if an earlier part is missing.
    pub fn open(recording: &Path) -> FileResult<LogReader> {
        LogReader::open_part(recording, MAX_PARTS)
    }

    fn open_part(recording: &Path, parts: usize) -> FileResult<LogReader> {
        let path = if recording.is_dir() { recording.join(LOG_NAME) } else { recording.to_path_buf() };
        let remedy = "the folder of a recording, with its events.jsonl";
        let file = open_regular(&path).map_err(|reason| FileError::unreadable(&path, reason, remedy))?;
        let mut input = BufReader::with_capacity(1 << 16, file);
        let line = first_line(&mut input).map_err(|reason| FileError::unreadable(&path, reason, remedy))?;
        if ends_in_header(&line) {
            let found = "a log that ends before the end of its header, which happens in a power failure".to_string();
            let remedy = "a recording with a whole header; tomcom simulate makes a simulated recording again";
            return Err(at_line(&path, 1, &String::from_utf8_lossy(&line), line.len(), found, remedy));
        }
        let text = String::from_utf8_lossy(&line).into_owned();
        let text = text.trim_end();
        let header = read_header(&path, text)?;
        let before = match &header.continues {
            Some(before) => Some(Box::new(open_before(&path, text, &header, before, parts)?)),
            None => None,
        };
        let next_seq = header.continues.as_ref().map_or(0, |before| before.events);
        let layout = (Path::new(&header.layout.path), header.layout.text.clone());
        let recipes = (Path::new(&header.recipes.path), header.recipes.text.clone());
        let kitchen = Arc::new(compile_kitchen(layout, recipes)?.kitchen);
        header.session.check_kitchen(&kitchen).map_err(|error| wrong_setting(&path, text, error))?;
        Ok(LogReader {
            header,
            kitchen,
            path: Arc::from(path),
            offset: line.len() as u64,
            before,
            input,
            number: 1,
            next_seq,
            partial: Vec::new(),
            blank: None,
            ended: false,
            without_end: false,
        })
    }

    /// Leaves the session's end out, as for a part that takes its place.
    pub fn without_end(self) -> LogReader {
        LogReader { without_end: true, ..self }
    }

    /// Before its first event.
    pub fn session(&self) -> Session {
        Session::new(self.kitchen.clone(), self.header.session.clone(), self.header.trial)
    }

    /// `None` where the log ends at present.
    pub fn next_line(&mut self) -> FileResult<Option<LogLine>> {
        if let Some(before) = self.before.as_mut().filter(|before| before.events() < self.next_seq) {
            let line = before.next_line()?;
            let (found, wanted) = (before.events(), self.next_seq);
            return line.map(Some).ok_or_else(|| {
                let found = format!(
                    "the log's end after {found} events, although a later part continues it after {wanted} events"
                );
                before.wrong("", 0, &found)
            });
        }
        self.before = None;
        loop {
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
            self.offset += self.partial.len() as u64;
            self.partial.pop();
            self.number += 1;
            let bytes = std::mem::take(&mut self.partial);
            match self.blank {
                _ if is_blank(&bytes) => self.blank = self.blank.or(Some(self.number)),
                Some(number) => {
                    self.number = number;
                    return Err(self.wrong("", 0, "an empty line before another event"));
                }
                None => return self.event_of(bytes),
            }
        }
    }

    /// The event of a line; `None` for an end of the session that is left out.
    fn event_of(&mut self, bytes: Vec<u8>) -> FileResult<Option<LogLine>> {
        let text = String::from_utf8(bytes).map_err(|error| {
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            self.wrong(&text, error.utf8_error().valid_up_to(), "bytes that are no text (UTF-8)")
        })?;
        let stamped: TimestampedEvent = serde_json::from_str(&text)
            .map_err(|error| self.wrong(&text, error.column().saturating_sub(1), &json_message(&error)))?;
        if stamped.seq != self.next_seq {
            let found = format!("an event with seq {}, where seq {} comes next", stamped.seq, self.next_seq);
            return Err(self.wrong(&text, 0, &found));
        }
        self.ended = stamped.event == Event::SessionEnded;
        if self.ended && self.without_end {
            return Ok(None);
        }
        self.next_seq += 1;
        Ok(Some(LogLine { number: self.number, text, stamped }))
    }

    /// The last complete event of this part, wherever the reader is; `None` if none can be read. An invalid line is
    /// reported when the reader reaches it.
    pub fn last_event(&self) -> FileResult<Option<TimestampedEvent>> {
        let unreadable = |reason| FileError::unreadable(&self.path, reason, "a readable recording");
        let mut file = open_regular(&self.path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut tail = Vec::new();
        file.seek(SeekFrom::Start(length.saturating_sub(TAIL))).map_err(unreadable)?;
        file.take(TAIL).read_to_end(&mut tail).map_err(unreadable)?;
        let mut lines = tail.split(|&byte| byte == b'\n').rev();
        // After the last line end comes nothing, or a line that is not complete.
        lines.next();
        Ok(lines.find(|line| !is_blank(line)).and_then(|line| serde_json::from_slice(line).ok()))
    }

    /// Whether the log is still at its path: an open file can be read even after it was deleted, but nothing is added
    /// to it any more.
    pub fn check_there(&self) -> FileResult<()> {
        if is_same(self.input.get_ref(), &self.path) {
            return Ok(());
        }
        let found = match self.path.exists() {
            true => "another file in the place of the log that was followed",
            false => "no log any more: it was removed or moved while it was followed",
        };
        let remedy = "the folder in which the recording is now, if its session goes on; the session's own console says where \
                      what was recorded is saved";
        Err(FileError::from_finding(&self.path, found, remedy))
    }

    /// Whether the events read so far lack the session's end.
    pub fn is_cut(&self) -> bool {
        !self.ended
    }

    pub fn ending(&self) -> LogEnding {
        match (self.ended, RecordingLock::holder(self.folder())) {
            (true, _) => LogEnding::Closed,
            (false, Some(_)) => LogEnding::Running,
            (false, None) => LogEnding::Cut,
        }
    }

    /// Of all parts, the first one first; to be called before any event was read.
    pub fn logs(&self) -> Vec<PathBuf> {
        let mut logs = self.before.as_ref().map_or_else(Vec::new, |before| before.logs());
        logs.push(self.path.to_path_buf());
        logs
    }

    /// Headers of all parts, the last one first; to be called before any event was read.
    pub fn headers(&self) -> impl Iterator<Item = &LogHeader> {
        std::iter::successors(Some(self), |part| part.before.as_deref()).map(|part| &part.header)
    }

    /// Of the next event.
    pub fn place(&self) -> LogPlace {
        match self.before.as_ref().filter(|before| before.events() < self.next_seq) {
            Some(before) => before.place(),
            None => LogPlace { path: self.path.clone(), offset: self.offset },
        }
    }

    /// Number of events read so far.
    pub fn events(&self) -> u64 {
        self.before.as_ref().map_or(self.next_seq, |before| before.events())
    }

    /// The file that contains the last line read.
    pub fn path(&self) -> &Path {
        self.before.as_ref().map_or(&self.path, |before| before.path())
    }

    /// The log that was opened; of several parts, the last one's.
    pub fn path_of_last_part(&self) -> &Path {
        &self.path
    }

    /// Of the opened recording; of several parts, the last one's.
    pub fn folder(&self) -> &Path {
        self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// The session refused the event in this line.
    pub fn refused(&self, line: &LogLine, error: ApplyError) -> FileError {
        at_line(self.path(), line.number, &line.text, 0, error.found, error.remedy)
    }

    fn wrong(&self, text: &str, column: usize, found: &str) -> FileError {
        let remedy = "one event of a tomcom log, numbered without gaps; an analysis goes on without the recording after tomcom \
                      exclude RECORDING --reason …";
        at_line(&self.path, self.number.max(1), text, column, found.to_string(), remedy)
    }
}

fn open_before(
    path: &Path,
    text: &str,
    header: &LogHeader,
    before: &PreviousPart,
    parts: usize,
) -> FileResult<LogReader> {
    let wrong = |found: String, remedy: &str| {
        let column = text.find("\"continues\"").unwrap_or(0);
        at_line(path, 1, text, column, found, remedy)
    };
    let name = &before.recording;
    let is_name = !name.is_empty() && name != ".." && name != "." && !name.contains(['/', '\\']);
    if !is_name {
        return Err(wrong(format!("continues \"{name}\""), "the name of a folder beside this one"));
    }
    if parts == 0 {
        let remedy = "parts of a recording that lead back to a first part";
        return Err(wrong(format!("more than {MAX_PARTS} parts"), remedy));
    }
    // The path is resolved, so that the folder of the previous part is also found from a path like `.`.
    let log = path.canonicalize().map_err(|reason| FileError::unreadable(path, reason, "a readable recording"))?;
    let beside = log.parent().and_then(Path::parent).unwrap_or(Path::new("."));
    let beside = match path.parent().and_then(Path::parent) {
        // If possible, messages show the path as the user typed it, because that path is shorter.
        Some(typed) if typed.join(name).exists() => typed,
        _ => beside,
    };
    let folder = beside.join(name);
    if !folder.join(LOG_NAME).exists() {
        let found = format!("a part that continues {name}, a recording that is not there");
        return Err(wrong(found, "that recording, in a folder beside this"));
    }
    let first = LogReader::open_part(&folder, parts - 1)?;
    let same = |other: &LogHeader| {
        (&other.session, &other.layout, &other.recipes, &other.keys, other.trial, other.version)
            == (&header.session, &header.layout, &header.recipes, &header.keys, header.trial, header.version)
    };
    match same(&first.header) {
        true => Ok(first),
        false => Err(wrong(format!("a part of another session than that of {name}"), "the session that it continues")),
    }
}

pub(super) fn is_blank(line: &[u8]) -> bool {
    line.trim_ascii().is_empty()
}

/// Whether the first line of a log is what a power failure leaves of a header: nothing, zeros, or the beginning of a
/// header.
pub(super) fn ends_in_header(line: &[u8]) -> bool {
    let begins = format!("{{\"format\":\"{FORMAT}\"");
    let is_begun = line.iter().zip(begins.as_bytes()).all(|(there, ours)| there == ours);
    line.last() != Some(&b'\n') && (is_begun || line.iter().all(|&byte| byte == 0))
}

/// Including its line end if it has one.
pub fn first_line(log: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    log.take(MAX_LINE as u64).read_until(b'\n', &mut line).map(|_| line)
}

/// That of the log in this file.
pub(super) fn first_line_of(path: &Path) -> io::Result<Vec<u8>> {
    open_regular(path).and_then(|file| first_line(&mut BufReader::new(file)))
}

/// An error in one line of a long file; the excerpt in the message keeps the line's number.
pub fn at_line(
    path: &Path,
    number: usize,
    text: &str,
    column: usize,
    found: String,
    remedy: impl Into<String>,
) -> FileError {
    let is_boundary = |index: &usize| text.is_char_boundary(*index);
    let column = (0..=column.min(text.len())).rev().find(is_boundary).unwrap_or(0);
    let start = (0..=column.saturating_sub(60)).rev().find(is_boundary).unwrap_or(0);
    let end = (column + 60..text.len()).find(is_boundary).unwrap_or(text.len());
    let before = "\n".repeat(number - 1);
    let excerpt = format!("{before}{}", &text[start..end]);
    let place = before.len() + column - start;
    FileError::at(path, &excerpt, Some(place..place), found, remedy)
}

/// Without line and column, which would refer to the single line that was parsed.
fn json_message(error: &serde_json::Error) -> String {
    let message = error.to_string();
    message.split(" at line ").next().unwrap_or(&message).to_string()
}

/// Every reader of a recording gets the participant's code from here, as corrections beside the log say it.
pub fn read_header(path: &Path, text: &str) -> FileResult<LogHeader> {
    let wrong = |column: usize, found: String, remedy: String| at_line(path, 1, text, column, found, remedy);
    let is_log = "the folder of a recording, or the events.jsonl in it, as tomcom wrote it".to_string();
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| match text.contains(FORMAT) {
        true => wrong(error.column().saturating_sub(1), json_message(&error), is_log.clone()),
        false => wrong(0, "a file that is no log of a session".to_string(), is_log.clone()),
    })?;
    if value.get("format").and_then(|format| format.as_str()) != Some(FORMAT) {
        return Err(wrong(0, "no header of a tomcom log".to_string(), is_log));
    }
    match value.get("version").and_then(|version| version.as_u64()) {
        Some(version) if version == u64::from(VERSION) => {}
        version => {
            let found = version.map_or("no format version".to_string(), |version| format!("format version {version}"));
            let program = value.get("program").and_then(|program| program.as_str());
            let program = program.map_or(String::new(), |program| format!(" {program}"));
            let remedy = format!("format version {VERSION}, or the tomcom{program} that wrote the log");
            return Err(wrong(0, found, remedy));
        }
    }
    let mut header: LogHeader = serde_json::from_str(text)
        .map_err(|error| wrong(error.column().saturating_sub(1), json_message(&error), is_log.clone()))?;
    header.session.check().map_err(|error| wrong_setting(path, text, error))?;
    correct_header(path.parent().unwrap_or(Path::new("")), &mut header)?;
    Ok(header)
}

fn wrong_setting(path: &Path, header: &str, error: SettingError) -> FileError {
    at_line(path, 1, header, header.find(error.key()).unwrap_or(0), error.found, error.remedy.into_owned())
}
