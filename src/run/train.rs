//! Command `tomcom train`: a wizard watches recordings with known false beliefs, sends signals with the usual keys, and
//! gets feedback on each signal and a score that is compared with a criterion. The recorded participant does not see
//! the signals.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::error::ReviewError;
use super::event_loop;
use super::leaving::LeavingReason;
use super::operator_station::OperatorStation;
use super::seekable_replay::SeekableReplay;
use super::training_shell::TrainingShell;
use crate::console::console_model::SPEEDS;
use tomcom_core::measures::wizard_performance::{FalseBeliefPeriod, TrainingCriterion, WizardMeasures};
use tomcom_session::files::WallTime;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::settings::{Condition, WizardVisibility};
use tomcom_session::wizard_log::false_belief_periods;
use tomcom_study::analysis::lesson_report::{WatchedRecording, WizardTrainingRecord};
use tomcom_study::files::training;

/// Request of `tomcom train`.
#[derive(Clone, Debug)]
pub struct WizardTrainingRequest {
    /// Recordings of simulated participants without signals, which the wizard watches.
    pub recordings: Vec<PathBuf>,
    pub wizard: String,
    pub out: PathBuf,
    pub criterion: TrainingCriterion,
    /// Playback speed, as an index into [`SPEEDS`].
    pub speed: usize,
}

/// Trains a wizard at the console. Returns the record and the file to which it was written.
///
/// # Errors
/// A recording is not suitable, there is no terminal, or the result cannot be written.
pub fn train(lesson: &WizardTrainingRequest) -> Result<(WizardTrainingRecord, PathBuf), ReviewError> {
    let before = training::read(&lesson.out, &lesson.wizard)?;
    let films: Vec<(SeekableReplay, Vec<FalseBeliefPeriod>)> =
        lesson.recordings.iter().map(|one| open(one)).collect::<FileResult<_>>()?;
    let at = WallTime::now().rfc3339();
    let began = Instant::now();
    let recordings = event_loop::in_runtime(watch(lesson, films, &before))?;
    let minutes = (began.elapsed().as_secs_f64() / 0.6).round() / 100.0;
    let is_complete = recordings.len() == lesson.recordings.len() && recordings.iter().all(|one| one.complete);
    let met = is_complete && lesson.criterion.is_met(&WizardMeasures::sum(recordings.iter().map(|one| &one.measures)));
    let (wizard, criterion, speed) = (lesson.wizard.clone(), lesson.criterion, SPEEDS[lesson.speed]);
    let record = WizardTrainingRecord { wizard, at, minutes, speed, criterion, met, recordings };
    let path = training::write(&lesson.out, &record)
        .map_err(|reason| ReviewError::Training { path: lesson.out.clone(), reason })?;
    Ok((record, path))
}

/// Opens a recording for training, together with its periods of false belief.
fn open(recording: &Path) -> FileResult<(SeekableReplay, Vec<FalseBeliefPeriod>)> {
    let mut film = SeekableReplay::open(recording)?;
    let unfit = |found: &str| {
        let remedy = "a recording of a simulated participant without signals (tomcom simulate SESSION)".to_string();
        FileError::from_finding(recording, found.to_string(), remedy)
    };
    if film.session.spec.trial.condition != Condition::None {
        return Err(unfit("a trial in which somebody sends signals"));
    }
    let periods = false_belief_periods(&film.replay.follower)
        .ok_or_else(|| unfit("a trial in which the participant's beliefs are not known"))?;
    // The recording is shown as a wizard session with the information that the paper's wizard had.
    film.session.spec.trial.condition = Condition::Wizard;
    film.session.spec.console.visibility = WizardVisibility::State;
    Ok((film, periods))
}

/// Plays one recording after another until all recordings are finished or the wizard quits.
async fn watch(
    lesson: &WizardTrainingRequest,
    films: Vec<(SeekableReplay, Vec<FalseBeliefPeriod>)>,
    before: &[WizardTrainingRecord],
) -> Result<Vec<WatchedRecording>, ReviewError> {
    let mut judged = Vec::new();
    let mut station = None;
    for ((film, periods), recording) in films.into_iter().zip(&lesson.recordings) {
        let station = match &mut station {
            Some(station) => station,
            none => none.insert(OperatorStation::without_devices(&film.session.spec.console)?),
        };
        let mut shell =
            TrainingShell::new(film, periods, name_of(recording, lesson), lesson.criterion, lesson.speed, station)?;
        let left = event_loop::run(&mut shell, station).await?;
        judged.push(shell.judged(before));
        if left != Some(LeavingReason::Next) {
            break;
        }
    }
    Ok(judged)
}

/// Name of a recording in training records; if the recording was simulated for training, the name includes its length.
fn name_of(recording: &Path, lesson: &WizardTrainingRequest) -> String {
    let simulated = recording.strip_prefix(lesson.out.join("recordings")).ok();
    let name = simulated.or(recording.file_name().map(Path::new)).unwrap_or(recording);
    name.display().to_string()
}
