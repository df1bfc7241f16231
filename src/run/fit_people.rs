//! `tomcom fit RECORDING... --people`: assigns recordings to persons, and computes the likelihoods of persons' trials
//! on all processors for [`crate::analysis::fitting::people_fit`].

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::fit::FitTrials;
use super::parallel::WorkerPool;
use crate::analysis::fitting::FitSettings;
use crate::analysis::fitting::people_fit::fit_people;
use crate::analysis::fitting::people_search::{PersonTry, ROUNDS, TrialSelection};
use crate::analysis::fitting::people_summary::{
    HeldOut, HeldOutGain, HeldOutPerson, PeopleSummary, PersonRecordingCount,
};
use crate::analysis::fitting::score_surface::points;
use crate::edge::file_error::{FileError, FileResult};
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::fitting::{FitObservations, TrialLikelihood, likelihood};
use crate::mind::model::HumanModel;
use crate::study::statistics::mean_interval;

/// Confidence level of the intervals over persons.
const LEVEL: f64 = 0.95;

/// Least number of persons to whom a population can be fitted.
const LEAST_PEOPLE: usize = 2;

/// Checks that the recordings are of several persons.
///
/// # Errors
/// All recordings are of one person.
pub fn require_people(recordings: &[PathBuf], trials: &FitTrials) -> FileResult<()> {
    let people = by_person(trials);
    if people.len() >= LEAST_PEOPLE {
        return Ok(());
    }
    let first = recordings.first().map_or(Path::new("."), PathBuf::as_path);
    let codes: Vec<&str> = people.into_keys().collect();
    let found = format!("recordings of one person, {}", codes.join(", "));
    let remedy = "recordings of several persons with different codes, or the command without --people".to_string();
    Err(FileError::from_finding(first, found, remedy))
}

/// Largest number of replays of single trials that a fit takes.
pub fn most_replays(trials: &FitTrials, plan: &FitSettings) -> u64 {
    let rounds = ROUNDS * points(plan.parameters.len());
    2 * ((plan.most_tries + rounds) * trials.observations.len()) as u64
}

/// Fits a population and its persons to trials. `tried` is called after each trial of each tried parameter set.
pub fn fit(trials: &FitTrials, plan: &FitSettings, tried: impl Fn() + Sync) -> PeopleSummary {
    let kitchen = &trials.kitchen;
    let by_person = by_person(trials);
    let fitted: Vec<PersonRecordingCount> = by_person
        .iter()
        .map(|(code, own)| PersonRecordingCount { code: (*code).to_string(), recordings: own.len() as u64 })
        .collect();
    let own: Vec<&Vec<&FitObservations>> = by_person.values().collect();
    let pool = WorkerPool::new(|| CostToGo::new(kitchen.clone()));
    let likelihoods = |tries: &[PersonTry]| {
        let trials_of = |(index, one): (usize, &PersonTry)| -> Vec<(usize, &FitObservations)> {
            of_part(own[one.person], one.part).iter().map(|&trial| (index, trial)).collect()
        };
        let items: Vec<(usize, &FitObservations)> = tries.iter().enumerate().flat_map(trials_of).collect();
        let of_trial = |cost: &mut CostToGo, (index, trial): &(usize, &FitObservations)| {
            let model: &HumanModel = &tries[*index].model;
            likelihood(kitchen, model, trial, cost)
        };
        let found = pool.each(&items, of_trial, &tried);
        // Likelihoods are summed in the order of the trials, so the sums do not depend on the number of threads.
        let mut sums = vec![TrialLikelihood::default(); tries.len()];
        items.iter().zip(found).for_each(|((index, _), found)| {
            sums[*index] = std::mem::take(&mut sums[*index]).plus(found);
        });
        sums
    };
    let mut summary = fit_people(&fitted, &trials.model, plan, likelihoods);
    if let Some(held_out) = &mut summary.held_out {
        held_out.gain = gain(held_out, |one| one.own - one.pooled);
        held_out.population_gain = gain(held_out, |one| one.own - one.population);
    }
    summary
}

/// The trials of each person, by the person's code, in the order of the trials' numbers; trials without a plan keep the
/// order in which they are named.
pub fn by_person(trials: &FitTrials) -> BTreeMap<&str, Vec<&FitObservations>> {
    let mut numbered: Vec<_> = trials.people.iter().zip(&trials.observations).collect();
    numbered.sort_by_key(|((_, number), _)| *number);
    let mut found: BTreeMap<&str, Vec<&FitObservations>> = BTreeMap::new();
    for ((code, _), trial) in numbered {
        found.entry(code).or_default().push(trial);
    }
    found
}

/// The part of a person's trials that the search uses.
fn of_part<'a, 'b>(own: &'b [&'a FitObservations], part: TrialSelection) -> &'b [&'a FitObservations] {
    let before_last = own.len().saturating_sub(1);
    match part {
        TrialSelection::All => own,
        TrialSelection::Training if own.len() > 1 => &own[..before_last],
        TrialSelection::Training => own,
        TrialSelection::HeldOut if own.len() > 1 => &own[before_last..],
        TrialSelection::HeldOut => &[],
    }
}

fn gain(held_out: &HeldOut, of: impl Fn(&HeldOutPerson) -> f64) -> Option<HeldOutGain> {
    let gains: Vec<f64> = held_out.by_person.iter().map(of).collect();
    let found = mean_interval(&gains, LEVEL)?;
    Some(HeldOutGain { mean: found.estimate, interval: [found.low, found.high] })
}
