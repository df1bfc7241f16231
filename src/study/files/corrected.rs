//! What a plan lacks after the code of a recording's participant was corrected.

use std::fs;
use std::path::{Path, PathBuf};

use crate::files::recordings;
use crate::frozen_plan::{PlaceInPlan, RecordedPlan};
use crate::standing;
use tomcom_session::files::file_error::{FileResult, read_text};
use tomcom_session::files::near_path::SESSIONS;
use tomcom_session::files::parse::parse;
use tomcom_session::header::CodeCorrection;
use tomcom_session::log::LogReader;
use tomcom_session::plan::PlanSpec;
use tomcom_session::{LogHeader, SessionSpec, person_code};

/// What is wrong about the plan of a recording whose code was just corrected, by its session file, if one is there, and
/// the recordings beside; empty for a recording of no plan.
pub fn remarks(recording: &Path, correction: &CodeCorrection) -> FileResult<Vec<String>> {
    let log = LogReader::open(recording)?;
    let Some(step) = &log.header.session.step else { return Ok(Vec::new()) };
    let (plan, CodeCorrection { before, after, .. }) = (&step.plan, correction);
    let own = log.folder().canonicalize().unwrap_or_default();
    let beside = own.parent().unwrap_or(Path::new("."));
    let kind_of = |header: &LogHeader| (header.session.participant.kind, header.session.seed);
    let others = recordings::of_folder(beside)?.into_iter().filter(|other| *other != own);
    // A neighbour that cannot be read is reported when it is read.
    let others = others.filter_map(|other| Some((LogReader::open(&other).ok()?.header, other)));
    let is_like = |other: &LogHeader| {
        let is_of_plan = other.session.step.as_ref().is_some_and(|step| step.plan == *plan);
        is_of_plan && kind_of(other) == kind_of(&log.header)
    };
    let others = others.filter(|(header, _)| is_like(header));
    let others: Vec<(RecordedPlan, PathBuf)> =
        others.map(|(header, path)| (RecordedPlan::from_header(&header), path)).collect();
    let mut told = Vec::new();
    let plans: Vec<(PathBuf, PlanSpec)> =
        [beside, Path::new(SESSIONS)].into_iter().flat_map(|folder| plans_in(folder, plan)).collect();
    let codes: Vec<String> = plans.iter().flat_map(|(_, plan)| plan.codes()).collect();
    match plans.first() {
        Some((file, of_file)) if !codes.contains(after) => told.push(format!(
            "{after} is no participant of the plan \"{plan}\" in {} ({}), so tomcom plan and tomcom operate refuse the recording; tomcom \
             correct {} --undo takes the correction back{}",
            file.display(),
            person_code::listed(&of_file.codes()),
            recording.display(),
            person_code::did_you_mean(after, &codes)
        )),
        None if !others.iter().any(|(other, _)| other.recorded_code() == after) => told.push(format!(
            "no other recording of the plan \"{plan}\" in {} was begun for {after}: make sure that {after} is a participant of the plan",
            beside.display()
        )),
        _ => {}
    }
    // What the analysis leaves out is no recording of a trial.
    let counts = |recording: &Path| !matches!(standing::left_out(recording), Ok(Some(_)));
    let has = |code: &String| {
        let is_it = |place: &PlaceInPlan| place.period == step.period;
        let is_of = |other: &RecordedPlan| other.participant == *code && other.place.as_ref().is_some_and(is_it);
        others.iter().any(|(other, path)| is_of(other) && counts(path))
    };
    let period = step.period.filter(|_| counts(recording));
    if let Some(period) = period.filter(|_| has(after)) {
        told.push(format!(
            "{after} has a recording of trial {period} of the plan \"{plan}\" already, beside this one, so tomcom study refuses both: leave the \
             other one out (tomcom exclude), correct its code, too, or take this correction back (tomcom correct {} --undo)",
            recording.display()
        ));
    }
    let was_wanted = plans.is_empty() || codes.contains(before);
    if let Some(period) = period.filter(|_| was_wanted && !has(before)) {
        told.push(format!("the plan \"{plan}\" has no recording of trial {period} of {before} any more"));
    }
    Ok(told)
}

/// The session files in a folder whose plan has this name.
fn plans_in(folder: &Path, name: &str) -> Vec<(PathBuf, PlanSpec)> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|one| one.path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    let plan = |file: PathBuf| {
        let spec: SessionSpec = parse(&file, &read_text(&file).ok()?).ok()?;
        Some((file, spec.plan.filter(|plan| plan.name == name)?))
    };
    files.into_iter().filter_map(plan).collect()
}
