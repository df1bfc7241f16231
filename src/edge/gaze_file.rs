//! Recorded gaze as the gaze source of a session: tables of gaze on a surface, and recordings of this program.

use std::path::Path;

use super::gaze_table::{self, GazeTable};
use super::tracker_folder::{TrackerFinding, tracker_data};
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::recorded::RecordedGazeSummary;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_session::Event;
use tomcom_session::apply::apply;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::{LOG_NAME, LogReader};
use tomcom_session::tracker::TrackerSpec;

/// Largest number of samples in a gaze file (a day at 60 Hz).
const MAX_SAMPLES: usize = 5_184_000;

/// Samples of a gaze file, at least one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeFile {
    /// Samples in the file's order, each with its time on the trial's clock in seconds.
    pub samples: Vec<(f64, GazeSample)>,
    /// What a session reads from the file.
    pub summary: RecordedGazeSummary,
}

/// Reads gaze from a recording of this program (folder or log), or from a table of gaze on a surface, which `map` maps
/// to the display. The trial starts at the settings' `file_start_s` after the first sample, or after the start of the
/// recorded trial; samples from before that time are left out.
///
/// # Errors
/// The file cannot be read, has another format, has no gaze, or ends before the trial starts.
pub fn read(path: &Path, map: &SurfaceHomography, settings: &TrackerSpec) -> FileResult<GazeFile> {
    let start_s = settings.file_start_s;
    let is_log = path.extension().is_some_and(|extension| extension == "jsonl");
    let is_ours = is_log || path.join(LOG_NAME).exists();
    if !is_ours && let Some(TrackerFinding { found, remedy }) = tracker_data(path) {
        return Err(FileError::from_finding(path, found, remedy));
    }
    let found = match path.is_dir() || is_log {
        true => GazeTable { samples: of_recording(path)?, ..GazeTable::default() },
        false => gaze_table::read(path, map, settings.missing_confidence, MAX_SAMPLES)?,
    };
    let GazeTable { mut samples, malformed, first_malformed, without_confidence, remarks } = found;
    let last_s = samples.iter().map(|(at_s, _)| *at_s).max_by(f64::total_cmp);
    if let Some(last_s) = last_s.filter(|last_s| *last_s < start_s) {
        let found = format!("its last sample at {last_s:.1} s, before the start at {start_s:.1} s");
        let remedy = "an earlier start: file_start_s under [tracker], or --gaze-start";
        return Err(FileError::from_finding(path, found, remedy.to_string()));
    }
    samples.iter_mut().for_each(|(at_s, _)| *at_s -= start_s);
    samples.retain(|(at_s, _)| *at_s >= 0.0);
    let summary = RecordedGazeSummary::from_samples(&samples);
    let summary = RecordedGazeSummary { malformed, first_malformed, without_confidence, remarks, ..summary };
    Ok(GazeFile { samples, summary })
}

fn of_recording(path: &Path) -> FileResult<Vec<(f64, GazeSample)>> {
    let mut log = LogReader::open(path)?;
    let mut session = log.session();
    let mut samples = Vec::new();
    while let Some(line) = log.next_line()? {
        apply(&mut session, &line.stamped).map_err(|error| log.refused(&line, error))?;
        if let Event::Gaze(sample) = line.stamped.event
            && session.is_running()
        {
            let taken = sample.taken_ns.unwrap_or(line.stamped.time).min(line.stamped.time);
            let at_s = session.trial_clock(taken).as_secs_f64();
            samples.push((at_s, GazeSample { taken_ns: None, ..session.corrected(sample) }));
        }
        if samples.len() > MAX_SAMPLES {
            let remedy = "a recording of one trial".to_string();
            return Err(FileError::from_finding(path, format!("more than {MAX_SAMPLES} samples"), remedy));
        }
    }
    if samples.is_empty() {
        let remedy = "a recording of a session with gaze".to_string();
        return Err(FileError::from_finding(path, "a recording without gaze".to_string(), remedy));
    }
    Ok(samples)
}
