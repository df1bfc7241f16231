//! Recorded gaze: Pupil Player's export of gaze on a surface, and recordings of this program.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::file_error::{FileError, FileResult};
use super::log::{LogReader, at_line};
use crate::gaze::GazeSample;
use crate::gaze::surface::SurfaceMap;
use crate::session::Event;
use crate::session::apply::apply;

/// Longest line of an export, in bytes.
const MAX_LINE: u64 = 1 << 16;
/// Largest number of samples in a file (a day at 60 Hz).
const MAX_SAMPLES: usize = 5_184_000;

/// Columns of an export that are used.
const COLUMNS: [&str; 4] = ["gaze_timestamp", "x_norm", "y_norm", "confidence"];

/// The samples of a gaze file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeFile {
    /// Time on the trial's clock in seconds, and sample, in the file's order.
    pub samples: Vec<(f64, GazeSample)>,
    /// Number of malformed lines.
    pub malformed: u64,
}

/// Reads gaze from a folder or a log of this program, or from Pupil Player's
/// `surfaces/gaze_positions_on_surface_NAME.csv`, whose surface is mapped by `map`.
///
/// # Errors
/// The file cannot be read or has another format.
pub fn read(path: &Path, map: &SurfaceMap) -> FileResult<GazeFile> {
    let is_recording = path.is_dir() || path.extension().is_some_and(|extension| extension == "jsonl");
    if is_recording { of_recording(path) } else { of_export(path, map) }
}

fn of_recording(path: &Path) -> FileResult<GazeFile> {
    let mut log = LogReader::open(path)?;
    let mut session = log.session();
    let mut found = GazeFile::default();
    while let Some(line) = log.next_line()? {
        apply(&mut session, &line.stamped)
            .map_err(|error| at_line(log.path(), line.number, &line.text, 0, error.found, error.remedy))?;
        if let Event::Gaze(sample) = line.stamped.event
            && session.is_running()
            && found.samples.len() < MAX_SAMPLES
        {
            let taken = sample.taken_ns.unwrap_or(line.stamped.time).min(line.stamped.time);
            let at_s = session.trial_clock(taken).as_secs_f64();
            found.samples.push((at_s, GazeSample { taken_ns: None, ..session.corrected(sample) }));
        }
    }
    Ok(found)
}

fn of_export(path: &Path, map: &SurfaceMap) -> FileResult<GazeFile> {
    let remedy = "a file surfaces/gaze_positions_on_surface_NAME.csv of Pupil Player's export, or a recording's folder";
    let unreadable = |reason| FileError::unreadable(path, reason, remedy);
    let mut input = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| {
        line.clear();
        input.by_ref().take(MAX_LINE).read_until(b'\n', line).map_err(unreadable)
    };
    next(&mut line)?;
    let head = String::from_utf8_lossy(&line).trim().to_string();
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let mut columns = [0; 4];
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        let found = || format!("no column {name}");
        let at = names.iter().position(|found| *found == name);
        *column = at.ok_or_else(|| FileError::at(path, &head, Some(0..head.len()), found(), remedy.to_string()))?;
    }
    let mut found = GazeFile::default();
    let mut first_s = None;
    while next(&mut line)? > 0 && found.samples.len() < MAX_SAMPLES {
        match sample(&line, columns, map) {
            Some((at_s, sample)) => {
                let first_s = *first_s.get_or_insert(at_s);
                found.samples.push((at_s - first_s, sample));
            }
            None if line.trim_ascii().is_empty() => {}
            None => found.malformed += 1,
        }
    }
    Ok(found)
}

/// The sample of a line of an export, and its time there in seconds.
fn sample(line: &[u8], columns: [usize; 4], map: &SurfaceMap) -> Option<(f64, GazeSample)> {
    let text = std::str::from_utf8(line).ok()?;
    let cells: Vec<&str> = text.trim().split(',').collect();
    let number = |column: usize| cells.get(column)?.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let [at_s, x, y, confidence] = columns.map(number);
    let (at_s, place) = (at_s?, map.to_display([x?, y?])?);
    let confidence = confidence.filter(|confidence| (0.0..=1.0).contains(confidence))?;
    let device_ns = (0.0..1e10).contains(&at_s).then_some((at_s * 1e9) as u64);
    Some((at_s, GazeSample { device_ns, ..GazeSample::new(place[0], place[1], confidence) }))
}
