//! Command `tomcom study`: replays the recordings of a study on all processors and writes tables, charts and the
//! report.
//!
//! Each recording is analysed by itself ([`reading`]) and kept as an [`AnalysedRecording`]; all analysed recordings
//! together give summary, tables and report. Between these two steps a study can be cut into parts, which are analysed
//! on different machines and joined ([`shards`]).

pub mod contest;
pub mod reading;
mod rows;
pub mod shards;
mod sweep;
mod tell;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::column::{CsvTable, DataDictionaryRow, dictionary};
use crate::facts::RecordingFacts;
use crate::figures::{CorrectedRecording, StudySummary};
use crate::files::export::{AnalysisFolder, AnalysisWriteError};
use crate::files::pool_file::read_frozen;
use crate::frozen_plan::{FrozenPlan, PlanVersions, PreregistrationCheck, RecordedPlan};
use crate::gathered::{GatheredPlace, GatheredRecordings, name, whole};
use crate::kept_cost::KeptCost;
use crate::pass::reading::{AnalysisScope, RecordedConsent, WaivedPractice};
pub use crate::pass::tell::{describe, describe_arms};
use crate::planned_trial::{
    ForeignRecording, NAMED, RecordingCopy, foreign_in_words, missing_trials, named, other_orders,
};
use crate::study_part::AnalysedRecording;
use crate::tables::communications::concepts;
use crate::tables::participants::{
    AnswerRow, ParticipantRow, TutorialQuestionRow, TutorialSummary, answers, participants,
};
use crate::tables::probe_table::probes;
use crate::trial_statistics::{DetailTotals, TrialStatistics, arrange};
use crate::{parallel, report};
use tomcom_core::base::text::{count, did_you_mean};
use tomcom_core::kitchen::Kitchen;
use tomcom_session::event::TrialEndReason;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::log::{LogReader, header_digest, rater_codes};
use tomcom_session::replay::SameKitchenCheck;

#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum StudyError {
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    #[diagnostic(transparent)]
    Export(#[from] AnalysisWriteError),
}

#[derive(Clone, Debug)]
pub struct AnalysisRequest {
    /// Paths of recordings, or of folders that contain recordings; or files with the parts of a study that are joined.
    pub paths: Vec<PathBuf>,
    /// The folder for tables and report, or the file of a part of the study.
    pub out: PathBuf,
    pub scope: AnalysisScope,
    pub frozen: Option<PathBuf>,
}

#[derive(Clone, Debug)]
pub struct NamedRecordings {
    found: Vec<(PathBuf, String)>,
    copies: Vec<RecordingCopy>,
    foreign: Vec<ForeignRecording>,
}

impl NamedRecordings {
    /// Each once, ordered by name, so that the order does not depend on how they are spread over folders. `plans`: names of
    /// the plans whose recordings are meant; empty: all. Errors: several plans have recordings and none is named, or one
    /// that has none; or two plans have a participant of the same code, of whom tables would make one person. Recordings of no
    /// plan beside those of a plan, and simulated ones beside those of people, are left out.
    pub fn find(paths: &[PathBuf], plans: &[String]) -> Result<NamedRecordings, StudyError> {
        let first = paths.first().cloned().unwrap_or_default();
        let gathered = GatheredRecordings::find(paths)?;
        check_plans(&gathered.places, plans)
            .map_err(|(found, remedy)| FileError::from_finding(&first, found, remedy))?;
        let GatheredRecordings { paths, copies, foreign, .. } = gathered.without_foreign(plans);
        let mut found: Vec<(PathBuf, String)> = paths.into_iter().map(|path| (path.clone(), name(&path))).collect();
        // Recordings from several folders with the same name are identified by their full paths.
        let names: Vec<String> = found.iter().map(|(_, name)| name.clone()).collect();
        for (path, name) in &mut found {
            if names.iter().filter(|other| *other == name).count() > 1 {
                *name = path.display().to_string();
            }
        }
        found.sort_by(|(one, a), (other, b)| (a, one).cmp(&(b, other)));
        Ok(NamedRecordings { found, copies, foreign })
    }

    /// The two raters whose codes an analysis of these recordings uses: those whom the user names, or the only two who
    /// have coded errors. `None`: each recording's most complete codes. A trial without errors has no codes by which
    /// its raters could be told. Errors: a rater whom the user names has no codes; or codes cannot be read.
    fn raters(&self, analysis: &AnalysisRequest) -> Result<Option<[String; 2]>, FileError> {
        let mut raters = BTreeSet::new();
        for (path, _) in &self.found {
            raters.extend(rater_codes::raters(LogReader::open(path)?.folder())?);
        }
        match &analysis.scope.raters {
            Some(named) => {
                rater_codes::check_named(Path::new("--raters"), named, &raters).map(|()| Some(named.clone()))
            }
            None => Ok(raters.into_iter().collect::<Vec<_>>().try_into().ok()),
        }
    }

    fn versions(&self) -> Result<PlanVersions, FileError> {
        let mut versions = PlanVersions::default();
        for (path, name) in &self.found {
            versions.add(name, &LogReader::open(path)?.header);
        }
        Ok(versions)
    }

    pub fn number(&self) -> usize {
        self.found.len()
    }
}

/// What is wrong about the plans of recordings, and what would be right.
fn check_plans(places: &[GatheredPlace], wanted: &[String]) -> Result<(), (String, String)> {
    let mut numbers: BTreeMap<&str, u64> = BTreeMap::new();
    for plan in places.iter().filter_map(|place| place.plan.as_deref()) {
        *numbers.entry(plan).or_default() += 1;
    }
    let one = |(plan, number): (&&str, &u64)| format!("\"{plan}\" ({})", count(*number, "recording", "recordings"));
    let there = || numbers.iter().map(one).collect::<Vec<_>>().join(", ");
    if let Some(missing) = wanted.iter().find(|plan| !numbers.contains_key(plan.as_str())) {
        let found = format!("no recording of the plan \"{missing}\"{}", did_you_mean(missing, numbers.keys()));
        let there = if numbers.is_empty() { "these recordings are of no plan".to_string() } else { there() };
        return Err((found, format!("a plan that has recordings there: {there}")));
    }
    if wanted.is_empty() && numbers.len() > 1 {
        let first = numbers.keys().next().copied().unwrap_or_default();
        let remedy = format!(
            "the plan that is meant, such as --plan {first}; plans whose participants are one study, such as those of several \
             labs, are each named: --plan A --plan B"
        );
        return Err((format!("recordings of several plans: {}", there()), remedy));
    }
    let mut codes: BTreeMap<&str, &str> = BTreeMap::new();
    let meant = places.iter().filter_map(|place| Some((place.code.as_str(), place.plan.as_deref()?)));
    for (code, plan) in meant.filter(|(_, plan)| wanted.iter().any(|wanted| wanted == plan)) {
        let other = *codes.entry(code).or_insert(plan);
        if other != plan {
            let found = format!("recordings of {code} in the plan \"{other}\" and in the plan \"{plan}\"");
            let remedy = "codes that differ between the plans (tomcom correct RECORDING --code CODE --reason …): one code is one \
                          participant; or one plan";
            return Err((found, remedy.to_string()));
        }
    }
    Ok(())
}

/// Analyses recordings of one kitchen and calls `done` after each. Returns the summary and the report's path. Errors:
/// recordings cannot be read, do not replay as recorded, or belong to another kitchen than the first (all are named); or
/// the results cannot be written.
pub fn study(
    analysis: &AnalysisRequest,
    recordings: &NamedRecordings,
    done: impl Fn() + Sync,
) -> Result<(StudySummary, PathBuf), StudyError> {
    let scope = AnalysisScope { raters: recordings.raters(analysis)?, ..analysis.scope.clone() };
    let frozen = frozen(analysis)?;
    let export = AnalysisFolder::create(&analysis.out)?;
    let Some((first, _)) = recordings.found.first() else {
        return Err(nothing_counts(analysis, 0, &[], &recordings.foreign));
    };
    let kitchen = LogReader::open(first)?.kitchen;
    let numbered: Vec<(usize, &(PathBuf, String))> = recordings.found.iter().enumerate().collect();
    let work = |kept: &mut KeptCost, &(index, recording): &(usize, &(PathBuf, String))| {
        let analysed = analyse(recording, &scope, (first, &kitchen), kept);
        analysed.map(|(analysed, rows)| keep(&export, &scope, index, &analysed, &rows))
    };
    let kept = whole(parallel::each_with(&numbered, KeptCost::default, work, done))?;
    kept.into_iter().collect::<Result<(), AnalysisWriteError>>()?;
    let left = (recordings.copies.clone(), recordings.foreign.clone());
    let frozen = frozen.map(|frozen| Ok::<_, FileError>((frozen, recordings.versions()?))).transpose()?;
    conclude(numbered.len(), analysis, &export, frozen, left)
}

/// The frozen plan with which the recordings are compared, with its digest; `None` if the user names no frozen plan.
fn frozen(analysis: &AnalysisRequest) -> Result<Option<(String, FrozenPlan)>, FileError> {
    analysis.frozen.as_ref().map(|file| read_frozen(file)).transpose()
}

/// `first`: a recording of the study with its kitchen. Returns also the rows of the tables of events.
fn analyse(
    (path, name): &(PathBuf, String),
    scope: &AnalysisScope,
    first: (&Path, &Arc<Kitchen>),
    kept: &mut KeptCost,
) -> FileResult<(AnalysedRecording, [Vec<u8>; 5])> {
    let log = LogReader::open(path)?;
    let (plan, correction) = (RecordedPlan::from_header(&log.header), log.header.correction.clone());
    let digest = header_digest(log.path_of_last_part())?;
    let (tutorial, consent) = (reading::tutorial_answers(log, name)?, reading::consent(path)?);
    let waived = reading::waived_practice(path)?;
    let (mut trial, mut rows) = (None, Default::default());
    if let Some((own, read)) = reading::read(path, name, scope, kept)? {
        let mut one_kitchen = SameKitchenCheck::default();
        one_kitchen.admit(first.0, first.1)?;
        one_kitchen.admit(path, &own)?;
        (trial, rows) = (Some((read.trial, read.details, read.facts)), read.rows);
    }
    Ok((
        AnalysedRecording { recording: name.clone(), digest, plan, correction, consent, tutorial, waived, trial },
        rows,
    ))
}

/// Keeps an analysed recording and its rows in files until all recordings are read; practice recordings have no rows.
/// Nothing of a recording stays in memory. What a thread would keep between the large and short-lived blocks of its
/// replays would also hinder the use of these blocks for the next recording.
fn keep(
    export: &AnalysisFolder,
    scope: &AnalysisScope,
    index: usize,
    analysed: &AnalysedRecording,
    rows: &[Vec<u8>; 5],
) -> Result<(), AnalysisWriteError> {
    export.keep_analysed(index, analysed)?;
    if scope.events && analysed.trial.is_some() { export.keep(index, rows) } else { Ok(()) }
}

#[derive(Default)]
struct CollectedRecordings {
    trials: Vec<TrialStatistics>,
    /// Settings and circumstances of all trials together. Those of single trials would take most of the memory.
    facts: RecordingFacts,
    kept: BTreeMap<String, usize>,
    /// Each with whether its trial counts.
    plans: Vec<(RecordedPlan, bool)>,
    corrections: Vec<CorrectedRecording>,
    consents: Vec<(String, RecordedConsent)>,
    tutorials: Vec<TutorialQuestionRow>,
    waived: Vec<WaivedPractice>,
}

impl CollectedRecordings {
    fn read(export: &AnalysisFolder, number: usize) -> Result<CollectedRecordings, AnalysisWriteError> {
        let mut all = CollectedRecordings::default();
        for index in 0..number {
            let AnalysedRecording { recording, plan, correction, consent, tutorial, waived, trial, .. } =
                export.kept_analysed(index)?;
            all.plans.push((plan, trial.as_ref().is_some_and(|(trial, ..)| trial.counts())));
            all.tutorials.extend(tutorial);
            all.waived.extend(waived);
            if let Some((trial, _, facts)) = trial {
                all.kept.insert(trial.recording.clone(), index);
                all.trials.push(trial);
                all.facts.add(facts);
            }
            all.consents.extend(consent.map(|consent| (recording.clone(), consent)));
            all.corrections.extend(correction.map(|correction| CorrectedRecording { recording, correction }));
        }
        Ok(all)
    }
}

/// `number`: the recordings are kept under the numbers below it; `copies` and `foreign` ones were left out of them. Errors:
/// no trial counts; or the results cannot be written.
fn conclude(
    number: usize,
    analysis: &AnalysisRequest,
    export: &AnalysisFolder,
    frozen: Option<((String, FrozenPlan), PlanVersions)>,
    (copies, foreign): (Vec<RecordingCopy>, Vec<ForeignRecording>),
) -> Result<(StudySummary, PathBuf), StudyError> {
    let mut all = CollectedRecordings::read(export, number)?;
    arrange(&mut all.trials);
    let trials = &all.trials;
    let practice = (all.plans.len() - trials.len()) as u64;
    if !trials.iter().any(TrialStatistics::counts) {
        return Err(nothing_counts(analysis, practice, trials, &foreign));
    }
    all.waived.sort();
    all.consents.sort_by(|(one, a), (other, b)| (&a.started, one).cmp(&(&b.started, other)));
    let consents: Vec<RecordedConsent> = all.consents.into_iter().map(|(_, consent)| consent).collect();
    all.corrections.sort_by(|a, b| a.recording.cmp(&b.recording));
    // The sort is stable, so the order of a tutorial's questions stays.
    all.tutorials.sort_by(|a, b| (&a.participant, &a.recording).cmp(&(&b.participant, &b.recording)));
    let (details, mut filled) = tables_of_details(trials, &all.kept, export)?;
    let is_ended = |trial: &&TrialStatistics| trial.counts() && trial.ended == Some(TrialEndReason::Wizard);
    let ended = trials.iter().filter(is_ended).count() as u64;
    let other_orders = other_orders(all.plans.iter().map(|(plan, counts)| (plan, *counts)));
    let plans: Vec<RecordedPlan> = all.plans.into_iter().map(|(plan, _)| plan).collect();
    let check = |((digest, frozen), versions): ((String, FrozenPlan), PlanVersions)| {
        let mut check = PreregistrationCheck::new(digest, &frozen, &plans, &versions, ended);
        check.differences.extend(other_orders.iter().cloned());
        check
    };
    let figures = StudySummary {
        preregistration: frozen.map(check),
        missing_trials: missing_trials(&plans),
        other_orders,
        copies,
        foreign,
        corrections: all.corrections,
        waived: all.waived,
        tutorial: TutorialSummary::from_answers(&all.tutorials),
        ..StudySummary::from_trials(trials, details, &all.facts, practice)
    };
    let events: Vec<usize> = if analysis.scope.events { all.kept.into_values().collect() } else { Vec::new() };
    filled.extend(export.tables_of_events(&events)?);
    let columns = ParticipantRow::columns_of(trials);
    filled.extend(export.table_of_columns(&columns, participants(trials, &consents))?);
    filled.extend(export.table::<TrialStatistics>(trials)?);
    filled.extend(export.table::<AnswerRow>(trials.iter().flat_map(answers))?);
    filled.extend(export.table::<TutorialQuestionRow>(&all.tutorials)?);
    filled.extend(export.table::<DataDictionaryRow>(dictionary(trials))?);
    filled.sort_unstable();
    let path = export.report(&report::page(&figures, trials, &all.facts, &filled))?;
    Ok((figures, path))
}

/// Trial by trial. Returns the sums over the details, and the tables that have rows.
fn tables_of_details(
    trials: &[TrialStatistics],
    kept: &BTreeMap<String, usize>,
    export: &AnalysisFolder,
) -> Result<(DetailTotals, Vec<CsvTable>), AnalysisWriteError> {
    let mut totals = DetailTotals::default();
    let (mut of_concepts, mut of_probes) = (export.begin(CsvTable::Concepts)?, export.begin(CsvTable::Probes)?);
    for trial in trials {
        let kept = export.kept_analysed(kept[&trial.recording])?;
        let details = kept.trial.map(|(_, details, _)| details).unwrap_or_default();
        if trial.counts() {
            concepts(trial, &details).try_for_each(|row| of_concepts.add(&row))?;
        }
        probes(trial, &details).try_for_each(|row| of_probes.add(&row))?;
        totals.add(trial, details);
    }
    Ok((totals, [of_concepts.finish()?, of_probes.finish()?].into_iter().flatten().collect()))
}

/// None of these recordings is a trial that counts: practice, trials that are left out, and foreign ones.
fn nothing_counts(
    analysis: &AnalysisRequest,
    practice: u64,
    trials: &[TrialStatistics],
    foreign: &[ForeignRecording],
) -> StudyError {
    let practice = (practice > 0).then(|| format!("{} of practice", count(practice, "recording", "recordings")));
    let left_out = trials.iter().filter_map(|one| Some(format!("{} ({})", one.recording, one.left_out.as_ref()?)));
    let left_out: Vec<String> = left_out.collect();
    let trials = (!left_out.is_empty()).then(|| format!("left out: {}", named(&left_out, NAMED)));
    let there: Vec<String> = [practice, trials, foreign_in_words(foreign)].into_iter().flatten().collect();
    let found = format!("no trial that counts{}{}", if there.is_empty() { "" } else { ": " }, there.join("; "));
    let path = analysis.paths.first().map_or(Path::new("."), PathBuf::as_path);
    let remedy = "at least one recording of a trial that is over and not excluded; tomcom list shows what became of each, \
                  tomcom operate --continue RECORDING goes on with one, and tomcom exclude RECORDING --back includes one again";
    FileError::from_finding(path, found, remedy.to_string()).into()
}
