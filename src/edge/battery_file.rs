//! Reads the file of a battery (several cohorts of simulated participants), with the session file that it names.

use std::ops::Range;
use std::path::Path;

use crate::edge::files::read_session;
use tomcom_session::battery::{BatterySpec, CohortSpec};
use tomcom_session::files::SessionSetup;
use tomcom_session::files::file_error::place_of;
use tomcom_session::files::file_error::{FileError, FileResult, missing, read_text};
use tomcom_session::files::parse::parse;
use tomcom_session::settings::{Condition, GazeSource, ParticipantKind, SettingError};

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
    let session = read_session(&session_path)?;
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
