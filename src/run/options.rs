//! Requests of `tomcom operate`, and overrides of session settings by the command line.

use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::analysis::watcher::CompareRequest;
use crate::communication::concept::ConceptName;
use crate::edge::file_error::FileResult;
use crate::edge::files::{self, SessionFiles};
use crate::kitchen::Kitchen;
use crate::session::Header;
use crate::session::plan::PlanSpec;
use crate::session::settings::{ArmKind, Condition, GazeSource, ParticipantKind, SettingError};

/// Start of a session.
#[derive(Clone, Debug)]
pub enum SessionStart {
    /// A repeated trial in another recording in `out`: its header and kitchen.
    Again {
        /// The header of the new recording.
        header: Box<Header>,
        /// The kitchen that the header describes.
        kitchen: Arc<Kitchen>,
        /// The folder for the recording's folder.
        out: PathBuf,
    },
    /// A new session with these settings, recorded in `out`; `trial` distinguishes sessions with the same seed.
    New {
        /// The settings with their files.
        files: Box<SessionFiles>,
        /// Which trial of its seed it is.
        trial: u64,
        /// The folder for the recording's folder.
        out: PathBuf,
    },
    /// The session of a recording that was cut off.
    Continued(PathBuf),
}

/// The remaining recordings of a participant of a plan.
#[derive(Clone, Debug)]
pub struct RemainingTrials {
    /// The settings with the plan.
    pub files: SessionFiles,
    /// Index of the participant in the plan.
    pub participant: usize,
    /// Folder of its recordings.
    pub out: PathBuf,
    /// Comparison of wizard and assistants, if it is shown.
    pub compare: Option<CompareRequest>,
}

/// Session settings that the command line overrides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SettingOverrides {
    /// Who plays the human's part.
    pub participant: Option<ParticipantKind>,
    /// Which arm carries out the robot's presses.
    pub arm: Option<ArmKind>,
    /// Where gaze samples come from.
    pub gaze: Option<GazeSource>,
    /// Address of the display's server.
    pub listen: Option<IpAddr>,
    /// File from which gaze is replayed.
    pub gaze_file: Option<PathBuf>,
    /// Time in that file at which the trial starts, in seconds.
    pub gaze_start_s: Option<f64>,
    /// Who may send signals.
    pub condition: Option<Condition>,
    /// The assistant's communication concept.
    pub concept: Option<ConceptName>,
    /// The seed of everything random.
    pub seed: Option<u64>,
    /// The participant's code.
    pub code: Option<String>,
    /// Where Rerun's viewers connect: "ADDRESS:PORT".
    pub rerun_listen: Option<String>,
}

impl SettingOverrides {
    /// Applies the overrides. If a person replaces the simulated participant and no gaze source is given, the mouse pointer serves
    /// as gaze.
    ///
    /// # Errors
    /// Settings that exclude each other.
    pub fn apply(self, files: &mut SessionFiles) -> Result<(), SettingError> {
        let spec = &mut files.spec;
        let decided = [("--condition", self.condition.is_some()), ("--seed", self.seed.is_some())];
        if let Some((key, _)) = decided.into_iter().find(|(_, is_given)| *is_given && spec.plan.is_some()) {
            let found = format!("{key}, with a session that has a plan");
            let remedy = "the plan decides it: groups and conditions follow from it";
            return Err(SettingError::new(key, found, remedy));
        }
        spec.seed = self.seed.unwrap_or(spec.seed);
        spec.robot.arm = self.arm.unwrap_or(spec.robot.arm);
        spec.trial.condition = self.condition.unwrap_or(spec.trial.condition);
        spec.assistant.concept = self.concept.unwrap_or(spec.assistant.concept);
        spec.display.listen = self.listen.unwrap_or(spec.display.listen);
        if let Some(listen) = self.rerun_listen {
            spec.rerun.address = listen;
            spec.rerun.live = true;
        }
        if let Some(file) = &self.gaze_file {
            spec.tracker.file = Some(file.display().to_string());
        }
        spec.tracker.file_start_s = self.gaze_start_s.unwrap_or(spec.tracker.file_start_s);
        let participant = &mut spec.participant;
        participant.code = self.code.unwrap_or(std::mem::take(&mut participant.code));
        participant.kind = self.participant.unwrap_or(participant.kind);
        let gaze = self.gaze.or(self.gaze_file.is_some().then_some(GazeSource::File));
        participant.gaze = match (gaze, self.participant, participant.gaze) {
            (Some(gaze), _, _) => gaze,
            (None, Some(ParticipantKind::Keyboard | ParticipantKind::Display), GazeSource::Simulated) => {
                GazeSource::Mouse
            }
            (None, _, gaze) => gaze,
        };
        spec.check()?;
        spec.check_participant_codes()
    }
}

/// Index of the participant with this code in a plan.
///
/// # Errors
/// The code is missing or not in the plan.
pub fn participant_of_plan(plan: &PlanSpec, code: Option<&str>) -> Result<usize, SettingError> {
    let remedy = "--code with one of the codes that tomcom plan SESSION lists";
    let wrong = |found: String| SettingError::new("code", found, remedy);
    let code = code.ok_or_else(|| wrong(format!("the plan \"{}\", and no participant", plan.name)))?;
    let place = plan.codes().iter().position(|one| one == code);
    place.ok_or_else(|| wrong(format!("--code {code}, who is not in the plan \"{}\"", plan.name)))
}

/// Reads the given session file, else `sessions/default.toml` if it exists, else the built-in default session.
///
/// # Errors
/// Errors of [`files::read_session`].
pub fn session_or_default(path: Option<&Path>) -> FileResult<SessionFiles> {
    let default = Path::new("sessions/default.toml");
    match path {
        Some(path) => files::read_session(path),
        None if default.exists() => files::read_session(default),
        None => files::built_in_session(),
    }
}
