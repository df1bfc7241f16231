//! What `tomcom operate` is asked for, and what the command line changes in a session file.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::edge::files::{self, FileResult, SessionFiles};
use crate::kitchen::Kitchen;
use crate::session::Header;
use crate::session::settings::{Condition, GazeSource, ParticipantKind, SettingError};

/// What `tomcom operate` is asked for.
#[derive(Clone, Debug)]
pub enum Beginning {
    /// A new session with these settings, recorded in a folder in `out`.
    New { files: Box<SessionFiles>, out: PathBuf },
    /// A trial that is done again, in another recording in `out`: the header of that, and the kitchen that it describes.
    Again { header: Box<Header>, kitchen: Arc<Kitchen>, out: PathBuf },
    /// The session of this recording, which was cut.
    Continued(PathBuf),
}

/// Settings of the session file that arguments replace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overrides {
    pub participant: Option<ParticipantKind>,
    pub gaze: Option<GazeSource>,
    pub condition: Option<Condition>,
    pub seed: Option<u64>,
}

impl Overrides {
    /// Replaces the settings. Where a person takes the simulated participant's place and nothing is said about the gaze,
    /// the mouse pointer stands for it.
    ///
    /// # Errors
    /// Settings that exclude each other.
    pub fn apply(self, files: &mut SessionFiles) -> Result<(), SettingError> {
        let spec = &mut files.spec;
        spec.seed = self.seed.unwrap_or(spec.seed);
        spec.trial.condition = self.condition.unwrap_or(spec.trial.condition);
        let participant = &mut spec.participant;
        participant.kind = self.participant.unwrap_or(participant.kind);
        participant.gaze = match (self.gaze, self.participant, participant.gaze) {
            (Some(gaze), _, _) => gaze,
            (None, Some(ParticipantKind::Keyboard), GazeSource::Simulated) => GazeSource::Mouse,
            (None, _, gaze) => gaze,
        };
        spec.check()
    }
}

/// The session file that was named; else `sessions/default.toml` if it is there; else the one that the program carries.
///
/// # Errors
/// Those of [`files::read_session`].
pub fn session_or_default(path: Option<&Path>) -> FileResult<SessionFiles> {
    let default = Path::new("sessions/default.toml");
    match path {
        Some(path) => files::read_session(path),
        None if default.exists() => files::read_session(default),
        None => files::built_in_session(),
    }
}
