//! Recognition of the files of eye trackers' own programs, to explain why they cannot be used: recordings and downloads
//! of trackers contain gaze in the scene camera's image, from which the gaze on the display cannot be computed. For
//! each tracker there is a program that maps such gaze to the display.

use std::ffi::OsStr;
use std::fs::read_dir;
use std::path::{Path, PathBuf};

use super::gaze_table::is_on_surface;

/// Names and endings of files that only recordings of eye trackers contain besides gaze.
const RECORDED: [&str; 7] = ["raw", "time", "pldata", "npy", "mp4", "bin", "json"];
/// Largest number of folder entries that are examined.
const MAX_ENTRIES: usize = 10_000;

/// What was found instead of gaze on the display, and how gaze on the display can be made from it.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TrackerFinding {
    pub found: String,
    pub remedy: String,
}

const PLAYER: &str = "open the recording in Pupil Player with the plugin Surface Tracker and export \
                      gaze_positions_on_surface_NAME.csv in exports/000/surfaces";
const NEON: &str = "open the recording in Neon Player with the plugin Surface Tracking and export \
                    gaze_positions_on_surface_NAME.csv; or give gaze.csv of Pupil Cloud's Marker Mapper";
const CLOUD: &str = "Pupil Cloud's Marker Mapper: gaze.csv of its download; or the native recording data, exported by \
                     Neon Player with the \
                     plugin Surface Tracking";

/// What a path contains, if it belongs to an eye tracker's program and is no gaze on the display; else `None`.
pub(super) fn tracker_data(path: &Path) -> Option<TrackerFinding> {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    if path.is_dir() {
        return folder(path).or_else(|| sub_folders(path).iter().find_map(|sub| folder(sub)));
    }
    if extension == "zip" {
        let remedy = "unpack the archive, and give the table in it: gaze_positions_on_surface_NAME.csv, or gaze.csv of Marker \
             Mapper";
        return Some(TrackerFinding { found: "an archive".to_string(), remedy: remedy.to_string() });
    }
    path.parent().filter(|_| RECORDED.contains(&extension)).and_then(folder)
}

/// What a folder of an eye tracker's program contains, judged by the names of its files.
fn folder(folder: &Path) -> Option<TrackerFinding> {
    let names = names(folder);
    let has = |name: &str| names.iter().any(|found| found == name);
    let with = |begin: &str, end: &str| names.iter().find(|name| name.starts_with(begin) && name.ends_with(end));
    let finding = |name: &str, what: &str, remedy: &str| {
        let found = format!("{name}: {what}, with gaze in the scene camera's picture");
        Some(TrackerFinding { found, remedy: remedy.to_string() })
    };
    if let Some(table) = table_in(folder, &names) {
        let found = "a folder with a table of gaze on the display".to_string();
        return Some(TrackerFinding { found, remedy: format!("the table itself: {}", table.display()) });
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

/// Path of the table of gaze on the display in a folder of exports.
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
