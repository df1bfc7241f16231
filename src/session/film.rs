//! Films of the room that the program records: the cameras in the settings, and what happens to their films.

use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::settings::SettingError;
use tomcom_core::base::time::SessionTime;

const MOST_CAMERAS: usize = 8;
const REMEDY: &str = "1 to 8 cameras, each as the path of a Video4Linux device, such as \"/dev/video0\", or as the words with which \
                      ffmpeg reads it, such as \"-i rtsp://10.0.0.7/stream\"";

/// The cameras that film each trial.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VideoSpec {
    /// Paths of devices, or arguments of ffmpeg up to its input.
    pub devices: Vec<String>,
}

impl VideoSpec {
    pub(crate) fn check(&self) -> Result<(), SettingError> {
        let is_known = (1..=MOST_CAMERAS).contains(&self.devices.len());
        if is_known && self.devices.iter().all(|device| ffmpeg_input(device).is_some()) {
            return Ok(());
        }
        Err(SettingError::new("video.devices", format!("devices = {:?}", self.devices), REMEDY))
    }
}

/// The path, if a camera is given as that of a Video4Linux device.
pub fn device_path(device: &str) -> Option<&str> {
    device.starts_with('/').then_some(device)
}

/// Arguments with which ffmpeg reads a camera; the times of its pictures are those of the wall clock. `None`: it is none.
pub fn ffmpeg_input(device: &str) -> Option<Vec<String>> {
    if device.chars().any(char::is_control) {
        return None;
    }
    let mut words: Vec<String> = match device_path(device) {
        Some(path) => ["-f", "v4l2", "-i", path].map(str::to_string).to_vec(),
        None => device.split_whitespace().map(str::to_string).collect(),
    };
    let inputs: Vec<usize> = words.iter().enumerate().filter(|(_, word)| *word == "-i").map(|(at, _)| at).collect();
    let has_one = words.first().is_some_and(|word| word.starts_with('-')) && inputs == [words.len().checked_sub(2)?];
    // A driver of Video4Linux stamps its pictures when they are taken.
    let stamps =
        if words.iter().any(|word| word == "v4l2") { ["-ts", "abs"] } else { ["-use_wallclock_as_timestamps", "1"] };
    words.splice(inputs.first()?..inputs.first()?, stamps.map(str::to_string));
    has_one.then_some(words)
}

/// Name of a camera's film in the folder of its recording; cameras count from 1.
pub fn film_name(camera: u32) -> String {
    format!("film-{camera}.mp4")
}

/// Whether a file has the name of a film that the program records.
pub fn is_recorded_film(name: &str) -> bool {
    let camera = name.strip_prefix("film-").and_then(|name| name.strip_suffix(".mp4"));
    camera.and_then(|camera| camera.parse().ok()).is_some_and(|camera| film_name(camera) == name)
}

/// All of them come from outside. Cameras count from 1, as in the settings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum FilmEvent {
    /// Its first picture has arrived.
    Began {
        camera: u32,
        /// Name in the recording's folder.
        file: String,
        /// When its first picture was taken, at which the time of the film begins.
        began_ns: SessionTime,
    },
    /// No picture arrives any more, or none has arrived.
    Lost { camera: u32, reason: String },
    /// Pictures arrive again.
    Back { camera: u32 },
}

impl FilmEvent {
    pub fn words(&self) -> String {
        match self {
            FilmEvent::Began { camera, file, .. } => format!("camera {camera} films: {file}"),
            FilmEvent::Lost { camera, reason } => format!("camera {camera} is lost, the session goes on: {reason}"),
            FilmEvent::Back { camera } => format!("camera {camera} is back"),
        }
    }
}

pub(crate) fn admit(event: &FilmEvent) -> Result<(), &'static str> {
    let is_named = !matches!(event, FilmEvent::Began { file, .. } if !is_recorded_film(file));
    unless(is_named, "a camera's film has another name")
}
