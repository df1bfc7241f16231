//! Recorded gaze as the gaze source of a session: tables of gaze on a surface, and recordings of this program.

use std::ffi::OsStr;
use std::fs::read_dir;
use std::path::{Path, PathBuf};

use super::gaze_table::{self, GazeTable, is_on_surface};
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
    if !is_ours && let Some([found, remedy]) = tracker_data(path) {
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

/// Names and endings of files that only recordings of eye trackers contain besides gaze.
const RECORDED: [&str; 7] = ["raw", "time", "pldata", "npy", "mp4", "bin", "json"];
/// Largest number of folder entries that are examined.
const MAX_ENTRIES: usize = 10_000;

const PLAYER: &str = "open the recording in Pupil Player with the plugin Surface Tracker and export \
                      gaze_positions_on_surface_NAME.csv in exports/000/surfaces";
const NEON: &str = "open the recording in Neon Player with the plugin Surface Tracking and export \
                    gaze_positions_on_surface_NAME.csv; or give gaze.csv of Pupil Cloud's Marker Mapper";
const CLOUD: &str = "Pupil Cloud's Marker Mapper: gaze.csv of its download; or the native recording data, exported by \
                     Neon Player with the \
                     plugin Surface Tracking";

/// What a path contains, if it belongs to an eye tracker's program and is no gaze on the display, and how gaze on the
/// display can be made from it.
fn tracker_data(path: &Path) -> Option<[String; 2]> {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    if path.is_dir() {
        return folder(path).or_else(|| sub_folders(path).iter().find_map(|sub| folder(sub)));
    }
    if extension == "zip" {
        let remedy = "unpack the archive, and give the table in it: gaze_positions_on_surface_NAME.csv, or gaze.csv of Marker \
             Mapper";
        return Some(["an archive", remedy].map(str::to_string));
    }
    path.parent().filter(|_| RECORDED.contains(&extension)).and_then(folder)
}

/// What a folder of an eye tracker's program contains, judged by the names of its files, and the remedy.
fn folder(folder: &Path) -> Option<[String; 2]> {
    let names = names(folder);
    let has = |name: &str| names.iter().any(|found| found == name);
    let with = |begin: &str, end: &str| names.iter().find(|name| name.starts_with(begin) && name.ends_with(end));
    let finding = |name: &str, what: &str, remedy: &str| {
        let found = format!("{name}: {what}, with gaze in the scene camera's picture");
        Some([found, remedy.to_string()])
    };
    if let Some(table) = table_in(folder, &names) {
        let found = "a folder with a table of gaze on the display".to_string();
        return Some([found, format!("the table itself: {}", table.display())]);
    }
    if has("gaze.pldata") || has("info.player.json") {
        let name = if has("gaze.pldata") { "gaze.pldata" } else { "info.player.json" };
        return finding(name, "a recording of Pupil Capture", PLAYER);
    }
    if let Some(name) = with("gaze", ".raw") {
        return finding(name, "a recording of Neon or Invisible", NEON);
    }
    if has("gaze.csv") {
        return finding("gaze.csv", "time series of Pupil Cloud", CLOUD);
    }
    if has("gaze_positions.csv") {
        return finding("gaze_positions.csv", "an export of Pupil Player without a surface", PLAYER);
    }
    None
}

fn table_in(folder: &Path, names: &[String]) -> Option<PathBuf> {
    let is_table = |name: &&String| name.starts_with("gaze_positions_on_surface_") && name.ends_with(".csv");
    let surfaces = folder.join("surfaces");
    let found = names.iter().find(is_table).map(|name| folder.join(name));
    let found = found.or_else(|| self::names(&surfaces).iter().find(is_table).map(|name| surfaces.join(name)));
    found.or_else(|| Some(folder.join("gaze.csv")).filter(|table| is_on_surface(table)))
}

/// Sorted names of a folder's entries; empty if the folder cannot be read.
fn names(folder: &Path) -> Vec<String> {
    let entries = read_dir(folder).into_iter().flatten().flatten().take(MAX_ENTRIES);
    let mut names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn sub_folders(folder: &Path) -> Vec<PathBuf> {
    names(folder).iter().map(|name| folder.join(name)).filter(|path| path.is_dir()).collect()
}
