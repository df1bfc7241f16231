//! Recorded gaze as the gaze source of a session: tables of gaze on a surface, and recordings of this program.

use std::path::Path;

use super::file_error::{FileError, FileResult};
use super::gaze_table;
use super::log::{LOG_NAME, LogReader};
use super::tracker_folder::{TrackerFinding, tracker_data};
use crate::gaze::GazeSample;
use crate::gaze::surface::SurfaceHomography;
use crate::session::Event;
use crate::session::apply::apply;

/// Largest number of samples in a gaze file (a day at 60 Hz).
const MAX_SAMPLES: usize = 5_184_000;

/// Samples of a gaze file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeFile {
    /// Samples in the file's order, each with its time on the trial's clock in seconds.
    pub samples: Vec<(f64, GazeSample)>,
    /// Number of malformed lines in the gaze file.
    pub malformed: u64,
}

/// Reads gaze from a recording of this program (folder or log), or from a table of gaze on a surface, which `map` maps
/// to the display. The trial starts `start_s` seconds after the first sample, or after the start of the recorded trial;
/// samples from before that time are left out.
///
/// # Errors
/// The file cannot be read, has another format, or ends before `start_s`.
pub fn read(path: &Path, map: &SurfaceHomography, start_s: f64) -> FileResult<GazeFile> {
    let is_log = path.extension().is_some_and(|extension| extension == "jsonl");
    let is_ours = is_log || path.join(LOG_NAME).exists();
    if !is_ours && let Some(TrackerFinding { found, remedy }) = tracker_data(path) {
        return Err(FileError::from_finding(path, found, remedy));
    }
    let mut found = if path.is_dir() || is_log { of_recording(path)? } else { of_table(path, map)? };
    let last_s = found.samples.iter().map(|(at_s, _)| *at_s).max_by(f64::total_cmp);
    if let Some(last_s) = last_s.filter(|last_s| *last_s < start_s) {
        let found = format!("its last sample at {last_s:.1} s, before the start at {start_s:.1} s");
        let remedy = "an earlier start: file_start_s under [tracker], or --gaze-start";
        return Err(FileError::from_finding(path, found, remedy.to_string()));
    }
    found.samples.iter_mut().for_each(|(at_s, _)| *at_s -= start_s);
    found.samples.retain(|(at_s, _)| *at_s >= 0.0);
    Ok(found)
}

fn of_table(path: &Path, map: &SurfaceHomography) -> FileResult<GazeFile> {
    let (samples, malformed) = gaze_table::read(path, map, MAX_SAMPLES)?;
    let samples = samples.into_iter().map(|(at_ns, sample)| (at_ns as f64 / 1e9, sample)).collect();
    Ok(GazeFile { samples, malformed })
}

fn of_recording(path: &Path) -> FileResult<GazeFile> {
    let mut log = LogReader::open(path)?;
    let mut session = log.session();
    let mut found = GazeFile::default();
    while let Some(line) = log.next_line()? {
        apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
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
