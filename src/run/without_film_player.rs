//! Films are not shown beside a replay on systems without Unix sockets.

use std::path::Path;

use tomcom_core::base::time::SessionTime;
use tomcom_session::log::video_file::AttachedFilm;

/// There are none.
pub struct FilmPlayer {
    pub film: AttachedFilm,
}

impl FilmPlayer {
    pub fn show(&mut self, _: SessionTime, _: f64) -> bool {
        false
    }
}

pub fn open_all(films: &[AttachedFilm], _: &Path) -> (Vec<FilmPlayer>, Option<String>) {
    let why = "mpv follows on Unix only";
    (Vec::new(), (!films.is_empty()).then(|| why.to_string()))
}
