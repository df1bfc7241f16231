//! CSV tables of gaze on a surface, as exported by Pupil Player (for Pupil Core), and by Neon Player and Pupil Cloud's
//! Marker Mapper (for Neon and Invisible).

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::file_error::{FileError, FileResult};
use crate::gaze::GazeSample;
use crate::gaze::surface::SurfaceHomography;

/// Description of valid gaze files, for error messages.
const REMEDY: &str = "gaze on the display: gaze_positions_on_surface_NAME.csv of Pupil Player or Neon Player, gaze.csv of \
                                 Pupil Cloud's Marker Mapper, or a recording's folder";
/// Longest line of a gaze table, in bytes.
const MAX_LINE: u64 = 1 << 16;
/// Columns that contain gaze in the scene camera's image, from which the gaze on the display cannot be computed.
const SCENE_COLUMNS: [&str; 3] = ["gaze x [px]", "gaze position in reference image x [px]", "norm_pos_x"];

/// Program that exported the table of gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GazeExporter {
    PupilPlayer,
    /// Pupil Cloud's Marker Mapper and Neon Player, whose columns have the same names.
    MarkerMapper,
}

/// Indices of those columns of a gaze table that are used.
#[derive(Clone, Copy, Debug)]
struct GazeColumns {
    exporter: GazeExporter,
    time: usize,
    x: usize,
    y: usize,
    /// Index of the confidence column; only tables of Pupil Player have it.
    confidence: Option<usize>,
    /// Indices of the columns of blink id and recording; only tables of Marker Mapper have them.
    blink: Option<usize>,
    recording: Option<usize>,
}

/// Content of a row of the gaze table.
enum GazeRow {
    Sample(i64, GazeSample),
    /// The surface was not found in the scene camera's image, so the gaze on the surface is unknown.
    Unlocated,
    Malformed,
}

/// Reads at most `most` samples of a table whose surface is mapped to the display by `map`. Returns each sample with
/// the nanoseconds since the first sample, and the number of malformed lines.
///
/// # Errors
/// The file cannot be read, is no table of gaze on a surface, or contains gaze of several recordings.
pub(super) fn read(path: &Path, map: &SurfaceHomography, most: usize) -> FileResult<(Vec<(i64, GazeSample)>, u64)> {
    let unreadable = |reason| FileError::unreadable(path, reason, REMEDY);
    let mut input = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| {
        line.clear();
        input.by_ref().take(MAX_LINE).read_until(b'\n', line).map_err(unreadable)
    };
    next(&mut line)?;
    let columns = columns(path, &head_of(&line))?;
    let (mut samples, mut malformed, mut first_ns) = (Vec::new(), 0, None);
    let mut recording: Option<String> = None;
    while next(&mut line)? > 0 && samples.len() < most {
        if line.trim_ascii().is_empty() {
            continue;
        }
        let text = String::from_utf8_lossy(&line);
        let cells: Vec<&str> = text.trim().split(',').map(str::trim).collect();
        if let Some(name) = columns.recording.and_then(|column| cells.get(column)) {
            let known = recording.get_or_insert_with(|| name.to_string());
            if known != name {
                let remedy = format!("the lines of one recording only: one has the recording id {known}");
                return Err(FileError::from_finding(path, format!("gaze of several recordings ({name})"), remedy));
            }
        }
        match columns.row(&cells, map) {
            GazeRow::Sample(at_ns, sample) => {
                let first_ns = *first_ns.get_or_insert(at_ns);
                samples.push((at_ns.saturating_sub(first_ns), sample));
            }
            GazeRow::Unlocated => {}
            GazeRow::Malformed => malformed += 1,
        }
    }
    Ok((samples, malformed))
}

/// Whether a file is a table of gaze on a surface, judged by its first line.
pub(super) fn is_on_surface(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| BufReader::new(file).take(MAX_LINE).read_until(b'\n', &mut head));
    read.is_ok() && columns(path, &head_of(&head)).is_ok()
}

/// The header line of a gaze table as text, without a byte order mark.
fn head_of(line: &[u8]) -> String {
    String::from_utf8_lossy(line).trim_start_matches('\u{feff}').trim().to_string()
}

/// Finds the used columns in the header line of a gaze table.
fn columns(path: &Path, head: &str) -> FileResult<GazeColumns> {
    let names: Vec<&str> = head.split(',').map(str::trim).collect();
    let place = |name: &str| names.iter().position(|found| *found == name);
    let wrong = |found: String| FileError::at(path, head, Some(0..head.len()), found, REMEDY.to_string());
    let need = |name: &str| place(name).ok_or_else(|| wrong(format!("no column {name}")));
    let [x, y] = ["x", "y"].map(|axis| format!("gaze position on surface {axis} [normalized]"));
    if let Some(x) = place(&x) {
        return Ok(GazeColumns {
            exporter: GazeExporter::MarkerMapper,
            time: need("timestamp [ns]")?,
            x,
            y: need(&y)?,
            confidence: None,
            blink: place("blink id"),
            recording: place("recording id"),
        });
    }
    if let Some(name) = SCENE_COLUMNS.iter().find(|name| place(name).is_some()) {
        return Err(wrong(format!("gaze in the scene camera's picture ({name})")));
    }
    Ok(GazeColumns {
        exporter: GazeExporter::PupilPlayer,
        time: need("gaze_timestamp")?,
        x: need("x_norm")?,
        y: need("y_norm")?,
        confidence: Some(need("confidence")?),
        blink: None,
        recording: None,
    })
}

impl GazeColumns {
    fn row(&self, cells: &[&str], map: &SurfaceHomography) -> GazeRow {
        let cell = |column: usize| cells.get(column).copied().unwrap_or_default();
        let number = |column: usize| cell(column).parse::<f64>().ok().filter(|number| number.is_finite());
        let read = match self.exporter {
            GazeExporter::MarkerMapper if cell(self.x).is_empty() && cell(self.y).is_empty() => {
                return GazeRow::Unlocated;
            }
            GazeExporter::MarkerMapper => {
                // During a blink the table's gaze direction is invented, so its confidence is set to 0. The table's
                // origin is the top left corner, that of the surface map the bottom left.
                let is_blink = self.blink.is_some_and(|column| !cell(column).is_empty());
                let confidence = if is_blink { 0.0 } else { 1.0 };
                let place = number(self.x).zip(number(self.y)).and_then(|(x, y)| map.to_display([x, 1.0 - y]));
                cell(self.time).parse::<i64>().ok().zip(place).map(|(ns, place)| (ns, place, confidence))
            }
            GazeExporter::PupilPlayer => {
                let place = number(self.x).zip(number(self.y)).and_then(|(x, y)| map.to_display([x, y]));
                let confidence = self.confidence.and_then(number).filter(|share| (0.0..=1.0).contains(share));
                let at_s = number(self.time).filter(|at_s| (0.0..1e10).contains(at_s));
                at_s.zip(place)
                    .zip(confidence)
                    .map(|((at_s, place), confidence)| ((at_s * 1e9) as i64, place, confidence))
            }
        };
        match read {
            Some((at_ns, [x, y], confidence)) => {
                let sample = GazeSample { device_ns: Some(at_ns), ..GazeSample::new(x, y, confidence) };
                GazeRow::Sample(at_ns, sample)
            }
            None => GazeRow::Malformed,
        }
    }
}
