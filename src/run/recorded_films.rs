//! Films that live sessions recorded, after their recordings are over: ffmpeg closes them, and they are attached, on
//! threads of their own while the wizard goes on.

use std::path::PathBuf;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::film::{self, FilmAlignmentRequest};
use super::terminal::print;
use tomcom_devices::film_recorder::FilmRecorder;

/// Time in which ffmpeg closes a film.
const CLOSES_WITHIN: Duration = Duration::from_secs(10);

/// Films that are being attached. The end of this value waits for them, and says what became of them: it stands behind the
/// terminal's, which is given back before.
#[derive(Default)]
pub(super) struct RecordedFilms {
    /// What became of the films of a recording, in words.
    attaching: Vec<JoinHandle<String>>,
}

impl RecordedFilms {
    /// Closes the films of a recording that is over, and attaches them to it.
    pub fn close(&mut self, mut films: Vec<FilmRecorder>, folder: PathBuf) {
        self.attaching.push(thread::spawn(move || {
            films.iter_mut().for_each(FilmRecorder::ask_to_end);
            films.into_iter().for_each(|film| film.finish(CLOSES_WITHIN));
            match film::attach(&folder, &[], FilmAlignmentRequest::Flashes, film::FilmPlace::Stays, || ()) {
                Ok(attached) => attached.iter().map(|film| film::describe(film) + "\n").collect(),
                Err(error) => format!("the films in {} are not attached: {error}\n", folder.display()),
            }
        }));
    }
}

impl Drop for RecordedFilms {
    fn drop(&mut self) {
        let tell = |text: String| {
            // Nobody is left to be told that.
            let _ = print(true, text.into_bytes());
        };
        if self.attaching.iter().any(|one| !one.is_finished()) {
            tell("films are being attached; ctrl+c leaves that to tomcom video attach RECORDING\n".to_string());
        }
        for one in self.attaching.drain(..) {
            tell(one.join().unwrap_or_default());
        }
    }
}
