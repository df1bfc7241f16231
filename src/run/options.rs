//! Options of `tomcom operate`: what to run, and settings that replace those of the session file.

use std::net::{IpAddr, SocketAddr};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::run::files;
use tomcom_core::communication::settings::ConceptSpec;
use tomcom_core::kitchen::Kitchen;
use tomcom_session::LogHeader;
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::FileResult;
use tomcom_session::files::near_path::SESSIONS;
use tomcom_session::person_code;
use tomcom_session::plan::PlanSpec;
use tomcom_session::settings::{ArmKind, Condition, GazeSource, ParticipantKind, SettingError};
use tomcom_session::watcher::SenderComparisonSettings;

/// What a live session starts from: a new session, a repeated trial, or a recording to continue.
#[derive(Clone, Debug)]
pub enum SessionStart {
    /// Repetition of a trial in a new recording in the folder `out`.
    Again { header: Box<LogHeader>, kitchen: Arc<Kitchen>, out: PathBuf },
    /// A new session with these settings, recorded in `out`; `trial` distinguishes sessions with the same seed.
    New {
        files: Box<SessionSetup>,
        /// Index of the trial among trials with the same seed.
        trial: u64,
        out: PathBuf,
    },
    /// Continuation of a recording that was cut off.
    Continued(PathBuf),
}

/// A request to make the recordings that a participant in a study plan still needs.
#[derive(Clone, Debug)]
pub struct SeriesRequest {
    /// Session settings that contain the study plan.
    pub files: SessionSetup,
    /// Index of the participant in the plan.
    pub participant: usize,
    /// Folder of the participant's recordings.
    pub out: PathBuf,
    /// Kind of participant, if the command line names it.
    pub kind: Option<ParticipantKind>,
    pub compare: Option<SenderComparisonSettings>,
    /// Address at which observers can watch the wizard's screen.
    pub observe: Option<SocketAddr>,
    /// File of the frozen plan that was asked for.
    pub frozen: Option<PathBuf>,
}

/// Session settings given on the command line; `None` keeps the session file's value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SettingOverrides {
    pub participant: Option<ParticipantKind>,
    pub arm: Option<ArmKind>,
    pub gaze: Option<GazeSource>,
    /// Network address of the server of the participant's display.
    pub listen: Option<IpAddr>,
    /// Path of the file from which gaze is replayed.
    pub gaze_file: Option<PathBuf>,
    /// Time in the gaze file at which the trial starts, in seconds after the first sample.
    pub gaze_start_s: Option<f64>,
    pub condition: Option<Condition>,
    pub concept: Option<ConceptSpec>,
    pub seed: Option<u64>,
    /// The participant's pseudonymous code, such as P01.
    pub code: Option<String>,
    /// Address at which Rerun viewers connect, as "ADDRESS:PORT".
    pub rerun_listen: Option<String>,
}

impl SettingOverrides {
    /// Applies the settings of the command line. If a person replaces the simulated participant and no gaze source is
    /// given, the mouse pointer serves as gaze.
    ///
    /// # Errors
    /// The settings exclude each other.
    pub fn apply(self, files: &mut SessionSetup) -> Result<(), SettingError> {
        let spec = &mut files.spec;
        let decided = [("--condition", self.condition.is_some()), ("--seed", self.seed.is_some())];
        if let Some((key, _)) = decided.into_iter().find(|(_, is_given)| *is_given && spec.plan.is_some()) {
            let found = format!("{key}, with a session file that has a plan");
            let remedy = format!("no {key}: the plan of the study decides about conditions and seed");
            return Err(SettingError::new(key, found, remedy));
        }
        spec.seed = self.seed.unwrap_or(spec.seed);
        spec.robot.arm = self.arm.unwrap_or(spec.robot.arm);
        spec.trial.condition = self.condition.unwrap_or(spec.trial.condition);
        if let Some(concept) = self.concept {
            spec.assistant.concept = concept;
        }
        spec.display.listen = self.listen.unwrap_or(spec.display.listen);
        if let Some(listen) = self.rerun_listen {
            spec.rerun.address = listen;
            spec.rerun.live = true;
        }
        if let Some(file) = &self.gaze_file {
            // A recording's header has its settings as text.
            let wrong = || SettingError::new("--gaze-file", format!("{}, no UTF-8", file.display()), "a path in UTF-8");
            spec.tracker.file = Some(file.to_str().ok_or_else(wrong)?.to_string());
        }
        spec.tracker.file_start_s = self.gaze_start_s.unwrap_or(spec.tracker.file_start_s);
        let participant = &mut spec.participant;
        participant.code = self.code.unwrap_or(std::mem::take(&mut participant.code));
        if let Some(kind) = self.participant {
            (participant.kind, participant.external) = (kind, None);
            participant.button_box.take_if(|_| kind == ParticipantKind::Simulated);
        }
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

/// Index of the participant with this code in a plan.
///
/// # Errors
/// No code was given, or the code is not in the plan.
pub fn participant_of_plan(plan: &PlanSpec, code: Option<&str>) -> Result<usize, SettingError> {
    let codes = plan.codes();
    let remedy = format!("--code with a code of the plan: {}", person_code::listed(&codes));
    let wrong = |found: String| SettingError::new("code", found, remedy);
    let Some(code) = code else {
        return Err(wrong(format!("the plan \"{}\", and no code of a participant", plan.name)));
    };
    codes.iter().position(|one| one == code).ok_or_else(|| {
        let near = person_code::did_you_mean(code, &codes);
        wrong(format!("--code {code}, a participant who is not in the plan \"{}\"{near}", plan.name))
    })
}

/// The session of commands that are given none.
pub const DEFAULT_SESSION: &str = "sessions/default.toml";
/// Folder of recordings, where a command line names none.
pub const DEFAULT_OUT: &str = SESSIONS;

/// Reads the given session file, or else that of the default session.
///
/// # Errors
/// The errors of [`files::read_session`].
pub fn session_or_default(path: Option<&Path>) -> FileResult<SessionSetup> {
    files::read_session(path.unwrap_or(Path::new(DEFAULT_SESSION)))
}
