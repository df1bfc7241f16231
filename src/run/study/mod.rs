//! `tomcom study`: replays the recordings of a study on all processors and writes tables, charts and the report.

mod coded_errors;
mod frozen_check;
mod questionnaire_answers;
pub mod reading;
mod rows;
mod sweep;
mod tell;
mod tutorials;
mod twin;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use self::reading::{AnalysisScope, RecordingAnalysis};
pub use self::tell::{describe, describe_arms};
use super::replay::SameKitchen;
use super::{consents, parallel};
use crate::edge::export::{ExportError, ExportFolder};
use crate::edge::file_error::{FileError, FileResult};
use crate::edge::log::LogReader;
use crate::edge::recordings;
use crate::kitchen::Kitchen;
use crate::study::dictionary::{DictionaryRow, dictionary};
use crate::study::facts::Facts;
use crate::study::figures::StudySummary;
use crate::study::recorded_consent::RecordedConsent;
use crate::study::report;
use crate::study::tables::concept_table::{ConceptRow, concepts};
use crate::study::tables::participants::{ParticipantRow, participants};
use crate::study::tables::probe_table::{ProbeRow, probes};
use crate::study::tables::questionnaires::{AnswerRow, answers};
use crate::study::tables::tutorial_answers::TutorialAnswer;
use crate::study::trial_statistics::{Trial, arrange};

/// Reasons why a study could not be analysed.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum StudyError {
    /// A file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] Box<FileError>),
    /// A table cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Export(#[from] ExportError),
}

impl From<FileError> for StudyError {
    fn from(error: FileError) -> StudyError {
        StudyError::File(Box::new(error))
    }
}

/// Inputs and outputs of the analysis of a study.
#[derive(Clone, Debug)]
pub struct AnalysisRequest {
    /// Recordings, or folders that contain recordings.
    pub paths: Vec<PathBuf>,
    /// The folder for tables and report.
    pub out: PathBuf,
    /// How much is computed.
    pub extent: AnalysisScope,
    /// The two raters whose codes are taken; `None`: those with the most complete codes of each recording.
    pub raters: Option<[String; 2]>,
    /// The file of the frozen plan that the recordings are held against.
    pub frozen: Option<PathBuf>,
}

/// Recordings of an analysis, each with the name that identifies it in tables.
#[derive(Clone, Debug)]
pub struct NamedRecordings {
    found: Vec<(PathBuf, String)>,
}

impl NamedRecordings {
    /// Finds the recordings at these paths, each once.
    ///
    /// # Errors
    /// A path is neither a recording nor a folder with recordings.
    pub fn find(paths: &[PathBuf]) -> Result<NamedRecordings, StudyError> {
        let mut found: Vec<(PathBuf, String)> = Vec::new();
        for path in paths {
            for recording in recordings::of_folder(path)? {
                let name = name(&recording);
                if found.iter().all(|(other, _)| *other != recording) {
                    found.push((recording, name));
                }
            }
        }
        // Recordings from several folders with the same name are named by their full paths.
        let names: Vec<String> = found.iter().map(|(_, name)| name.clone()).collect();
        for (path, name) in &mut found {
            if names.iter().filter(|other| *other == name).count() > 1 {
                *name = path.display().to_string();
            }
        }
        Ok(NamedRecordings { found })
    }

    /// Number of recordings.
    pub fn number(&self) -> usize {
        self.found.len()
    }
}

/// Name of a recording's folder.
fn name(recording: &Path) -> String {
    let typed = recording.file_name().map(|name| name.to_string_lossy().into_owned());
    typed.unwrap_or_else(|| recording.display().to_string())
}

/// Analyses recordings of one kitchen and calls `done` after each. Returns the summary and the report's path.
///
/// # Errors
/// A recording cannot be read or replayed, or belongs to another kitchen than the first; or the results cannot be written.
pub fn study(
    analysis: &AnalysisRequest,
    recordings: &NamedRecordings,
    done: impl Fn() + Sync,
) -> Result<(StudySummary, PathBuf), StudyError> {
    let preregistration = match &analysis.frozen {
        Some(file) => Some(frozen_check::check(file, recordings.found.iter().map(|(path, _)| path.as_path()))?),
        None => None,
    };
    let export = ExportFolder::create(&analysis.out)?;
    let Some((first, _)) = recordings.found.first() else { return Err(no_recording(analysis)) };
    let kitchen = LogReader::open(first)?.kitchen;
    let numbered: Vec<(usize, &(PathBuf, String))> = recordings.found.iter().enumerate().collect();
    let work = |&(index, (path, name)): &(usize, &(PathBuf, String))| -> Result<Option<(Trial, Facts)>, StudyError> {
        let Some((own, RecordingAnalysis { trial, facts, rows })) =
            reading::read(path, name, analysis.extent, analysis.raters.as_ref())?
        else {
            return Ok(None);
        };
        same_kitchen((first, &kitchen), (path, &own))?;
        if analysis.extent.events {
            export.keep(index, &rows)?;
        }
        Ok(Some((trial, facts)))
    };
    let (mut trials, mut facts, mut kept) = (Vec::new(), Facts::default(), Vec::new());
    for (index, read) in parallel::each(&numbered, work, done).into_iter().enumerate() {
        if let Some((trial, own)) = read? {
            kept.push(index);
            trials.push(trial);
            facts.add(own);
        }
    }
    arrange(&mut trials);
    let practice = (recordings.number() - trials.len()) as u64;
    let tutorials = tutorial_answers(recordings)?;
    let figures = StudySummary::from_trials(&trials, &facts, practice).with_tutorials(&tutorials);
    let figures = figures.with_preregistration(preregistration);
    if !analysis.extent.events {
        kept.clear();
    }
    let mut filled = export.tables_of_events(&kept)?;
    filled.extend(export.table::<ParticipantRow>(participants(&trials, &consents(recordings)?))?);
    filled.extend(export.table::<Trial>(&trials)?);
    filled.extend(export.table::<AnswerRow>(trials.iter().flat_map(answers))?);
    filled.extend(export.table::<TutorialAnswer>(&tutorials)?);
    filled.extend(export.table::<ConceptRow>(trials.iter().filter(|trial| trial.counts()).flat_map(concepts))?);
    filled.extend(export.table::<ProbeRow>(trials.iter().flat_map(probes))?);
    filled.extend(export.table::<DictionaryRow>(dictionary())?);
    filled.sort_unstable();
    let path = export.report(&report::page(&figures, &trials, &facts, &filled))?;
    Ok((figures, path))
}

/// The answers to the questions of tutorials, by participant and recording.
fn tutorial_answers(recordings: &NamedRecordings) -> Result<Vec<TutorialAnswer>, FileError> {
    let mut all = Vec::new();
    for (path, name) in &recordings.found {
        all.extend(tutorials::read(path, name)?);
    }
    // The order of a tutorial's questions stays.
    all.sort_by(|a, b| (&a.participant, &a.recording).cmp(&(&b.participant, &b.recording)));
    Ok(all)
}

/// The consents that recordings begin with, by time.
fn consents(recordings: &NamedRecordings) -> Result<Vec<RecordedConsent>, FileError> {
    let read = recordings.found.iter().map(|(path, _)| consents::read(path));
    let mut all: Vec<RecordedConsent> = read.filter_map(Result::transpose).collect::<FileResult<_>>()?;
    all.sort_by(|a, b| a.started.cmp(&b.started));
    Ok(all)
}

fn same_kitchen(first: (&Path, &Arc<Kitchen>), other: (&Path, &Arc<Kitchen>)) -> Result<(), FileError> {
    let mut one = SameKitchen::default();
    one.admit(first.0, first.1)?;
    one.admit(other.0, other.1)
}

fn no_recording(analysis: &AnalysisRequest) -> StudyError {
    let path = analysis.paths.first().map_or(Path::new("."), PathBuf::as_path);
    let remedy = "a folder with at least one recording".to_string();
    StudyError::from(FileError::from_finding(path, "no recording".to_string(), remedy))
}
