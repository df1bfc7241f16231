//! CSV tables of gaze on a surface, as exported by Pupil Player (for Pupil Core), and by Neon Player and Pupil Cloud's
//! Marker Mapper (for Neon and Invisible), also after a spreadsheet, pandas or R has written them again: with other
//! separators, decimal commas, quotation marks, or as UTF-16.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

use csv::StringRecord;
use encoding_rs::{UTF_16BE, UTF_16LE};
use encoding_rs_io::{DecodeReaderBytes, DecodeReaderBytesBuilder};

use tomcom_core::base::text::{SEPARATORS, count, printable};
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::recorded::{GAP_S, RecordedTimeline, TimeLimits, median_interval};
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_session::files::file_error::{FileError, FileResult, open_regular};
use tomcom_session::log::at_line;
use tomcom_session::tracker::MissingConfidence;

/// Description of valid gaze files, for error messages.
const REMEDY: &str = "gaze on the display: gaze_positions_on_surface_NAME.csv of Pupil Player or Neon Player, gaze.csv of \
                                 Pupil Cloud's Marker Mapper, or a recording's folder";
/// Remedy for tables that a program has written again and that cannot be read any more.
const EXPORTED: &str = "the table as the tracker's program exported it, not as a spreadsheet saved it";
/// Longest line of a gaze table, in bytes.
const MAX_LINE: u64 = 1 << 16;
/// Largest size of a gaze table, in bytes.
const MAX_BYTES: u64 = 4 << 30;
/// Columns that contain gaze in the scene camera's image, from which the gaze on the display cannot be computed.
const SCENE_COLUMNS: [&str; 3] = ["gaze x [px]", "gaze position in reference image x [px]", "norm_pos_x"];
/// Number of intervals between samples from which the unit of the times can be judged.
const JUDGED: usize = 10;
/// Largest number of clock steps in a table; lines in which the clock was set more often have no order of time.
const MAX_STEPS: usize = 10;
/// Sampling intervals of eye trackers, in nanoseconds: from 10 kHz to 2 Hz.
const INTERVALS_NS: std::ops::RangeInclusive<f64> = 1e5..=0.5e9;
/// Sampling intervals by which a unit of time is recognised, in nanoseconds: from 667 Hz to 10 Hz.
const PLAIN_NS: std::ops::RangeInclusive<f64> = 1.5e6..=1e8;
/// Limits between which the times of one clock lie, in nanoseconds. No trial is longer than a day.
const LIMITS: TimeLimits =
    TimeLimits { back: NS_PER_S / 10, gap: GAP_S as i128 * NS_PER_S, longest: 86_400 * NS_PER_S };
/// Units of time: their name in column names, their name in messages, and nanoseconds per unit.
const UNITS: [(&str, &str, i128); 5] = [
    ("ns", "nanoseconds", 1),
    ("us", "microseconds", 1_000),
    ("µs", "microseconds", 1_000),
    ("ms", "milliseconds", 1_000_000),
    ("s", "seconds", NS_PER_S),
];
const NS_PER_S: i128 = 1_000_000_000;

/// Program that exported the table of gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GazeExporter {
    PupilPlayer,
    /// Pupil Cloud's Marker Mapper and Neon Player, whose columns have the same names.
    MarkerMapper,
}

/// Indices of those columns of a gaze table that are used.
#[derive(Clone, Debug)]
struct GazeColumns {
    exporter: GazeExporter,
    separator: u8,
    names: Vec<String>,
    /// Number of cells with the row's name before the first column.
    row_names: usize,
    time: usize,
    /// Nanoseconds per unit of time, if the column's name tells the unit.
    unit_ns: Option<i128>,
    x: usize,
    y: usize,
    /// Index of the confidence column; only tables of Pupil Player have it.
    confidence: Option<usize>,
    /// Indices of the columns of blink id and recording; only tables of Marker Mapper have them.
    blink: Option<usize>,
    recording: Option<usize>,
}

/// A row of the gaze table that is a gaze sample.
struct GazeRow {
    line: usize,
    time: i128,
    place: [f64; 2],
    /// `None` if the row does not tell the confidence.
    confidence: Option<f64>,
}

/// Content of a gaze table.
#[derive(Debug, Default)]
pub(super) struct GazeTable {
    /// Samples in the table's order, each with the seconds since the first sample.
    pub samples: Vec<(f64, GazeSample)>,
    /// Number of lines that are no samples, and what is wrong in the first of them.
    pub malformed: u64,
    pub first_malformed: Option<String>,
    /// Number of samples without a confidence.
    pub without_confidence: u64,
    pub remarks: Vec<String>,
}

/// A table that is being read, line by line.
struct Lines {
    input: BufReader<io::Take<DecodeReaderBytes<File, Vec<u8>>>>,
    line: Vec<u8>,
    number: usize,
}

impl Lines {
    /// Opens a table in UTF-8 or UTF-16.
    fn open(path: &Path) -> io::Result<Lines> {
        let mut file = open_regular(path)?;
        let mut first = Vec::new();
        file.by_ref().take(2).read_to_end(&mut first)?;
        file.rewind()?;
        // A text that begins with a letter of ASCII, in UTF-16 without a byte order mark.
        let encoding = match first[..] {
            [0, letter] if letter != 0 => Some(UTF_16BE),
            [letter, 0] if letter != 0 => Some(UTF_16LE),
            _ => None,
        };
        let mut decoder = DecodeReaderBytesBuilder::new();
        let input = decoder.encoding(encoding).bom_override(true).strip_bom(true).build(file).take(MAX_BYTES);
        Ok(Lines { input: BufReader::new(input), line: Vec::new(), number: 0 })
    }

    /// Reads the next line; returns false at the end of the table.
    fn read(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.number += 1;
        let read = self.input.by_ref().take(MAX_LINE).read_until(b'\n', &mut self.line)? as u64;
        let is_cut = self.line.last() != Some(&b'\n');
        let too_large = |what: String| Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
        if is_cut && read == MAX_LINE {
            return too_large(format!("line {} has more than {MAX_LINE} bytes", self.number));
        }
        if is_cut && self.input.get_ref().limit() == 0 {
            return too_large(format!("it has more than {MAX_BYTES} bytes"));
        }
        Ok(read > 0)
    }

    /// The cells of the present line, without quotation marks and spaces around them.
    fn cells(&self, separator: u8) -> StringRecord {
        let mut reader = csv::ReaderBuilder::new();
        reader.delimiter(separator).has_headers(false).flexible(true).trim(csv::Trim::All);
        let mut record = csv::ByteRecord::new();
        // Reading from memory does not fail.
        let _ = reader.buffer_capacity(self.line.len()).from_reader(&self.line[..]).read_byte_record(&mut record);
        StringRecord::from_byte_record_lossy(record)
    }

    /// An error in the present line.
    fn wrong(&self, path: &Path, found: String, remedy: &str) -> FileError {
        let text = String::from_utf8_lossy(&self.line);
        at_line(path, self.number, text.trim_end(), 0, found, remedy.to_string())
    }
}

/// Reads at most `most` samples of a table whose surface is mapped to the display by `map`.
///
/// # Errors
/// The file cannot be read, is no table of gaze on a surface, has no line with gaze, contains gaze of several
/// recordings, or its times are lost.
pub(super) fn read(
    path: &Path,
    map: &SurfaceHomography,
    missing: MissingConfidence,
    most: usize,
) -> FileResult<GazeTable> {
    let unreadable = |reason| FileError::unreadable(path, reason, REMEDY);
    let mut lines = Lines::open(path).map_err(unreadable)?;
    lines.read().map_err(unreadable)?;
    let mut columns = GazeColumns::in_header(path, &lines, missing)?;
    let (mut table, mut rows, mut unlocated) = (GazeTable::default(), Vec::new(), 0_u64);
    let (mut recording, mut first_wrong, mut is_first) = (None::<String>, None, true);
    while lines.read().map_err(unreadable)? {
        if lines.line.trim_ascii().is_empty() {
            continue;
        }
        let cells = lines.cells(columns.separator);
        if std::mem::take(&mut is_first) {
            columns.find_row_names(&cells);
        }
        if let Some(name) = columns.recording.and_then(|column| cells.get(column + columns.row_names)) {
            let known = recording.get_or_insert_with(|| name.to_string());
            if known != name {
                let remedy = format!("the lines of one recording only: one has the recording id {known}");
                return Err(lines.wrong(path, format!("gaze of several recordings ({name})"), &remedy));
            }
        }
        match columns.row(lines.number, &cells, map) {
            Ok(Some(row)) => rows.push(row),
            // The surface was not found in the scene camera's image, so the gaze on the surface is unknown.
            Ok(None) => unlocated += 1,
            Err(found) => {
                first_wrong.get_or_insert_with(|| lines.wrong(path, format!("no line with gaze: {found}"), EXPORTED));
                table.add_malformed(lines.number, &found);
            }
        }
        if rows.len() > most {
            let remedy = "a table of one trial, or of one day at most";
            return Err(lines.wrong(path, format!("more than {most} samples"), remedy));
        }
    }
    if rows.is_empty() {
        let found = match unlocated {
            0 => "a table without a line below its header".to_string(),
            some => format!("{}, none of them with gaze on the surface", count(some, "line", "lines")),
        };
        return Err(first_wrong.unwrap_or_else(|| FileError::from_finding(path, found, REMEDY.to_string())));
    }
    table.take_rows(path, &columns, rows, missing)?;
    Ok(table)
}

/// Whether a file is a table of gaze on a surface, judged by its first line.
pub(super) fn is_on_surface(path: &Path) -> bool {
    let Ok(mut lines) = Lines::open(path) else { return false };
    lines.read().is_ok() && GazeColumns::in_header(path, &lines, MissingConfidence::Good).is_ok()
}

/// Whether a column has this name; R replaces characters that are no letters and digits by dots.
fn is_named(found: &str, name: &str) -> bool {
    let is_same = |(found, wanted): (char, char)| found == wanted || (found == '.' && !wanted.is_alphanumeric());
    found.chars().count() == name.chars().count() && found.chars().zip(name.chars()).all(is_same)
}

/// A cell in a message, shortened.
fn quoted(cell: &str) -> String {
    let start: String = cell.chars().take(40).collect();
    format!("\"{start}{}\"", if start.len() < cell.len() { "…" } else { "" })
}

/// Whether a cell has no value, as spreadsheets, pandas and R write it.
fn is_missing(cell: &str) -> bool {
    matches!(cell.to_ascii_lowercase().as_str(), "" | "na" | "n/a" | "nan" | "-nan" | "null" | "none" | "#n/a")
}

/// The finite number in a cell, with a decimal point or a decimal comma.
fn number(cell: &str) -> Option<f64> {
    let number = match cell.contains('.') {
        true => cell.parse::<f64>(),
        false => cell.replace(',', ".").parse(),
    };
    number.ok().filter(|number| number.is_finite())
}

/// The time in a cell, in billionths of its unit; whole numbers are exact.
fn time(cell: &str) -> Option<i128> {
    let whole = cell.parse::<i64>().ok().map(|whole| i128::from(whole) * NS_PER_S);
    whole.or_else(|| number(cell).filter(|time| time.abs() < 1e19).map(|time| (time * 1e9).round() as i128))
}

impl GazeColumns {
    /// Finds separator and used columns in the header of a table.
    fn in_header(path: &Path, lines: &Lines, missing: MissingConfidence) -> FileResult<GazeColumns> {
        let separators = SEPARATORS.map(|separator| (lines.cells(separator), separator));
        let (cells, separator) = separators.into_iter().rev().max_by_key(|(cells, _)| cells.len()).unwrap_or_default();
        let names: Vec<String> = cells.iter().map(str::to_string).collect();
        let place = |name: &str| names.iter().position(|found| is_named(found, name));
        let wrong = |found: String| lines.wrong(path, found, REMEDY);
        let need = |name: &str| place(name).ok_or_else(|| wrong(format!("no column {name}")));
        let with_unit = |name: &str| {
            let named = UNITS.iter().map(|(unit, _, ns)| (place(&format!("{name} [{unit}]")), ns));
            named.into_iter().find_map(|(found, ns)| Some((found?, Some(*ns))))
        };
        let [x, y] = ["x", "y"].map(|axis| format!("gaze position on surface {axis} [normalized]"));
        let (exporter, (time, unit_ns), x, y) = if let Some(x) = place(&x) {
            let time = with_unit("timestamp").ok_or_else(|| wrong("no column timestamp [ns]".to_string()))?;
            (GazeExporter::MarkerMapper, time, x, need(&y)?)
        } else if let Some(name) = SCENE_COLUMNS.iter().find(|name| place(name).is_some()) {
            return Err(wrong(format!("gaze in the scene camera's picture ({name})")));
        } else {
            let time = match with_unit("gaze_timestamp") {
                Some(found) => found,
                None => (need("gaze_timestamp")?, None),
            };
            (GazeExporter::PupilPlayer, time, need("x_norm")?, need("y_norm")?)
        };
        let only = |of: GazeExporter, name: &str| place(name).filter(|_| exporter == of);
        let confidence = only(GazeExporter::PupilPlayer, "confidence");
        if exporter == GazeExporter::PupilPlayer && confidence.is_none() && missing == MissingConfidence::Bad {
            let remedy = "a table with confidence; or missing_confidence = \"good\" under [tracker], where the tracker \
                          knows none";
            return Err(lines.wrong(path, "no column confidence".to_string(), remedy));
        }
        let [blink, recording] = ["blink id", "recording id"].map(|name| only(GazeExporter::MarkerMapper, name));
        Ok(GazeColumns { exporter, separator, time, unit_ns, x, y, confidence, blink, recording, names, row_names: 0 })
    }

    /// R's `write.table` puts names before the rows, for which the header has no column. One decimal comma too many would
    /// look like that, but a row of gaze has several decimal numbers.
    fn find_row_names(&mut self, first: &StringRecord) {
        let has_one_more =
            first.len() == self.names.len() + 1 && first.iter().next_back().is_some_and(|cell| !cell.is_empty());
        self.row_names = usize::from(has_one_more);
    }

    /// The gaze in the cells of a line; `None` if they say that the gaze on the surface is unknown.
    ///
    /// # Errors
    /// The row is no gaze sample, for this reason.
    fn row(&self, line: usize, cells: &StringRecord, map: &SurfaceHomography) -> Result<Option<GazeRow>, String> {
        let (found, wanted) = (cells.len(), self.names.len() + self.row_names);
        if found < wanted || cells.iter().skip(wanted).any(|cell| !cell.is_empty()) {
            let why = if found > wanted && self.separator == b',' { ": decimal commas?" } else { "" };
            return Err(format!("{} instead of {wanted}{why}", count(found as u64, "cell", "cells")));
        }
        let cell = |column: usize| cells.get(column + self.row_names).unwrap_or_default();
        let wrong = |column: usize| format!("{} = {}", self.names[column], quoted(cell(column)));
        let need = |column: usize| number(cell(column)).ok_or_else(|| wrong(column));
        if is_missing(cell(self.x)) && is_missing(cell(self.y)) {
            return Ok(None);
        }
        let at = time(cell(self.time)).ok_or_else(|| wrong(self.time))?;
        let (x, y) = (need(self.x)?, need(self.y)?);
        let (y, confidence) = match self.exporter {
            // During a blink the table's gaze direction is invented, so its confidence is set to 0. The table's origin is
            // the top left corner, that of the surface map the bottom left.
            GazeExporter::MarkerMapper => {
                let is_blink = self.blink.is_some_and(|column| !is_missing(cell(column)));
                (1.0 - y, Some(if is_blink { 0.0 } else { 1.0 }))
            }
            GazeExporter::PupilPlayer => match self.confidence.filter(|column| !is_missing(cell(*column))) {
                None => (y, None),
                Some(column) => {
                    let confidence = number(cell(column)).filter(|share| (0.0..=1.0).contains(share));
                    (y, Some(confidence.ok_or_else(|| format!("{}, not 0 to 1", wrong(column)))?))
                }
            },
        };
        let place = map.to_display([x, y]).ok_or_else(|| format!("{x}, {y}: nowhere on the display's plane"))?;
        Ok(Some(GazeRow { line, time: at, place, confidence }))
    }

    /// Nanoseconds per unit of the table's times, from the column's name, or else from the interval between samples.
    ///
    /// # Errors
    /// The interval between samples is that of no eye tracker: the times were rounded, or are no times.
    fn unit_ns(&self, path: &Path, rows: &[GazeRow], times: &[i128], remarks: &mut Vec<String>) -> FileResult<i128> {
        let default_ns = self.unit_ns.unwrap_or(NS_PER_S);
        let Some(interval) = median_interval(times).filter(|_| times.len() > JUDGED) else { return Ok(default_ns) };
        let name = &self.names[self.time];
        let wrong = |index: usize, found: String, remedy: &str| {
            let text = format!("{name} = {}", times[index] as f64 / 1e9);
            at_line(path, rows[index].line, &text, 0, found, remedy.to_string())
        };
        if interval <= 0 {
            let is_it = |pair: &[i128]| (pair[1] - pair[0]).signum() == interval.signum();
            let index = times.windows(2).position(is_it).unwrap_or(0) + 1;
            let found = match interval {
                0 => format!("{name} as in the line before, and so in most lines: the times were rounded"),
                _ => format!("{name} before that of the line before, and so in most lines"),
            };
            return Err(wrong(index, found, EXPORTED));
        }
        let units = interval as f64 / 1e9;
        let is_usual = |unit_ns: i128| INTERVALS_NS.contains(&(units * unit_ns as f64));
        if is_usual(default_ns) {
            return Ok(default_ns);
        }
        // Only seconds are taken for granted; another unit has to be plain.
        let is_plain = |unit_ns: i128| PLAIN_NS.contains(&(units * unit_ns as f64));
        let plain = UNITS.iter().find(|(.., ns)| self.unit_ns.is_none() && *ns < NS_PER_S && is_plain(*ns));
        let Some((_, unit, unit_ns)) = plain else {
            let unit = UNITS.iter().find(|(.., ns)| Some(*ns) == self.unit_ns).map_or("time", |(_, unit, _)| unit);
            let found = format!("{name} that rises by {units} from line to line: no {unit} of gaze (frames?)");
            return Err(wrong(1, found, "times in seconds for Pupil Player, in nanoseconds for Neon"));
        };
        remarks.push(format!("{name} read as {unit}, since it rises by {units} from line to line"));
        Ok(*unit_ns)
    }
}

impl GazeTable {
    fn add_malformed(&mut self, line: usize, found: &str) {
        self.malformed += 1;
        self.first_malformed.get_or_insert_with(|| printable(&format!("line {line}: {found}")).into_owned());
    }

    /// Puts the samples in time. Where the clock was set, samples are joined in their order.
    fn take_rows(
        &mut self,
        path: &Path,
        columns: &GazeColumns,
        mut rows: Vec<GazeRow>,
        missing: MissingConfidence,
    ) -> FileResult<()> {
        let times: Vec<i128> = rows.iter().map(|row| row.time).collect();
        let unit_ns = columns.unit_ns(path, &rows, &times, &mut self.remarks)?;
        let name = &columns.names[columns.time];
        rows.iter_mut().for_each(|row| row.time = row.time * unit_ns / NS_PER_S);
        rows.retain(|row| {
            let fits = i64::try_from(row.time).is_ok();
            if !fits {
                self.add_malformed(row.line, &format!("{name} beyond 292 years"));
            }
            fits
        });
        if rows.is_empty() {
            let found = format!("no line with gaze: {name} beyond 292 years");
            return Err(FileError::from_finding(path, found, EXPORTED.to_string()));
        }
        let times: Vec<i128> = rows.iter().map(|row| row.time).collect();
        let timeline = RecordedTimeline::from_times(&times, LIMITS);
        let seconds = |ns: i128| ns as f64 / 1e9;
        if let Some(first) = timeline.steps.first().filter(|_| timeline.steps.len() > MAX_STEPS) {
            let found = format!("{} steps of {name}, the first here: lines without an order", timeline.steps.len());
            let text = format!("{name} = {}", seconds(first.to));
            return Err(at_line(path, rows[first.at].line, &text, 0, found, EXPORTED.to_string()));
        }
        self.remarks.extend(timeline.steps.iter().map(|step| {
            let (line, from_s, to_s) = (rows[step.at].line, seconds(step.from), seconds(step.to));
            format!("line {line}: the clock was set from {from_s} s to {to_s} s; joined in the order of lines")
        }));
        if let Some(&first) = timeline.odd.first() {
            let left_out = count(timeline.odd.len() as u64, "line", "lines");
            let (line, at_s) = (rows[first].line, seconds(times[first]));
            self.remarks.push(format!("{left_out} left out, with a time that fits no other (line {line}: {at_s} s)"));
            timeline.odd.iter().for_each(|&odd| self.add_malformed(rows[odd].line, "a time that fits no other"));
        }
        for (row, time) in rows.iter().zip(timeline.times) {
            let Some(since_first_ns) = time else { continue };
            let ([x, y], device_ns) = (row.place, i64::try_from(row.time).ok());
            self.without_confidence += u64::from(row.confidence.is_none());
            let confidence = row.confidence.unwrap_or(missing.confidence());
            let sample = GazeSample { device_ns, ..GazeSample::new(x, y, confidence) };
            self.samples.push((seconds(since_first_ns), sample));
        }
        Ok(())
    }
}
