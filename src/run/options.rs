//! What `tomcom operate` is asked for, and what the command line changes in a session file.

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

/// What `tomcom operate` is asked for.
#[derive(Clone, Debug)]
pub enum SessionStart {
    /// A trial that is done again, in another recording in `out`: the header of that, and the kitchen that it describes.
    Again { header: Box<Header>, kitchen: Arc<Kitchen>, out: PathBuf },
    /// A new session with these settings, recorded in a folder in `out`; `trial` tells it from others with the same seed.
    New { files: Box<SessionFiles>, trial: u64, out: PathBuf },
    /// The session of this recording, which was cut.
    Continued(PathBuf),
}

/// What is still to be done by a participant of a plan.
#[derive(Clone, Debug)]
pub struct TrialSeries {
    /// The settings with the plan.
    pub files: SessionFiles,
    /// The participant's place in the plan, from 0.
    pub participant: usize,
    /// Where its recordings are and come.
    pub out: PathBuf,
    /// Wizard and assistants are compared at the console.
    pub compare: Option<CompareRequest>,
}

/// Settings of the session file that arguments replace.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SettingOverrides {
    pub participant: Option<ParticipantKind>,
    pub arm: Option<ArmKind>,
    pub gaze: Option<GazeSource>,
    /// Where the display is served.
    pub listen: Option<IpAddr>,
    /// The file that gaze is replayed from.
    pub gaze_file: Option<PathBuf>,
    pub condition: Option<Condition>,
    pub concept: Option<ConceptName>,
    pub seed: Option<u64>,
    pub code: Option<String>,
    pub rerun_listen: Option<String>,
}

impl SettingOverrides {
    /// Replaces the settings. Where a person takes the simulated participant's place and nothing is said about the gaze,
    /// the mouse pointer stands for it.
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
        spec.check()
    }
}

/// The place of the participant with this code in a plan.
///
/// # Errors
/// No code, or one that is not in the plan.
pub fn participant_of_plan(plan: &PlanSpec, code: Option<&str>) -> Result<usize, SettingError> {
    let remedy = "--code with one of the codes that tomcom plan SESSION lists";
    let wrong = |found: String| SettingError::new("code", found, remedy);
    let code = code.ok_or_else(|| wrong(format!("the plan \"{}\", and no participant", plan.name)))?;
    let place = plan.codes().iter().position(|one| one == code);
    place.ok_or_else(|| wrong(format!("--code {code}, who is not in the plan \"{}\"", plan.name)))
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
