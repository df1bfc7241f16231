//! The file `video.json` beside a log: the films that were attached to a recording, and how their time follows from
//! session time. The films themselves stay where they are, unless they were copied.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::file_error::{FileError, FileResult, read_regular};
use crate::files::replace_file;
use crate::log::RecordingWriteError;
use tomcom_core::base::text::PathText;
use tomcom_core::base::time::SessionTime;

pub const VIDEO_NAME: &str = "video.json";

const REMEDY: &str = "the file as tomcom video attach writes it; without it, attach the films again";

/// How the alignment of a film was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilmAlignmentSource {
    /// By the flashes of the participant's page.
    Flashes,
    /// By the times at which the cameras took their pictures, since the program recorded the film.
    Recorded,
    /// By the clock of Pupil Capture, which recorded film and gaze.
    PupilClock,
    /// Somebody gave the offset.
    Offset,
    /// Somebody gave the time in the film at which the trial starts.
    TrialStart,
}

/// A film of a recording. A moment of the session `t` is in the film at `offset_s + t (1 + drift_ppm / 10^6)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AttachedFilm {
    /// The name of a file in the recording's folder, or a whole path.
    pub file: PathText,
    /// Of the film's content, in hexadecimal digits.
    pub sha256: String,
    pub by: FilmAlignmentSource,
    /// Time in the film at which the session begins, in seconds; negative if the film begins later.
    pub offset_s: f64,
    /// How much faster the film's clock goes than session time.
    pub drift_ppm: f64,
    /// Largest distance of a flash in the film from where the alignment puts it; of Pupil's clock, what 99 % of gaze samples
    /// are within.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_ms: Option<f64>,
    /// Number of flashes that the alignment stands on; absent without flashes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flashes: Option<u64>,
    /// Duration of one frame; absent where the film was not decoded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame_ms: Option<f64>,
    /// Absent where nothing was known of it when the film was attached.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length_s: Option<f64>,
    /// Where the films are from which this one was copied or converted; as [`AttachedFilm::file`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub copies_of: Vec<PathText>,
}

impl AttachedFilm {
    /// Time in the film of a moment of the session, in seconds; negative before the film begins.
    pub fn film_s(&self, time: SessionTime) -> f64 {
        self.offset_s + time.as_secs_f64() * (1.0 + self.drift_ppm * 1e-6)
    }

    /// That a moment of the session is not in the film, in words; `None` if it is, or if the film's length is not known.
    pub fn outside(&self, time: SessionTime) -> Option<&'static str> {
        let film_s = self.film_s(time);
        match self.length_s {
            _ if film_s < 0.0 => Some("before the film"),
            Some(length_s) if film_s > length_s => Some("after the film"),
            _ => None,
        }
    }

    /// Session time in seconds of a time in the film; negative before the session begins.
    pub fn session_s(&self, film_s: f64) -> f64 {
        (film_s - self.offset_s) / (1.0 + self.drift_ppm * 1e-6)
    }

    /// Path of the film.
    pub fn path(&self, folder: &Path) -> PathBuf {
        folder.join(&self.file)
    }

    /// The film, and those that it is a copy of.
    pub fn files(&self) -> impl Iterator<Item = &PathText> {
        std::iter::once(&self.file).chain(&self.copies_of)
    }
}

/// Whether a path is the name of a file alone, so that it lies in the recording's folder.
pub fn is_name(path: &Path) -> bool {
    path.file_name().is_some_and(|name| path.as_os_str() == name)
}

/// All films of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingFilms {
    pub films: Vec<AttachedFilm>,
}

impl RecordingFilms {
    /// Adds a film; an earlier alignment of the same file is replaced.
    pub fn attach(&mut self, film: AttachedFilm) {
        match self.films.iter_mut().find(|old| old.file == film.file) {
            Some(old) => *old = film,
            None => self.films.push(film),
        }
    }
}

/// The films of the recording in a folder; none if there is no such file.
pub fn read(folder: &Path) -> FileResult<RecordingFilms> {
    let path = folder.join(VIDEO_NAME);
    let text = match read_regular(&path) {
        Ok(text) => text,
        Err(reason) if reason.kind() == ErrorKind::NotFound => return Ok(RecordingFilms::default()),
        Err(reason) => return Err(FileError::unreadable(&path, reason, REMEDY)),
    };
    let films: RecordingFilms = serde_json::from_str(&text).map_err(|error| {
        let before: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let place = before + error.column().saturating_sub(1);
        FileError::at(&path, &text, Some(place..place), error.to_string(), REMEDY)
    })?;
    let is_fit = |film: &AttachedFilm| {
        let is_place = |file: &PathText| is_name(file) || file.is_absolute();
        film.offset_s.is_finite() && film.drift_ppm.is_finite() && film.files().all(is_place)
    };
    match films.films.iter().find(|film| !is_fit(film)) {
        None => Ok(films),
        Some(film) => {
            let found = format!("the film \"{}\", which is no name of a file here and no whole path", film.file);
            Err(FileError::from_finding(&path, found, REMEDY))
        }
    }
}

pub fn write(folder: &Path, films: &RecordingFilms) -> Result<(), RecordingWriteError> {
    let path = folder.join(VIDEO_NAME);
    let text = serde_json::to_string_pretty(films).map_err(std::io::Error::other);
    let written = text.and_then(|text| replace_file::replace(&path, (text + "\n").as_bytes()));
    written.map_err(|reason| RecordingWriteError::unwritable(&path, reason))
}
