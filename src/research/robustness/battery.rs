//! A battery of cohorts: populations of simulated people to whom the assistant's human model was not fitted, to test
//! how well the estimate and the assistant work with other people. Reads its file, with the session file that it names.

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use tomcom_core::communication::settings::ShadowMode;
use tomcom_people::participant::population::Population;
use tomcom_session::files::file_error::{FileError, FileResult, missing, read_text};
use tomcom_session::files::parse::{FileKind, ParsedFile, parse};
use tomcom_session::files::file_error::place_of;
use tomcom_session::files::{SessionSetup, read_session};
use tomcom_session::settings::{Condition, GazeSource, ParticipantKind, SessionSpec, SettingError};
use toml::Spanned;

/// A file with a battery of cohorts (populations of simulated people).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatterySpec {
    /// The session file of all cohorts, relative to the battery's file.
    pub session: Spanned<String>,
    /// The cohorts of simulated people, in the order of the results table.
    #[serde(rename = "cohort")]
    pub cohorts: Vec<CohortSpec>,
}

/// A cohort of a battery: the population of its simulated people, and other differences from the session file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CohortSpec {
    /// Name of the cohort in the results table.
    pub name: Spanned<String>,
    /// The cohort's source of gaze, if it differs from that of the session file.
    pub gaze: Option<Spanned<GazeSource>>,
    /// The population of simulated people in the cohort; traits that are not named have their defaults, as in session
    /// files.
    pub population: Option<Population>,
}

impl CohortSpec {
    /// The settings of the cohort's simulated trials, in which the assistant acts by itself or nobody sends signals.
    pub fn settings(&self, session: &SessionSpec, condition: Condition) -> SessionSpec {
        let mut spec = session.clone();
        spec.plan = None;
        spec.trial.condition = condition;
        // Nobody would see the assistant's advice in these trials, so the advice is not computed.
        spec.assistant.shadow = ShadowMode::Off;
        if let Some(gaze) = &self.gaze {
            spec.participant.gaze = *gaze.get_ref();
        }
        if let Some(population) = &self.population {
            spec.participant.population = Some(population.clone());
        }
        spec
    }
}

impl ParsedFile for BatterySpec {
    const KIND: FileKind = FileKind::Battery;
}

/// A battery: cohorts of simulated participants, with the session settings that the cohorts share.
#[derive(Clone, Debug)]
pub struct CohortBattery {
    /// Session settings that all cohorts share, with their files.
    pub session: SessionSetup,
    /// Cohorts of simulated participants, in the order of the battery file.
    pub cohorts: Vec<CohortSpec>,
}

/// Reads a battery file and the session file that it names.
///
/// # Errors
/// A file cannot be read, the session's participant or gaze is not simulated, or a cohort has an invalid setting.
pub fn read_battery(path: &Path) -> FileResult<CohortBattery> {
    let text = read_text(path)?;
    let spec: BatterySpec = parse(path, &text)?;
    let file = spec.session.get_ref();
    let session_path = path.parent().unwrap_or(Path::new(".")).join(file);
    if let Err(reason) = std::fs::metadata(&session_path) {
        let remedy = "the path of a session file, relative to the battery's file";
        return Err(missing(path, &text, ("session", 0, file), reason, remedy));
    }
    let session = read_session(&session_path, None)?;
    let wrong = |span: Range<usize>, found: String, remedy: &str| {
        Err(FileError::at(path, &text, Some(span), found, remedy.to_string()))
    };
    let participant = &session.spec.participant;
    if participant.kind != ParticipantKind::Simulated || !is_simulated(participant.gaze) {
        let found = format!("session = \"{file}\", a session file whose participant or gaze is not simulated");
        let remedy = "a session file with kind = \"simulated\", and gaze = \"simulated\" or \"none\"";
        return wrong(spec.session.span(), found, remedy);
    }
    for (index, cohort) in spec.cohorts.iter().enumerate() {
        let name = cohort.name.get_ref();
        if name.trim().is_empty() || spec.cohorts[..index].iter().any(|other| other.name.get_ref() == name) {
            return wrong(cohort.name.span(), format!("name = \"{name}\""), "a name that no other cohort has");
        }
        if let Some(gaze) = cohort.gaze.as_ref().filter(|gaze| !is_simulated(*gaze.get_ref())) {
            let found = "gaze that is not simulated".to_string();
            return wrong(gaze.span(), found, "gaze = \"simulated\" or \"none\"");
        }
        if let Err(error) = cohort.settings(&session.spec, Condition::None).check() {
            let place = place_in_cohort(&text, cohort, &error);
            return Err(FileError::at(path, &text, Some(place), error.found, error.remedy.into_owned()));
        }
    }
    if spec.cohorts.is_empty() {
        return wrong(0..0, "a battery without cohorts".to_string(), "at least one [[cohort]] with a name");
    }
    Ok(CohortBattery { session, cohorts: spec.cohorts })
}

fn is_simulated(gaze: GazeSource) -> bool {
    matches!(gaze, GazeSource::Simulated | GazeSource::None)
}

/// Position of a cohort's invalid setting in the battery file: the first setting of its name after the cohort's name.
fn place_in_cohort(text: &str, cohort: &CohortSpec, error: &SettingError) -> Range<usize> {
    let name = cohort.name.span();
    let path = error.path.strip_prefix("participant.").unwrap_or(&error.path);
    let places = (0..).map_while(|nth| place_of(text, path, nth));
    places.filter(|place| place.start > name.start).min_by_key(|place| place.start).unwrap_or(name)
}
