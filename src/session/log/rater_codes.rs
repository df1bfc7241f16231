//! The file `codes-RATER.csv` beside a log: the codes that one rater gave to the errors in the log. The log itself is
//! not changed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::files::file_error::{FileError, FileResult, MAX_TEXT, open_regular, read_bytes};
use crate::files::{overwrite, replace_file};
use crate::log::RecordingWriteError;
use crate::person_code;
use tomcom_core::base::text::{SEPARATORS, count, did_you_mean};
use tomcom_core::measures::raters::{CodableErrors, ErrorCauseCode, ErrorCauseKind, RaterCodes};

/// Of one rater's file, which says whose codes it has, since its name can change when it is copied; an export has one
/// column more before these.
const COLUMNS: [&str; 4] = ["rater", "press", "cause", "aspect"];
pub const EXPORT_COLUMNS: [&str; 5] = ["recording", "rater", "press", "cause", "aspect"];
const KEEP_ONE: &str =
    "one file for each rater: compare the two, keep the codes that hold, and move the other file elsewhere";
/// In bytes; the line with the columns of a table is much shorter.
const LONGEST_HEAD: usize = 400;
const EXPORTED: &str = "a table that tomcom codes RECORDING --export wrote, or an annotated .eaf or .boris file";
const OWN_FILE: &str = "the table that tomcom codes RECORDING --export TABLE makes of such files; or put this file, with its name, into the \
                        folder of its recording";
const REMEDY: &str = "as many fields as the first line has";
const SPREADSHEETS: [&str; 4] = [".xlsx", ".xls", ".ods", ".numbers"];

/// Of an export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RaterCodeRow {
    /// For error messages.
    pub line: usize,
    /// Name of the recording's folder.
    pub recording: String,
    pub rater: String,
    /// Sequence number of the press that was an error.
    pub press: u64,
    pub code: ErrorCauseCode,
}

/// The rater is named in each of its rows.
struct CodeFile {
    path: PathBuf,
    text: String,
    rows: Vec<ParsedRow>,
}

/// `codes-R1.csv`, and how people, file managers, browsers and sync programs name copies of it.
pub fn is_codes_file(name: &str) -> bool {
    is_named_as_codes(name, &[".csv"])
}

/// Whether the name of a file with one of these endings is, or was made of, `codes-RATER`; `codes.csv` is an export.
fn is_named_as_codes(name: &str, endings: &[&str]) -> bool {
    let name = name.to_ascii_lowercase();
    let rest = name.strip_prefix("codes").or_else(|| name.split_once(" codes").map(|(_, rest)| rest)).unwrap_or("");
    let named = rest.trim_start_matches(['-', '_', ' ']);
    let is_separate = rest.len() > named.len();
    let is_rater = rest.starts_with('-') || named.starts_with(|first: char| first.is_ascii_alphanumeric());
    is_separate && is_rater && endings.iter().any(|ending| name.ends_with(ending))
}

/// Files with raters' codes by their names, or by their first lines; an error if codes were saved as a spreadsheet.
pub(crate) fn code_file_names(folder: &Path) -> FileResult<BTreeSet<String>> {
    let unreadable = |reason| FileError::unreadable(folder, reason, "the folder of a recording");
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let name = entry.map_err(unreadable)?.file_name().to_string_lossy().into_owned();
        if is_named_as_codes(&name, &SPREADSHEETS) {
            let found = "what looks like the codes of a rater in a spreadsheet's file, which is not read";
            let remedy = "the table saved as CSV (UTF-8) under the name codes-RATER.csv, and this file moved elsewhere";
            return Err(FileError::from_finding(&folder.join(name), found, remedy));
        }
        let is_renamed = || name.to_ascii_lowercase().ends_with(".csv") && is_one_raters(&folder.join(&name));
        if is_codes_file(&name) || is_renamed() {
            names.insert(name);
        }
    }
    Ok(names)
}

fn is_one_raters(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = open_regular(path).and_then(|file| file.take(64).read_to_end(&mut head));
    read.is_ok() && overwrite::first_line(&head) == COLUMNS.join(",").as_bytes()
}

/// Both raters whom the user named must be among those who have coded.
pub fn check_named(what: &Path, named: &[String; 2], raters: &BTreeSet<String>) -> FileResult<()> {
    let Some(missing) = named.iter().find(|rater| !raters.contains(*rater)) else { return Ok(()) };
    let known: Vec<&str> = raters.iter().map(String::as_str).collect();
    let remedy = match known.is_empty() {
        true => "two raters who have coded the errors, each with tomcom replay RECORDING --rater CODE".to_string(),
        false => format!("two raters who have coded the errors; there are codes of {}", known.join(", ")),
    };
    let found = format!("no codes of the rater {missing}{}", person_code::did_you_mean(missing, known));
    Err(FileError::from_finding(what, found, remedy))
}

/// By the rater whom each file names inside; files without a row are nobody's.
fn code_files(folder: &Path) -> FileResult<BTreeMap<String, CodeFile>> {
    let names = code_file_names(folder)?;
    let mut files: BTreeMap<String, CodeFile> = BTreeMap::new();
    for name in &names {
        let path = folder.join(name);
        let read = read_bytes(&path, MAX_TEXT);
        let bytes = read.map_err(|reason| FileError::unreadable(&path, reason, "a readable text file (UTF-8)"))?;
        let text = text_of(&path, bytes)?;
        let rows = rows(&path, &text, &COLUMNS)?;
        let Some((first, before, ..)) = rows.first() else { continue };
        let (first, rater) = (*first, before[0].clone());
        let wrong = |line: usize, found: String, remedy: &str| Err(wrong_line(&path, &text, line, found, remedy));
        if let Some(fault) = person_code::fault(&rater) {
            return wrong(first, format!("the rater \"{rater}\": {fault}"), person_code::REMEDY);
        }
        if let Some((line, before, ..)) = rows.iter().find(|(_, before, ..)| before[0] != rater) {
            let found = format!("codes of {}, after codes of {rater}", before[0]);
            let remedy = "codes of one rater; a table of several raters: tomcom codes RECORDING --import";
            return wrong(*line, found, remedy);
        }
        let own = file_name(&rater);
        if *name != own {
            let (what, remedy) = match names.contains(&own) {
                true => (format!("codes of {rater}, of whom {own} has codes, too"), KEEP_ONE.to_string()),
                false => (
                    format!("codes of {rater}, in a file with another name"),
                    format!("the name {own}, so that {rater} goes on in this file: rename it"),
                ),
            };
            return Err(FileError::from_finding(&path, what, remedy));
        }
        if let Some(other) = person_code::differing_in_case(&rater, files.keys().map(String::as_str)) {
            let found = format!("codes of {rater}, beside codes of {other}");
            return Err(FileError::from_finding(&path, found, "one rater: rename the file, and the rater in it"));
        }
        files.insert(rater, CodeFile { path, text, rows });
    }
    Ok(files)
}

/// It is an error if a rater has two files.
pub fn raters(folder: &Path) -> FileResult<BTreeSet<String>> {
    Ok(code_files(folder)?.into_keys().collect())
}

/// By rater; an error if a file has what cannot be about this recording.
pub fn read_all(folder: &Path, codable: &CodableErrors) -> FileResult<BTreeMap<String, RaterCodes>> {
    let mut all = BTreeMap::new();
    for (rater, CodeFile { path, text, rows }) in code_files(folder)? {
        let mut codes = RaterCodes::default();
        for (line, _, press, code) in rows {
            if let Some((found, remedy)) = codable.fault(press, &code) {
                return Err(wrong_line(&path, &text, line, found, &remedy));
            }
            codes.0.insert(press, code);
        }
        all.insert(rater, codes);
    }
    Ok(all)
}

/// Programs that read the file meanwhile find the old one or the new one.
pub fn write(folder: &Path, rater: &str, codes: &RaterCodes) -> Result<(), RecordingWriteError> {
    let path = folder.join(file_name(rater));
    let row = |(press, code): (&u64, &ErrorCauseCode)| {
        let [cause, aspect] = cells(code);
        [rater.to_string(), press.to_string(), cause, aspect]
    };
    let written = table_bytes(COLUMNS, codes.0.iter().map(row)).and_then(|bytes| replace_file::replace(&path, &bytes));
    written.map_err(|reason| RecordingWriteError::unwritable(&path, reason))
}

/// Cause and aspect of a code.
pub(super) fn cells(code: &ErrorCauseCode) -> [String; 2] {
    [code.kind().name().to_string(), code.aspect().unwrap_or_default().to_string()]
}

/// A table with these columns and rows, as CSV.
pub(super) fn table_bytes<const N: usize>(
    columns: [&str; N],
    rows: impl Iterator<Item = [String; N]>,
) -> io::Result<Vec<u8>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(columns)?;
    for row in rows {
        table.write_record(row)?;
    }
    table.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

pub fn read_export(path: &Path) -> FileResult<(String, Vec<RaterCodeRow>)> {
    let bytes = read_bytes(path, MAX_TEXT);
    let bytes =
        bytes.map_err(|reason| FileError::unreadable(path, reason, "the path of a readable text file (UTF-8)"))?;
    let head = overwrite::first_line(&bytes);
    let wrong = |found: &str, remedy: &str| Err(FileError::from_finding(path, found, remedy));
    if head == COLUMNS.join(",").as_bytes() {
        return wrong("one rater's codes of one recording", OWN_FILE);
    }
    // Of a log or a film, no message can show a line.
    if head.len() > LONGEST_HEAD {
        return wrong("a file that is no table of codes", EXPORTED);
    }
    let text = text_of(path, bytes)?;
    let row = |(line, before, press, code): ParsedRow| {
        let [recording, rater] = [before[0].clone(), before[1].clone()];
        RaterCodeRow { line, recording, rater, press, code }
    };
    let rows = rows(path, &text, &EXPORT_COLUMNS)?.into_iter().map(row).collect();
    Ok((text, rows))
}

pub fn write_export(path: &Path, rows: &[RaterCodeRow]) -> FileResult<()> {
    let failed = |reason| FileError::unwritable(path, reason);
    let is_own = |head: &[u8]| overwrite::first_line(head) == EXPORT_COLUMNS.join(",").as_bytes();
    overwrite::check(path, "an export of raters' codes", is_own).map_err(failed)?;
    let row = |RaterCodeRow { recording, rater, press, code, .. }: &RaterCodeRow| {
        let [cause, aspect] = cells(code);
        [recording.clone(), rater.clone(), press.to_string(), cause, aspect]
    };
    let written = table_bytes(EXPORT_COLUMNS, rows.iter().map(row)).and_then(|bytes| overwrite::write(path, &bytes));
    written.map_err(failed)
}

pub(super) fn text_of(path: &Path, bytes: Vec<u8>) -> FileResult<String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count();
        let text = String::from_utf8_lossy(error.as_bytes());
        wrong_line(path, &text, line, "bytes that are no text in UTF-8".to_string(), "a table that is saved as UTF-8")
    })
}

pub fn wrong_line(path: &Path, text: &str, line: usize, found: String, remedy: &str) -> FileError {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let length = text[before..].lines().next().map_or(0, str::len);
    FileError::at(path, text, Some(before..before + length), found, remedy)
}

/// Line number, cells before the code, sequence number of the press, and code.
pub(super) type ParsedRow = (usize, Vec<String>, u64, ErrorCauseCode);

/// The last three columns are a press and its code. No press may occur twice for the same rater and recording.
pub(super) fn rows(path: &Path, text: &str, columns: &[&str]) -> FileResult<Vec<ParsedRow>> {
    // Spreadsheets of countries with a decimal comma separate columns by semicolons.
    let head = overwrite::first_line(text.as_bytes());
    let number_of = |separator: &u8| head.iter().filter(|byte| *byte == separator).count();
    let separator = SEPARATORS.into_iter().rev().max_by_key(number_of).unwrap_or(b',');
    let mut table = csv::ReaderBuilder::new().delimiter(separator).from_reader(text.as_bytes());
    // Lines are counted here, since the CSV reader reports a row after empty lines at the position of the empty lines.
    let (mut counted, mut number) = (0, 1);
    let mut line_of = |position: Option<&csv::Position>| {
        let start = position.map_or(0, |position| (position.byte() as usize).min(text.len()));
        let empty = text.as_bytes()[start..].iter().take_while(|byte| matches!(byte, b'\n' | b'\r')).count();
        let end = counted.max(start + empty);
        number += text.as_bytes()[counted..end].iter().filter(|&&byte| byte == b'\n').count();
        counted = end;
        number
    };
    let broken = |error: csv::Error, line: usize| {
        let found = match error.kind() {
            csv::ErrorKind::UnequalLengths { len, .. } => format!("record with {}", count(*len, "field", "fields")),
            _ => error.to_string(),
        };
        wrong_line(path, text, line, found, REMEDY)
    };
    let mut head: Vec<String> = table.headers().map_err(|error| broken(error, 1))?.iter().map(str::to_string).collect();
    // A spreadsheet adds empty columns to cells that were once used.
    while head.len() > columns.len() && head.last().is_some_and(String::is_empty) {
        head.pop();
    }
    if head != columns {
        let remedy = format!("the columns {}", columns.join(","));
        let strange = head.iter().find(|name| !columns.contains(&name.as_str()));
        let near = strange.map_or(String::new(), |name| did_you_mean(name, columns));
        return Err(wrong_line(path, text, 1, format!("the columns {}{near}", head.join(",")), &remedy));
    }
    let mut rows: Vec<ParsedRow> = Vec::new();
    let mut lines = BTreeMap::new();
    for record in table.records() {
        let record = record.map_err(|error| {
            let line = line_of(error.position());
            broken(error, line)
        })?;
        let line = line_of(record.position());
        let before: Vec<String> = record.iter().take(columns.len() - 3).map(str::to_string).collect();
        let field = |back: usize| record.get(columns.len() - back).unwrap_or_default();
        let wrong = |(found, remedy): (String, &str)| wrong_line(path, text, line, found, remedy);
        if let Some(cell) = record.iter().skip(columns.len()).find(|cell| !cell.is_empty()) {
            return Err(wrong((format!("\"{cell}\" beyond the last column"), "empty cells in columns without a name")));
        }
        let not_a_number = |_| (format!("the press \"{}\"", field(3)), "the number of the press in its log");
        let press = field(3).parse::<u64>().map_err(not_a_number).map_err(wrong)?;
        let code = code_of(field(2), field(1)).map_err(wrong)?;
        if let Some(first) = lines.insert((before.clone(), press), line) {
            let found = format!("press {press} again, after line {first}");
            return Err(wrong((found, "one line for a press, of each rater")));
        }
        rows.push((line, before, press, code));
    }
    Ok(rows)
}

/// The error: what was found and what would be valid.
pub(super) fn code_of(cause: &str, aspect: &str) -> Result<ErrorCauseCode, (String, &'static str)> {
    let kind = ErrorCauseKind::named(cause);
    let near = || did_you_mean(cause, ErrorCauseKind::ALL.map(ErrorCauseKind::name));
    let kind =
        kind.ok_or_else(|| (format!("the cause \"{cause}\"{}", near()), "belief, slip, race, other or buttons"))?;
    let code = ErrorCauseCode::new(kind, Some(aspect).filter(|aspect| !aspect.is_empty()));
    let remedy = "the location that is believed wrong with \"belief\", and none with other causes";
    code.ok_or_else(|| (format!("the cause \"{cause}\" with the aspect \"{aspect}\""), remedy))
}

fn file_name(rater: &str) -> String {
    format!("codes-{rater}.csv")
}
