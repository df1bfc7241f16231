//! `tomcom fit --people`: fits a population with a parameter set for each person, beside one set of parameters for all
//! persons, on all trials and on all but trials that were left out.

use std::collections::BTreeMap;

use super::FitSettings;
use super::ascent::climb;
use super::parameter_scale::{bounds_of, is_possible, model_at, point_of};
use super::people_search::{FoundPeople, PeopleSearch, PersonTry, TrialSelection, search};
use super::people_summary::{
    HeldOut, HeldOutPerson, PeopleSummary, PersonRecordingCount, PersonSummary, PooledParameter, PopulationParameter,
};
use crate::mind::fitted_people::{FittedPeople, HumanModelFile};
use crate::mind::fitting::TrialLikelihood;
use crate::mind::model::HumanModel;

/// The search on one part of the trials: one set of parameters for all persons, and population with persons.
struct PartFit {
    pooled: Vec<f64>,
    people: FoundPeople,
    tries: u64,
    converged: bool,
}

/// Fits a population and its persons. `model` is the human model in the recordings, `likelihoods` returns the
/// likelihood of each tried set of parameters.
///
/// The caller adds the intervals over persons to [`HeldOut`].
pub fn fit_people(
    people: &[PersonRecordingCount],
    model: &HumanModel,
    plan: &FitSettings,
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) -> PeopleSummary {
    let base = plan.start.as_ref().unwrap_or(model);
    let start = point_of(base, &plan.parameters);
    let all = fit_part(people.len(), base, plan, (&start, TrialSelection::All), &likelihoods);
    let held_out = people.iter().any(|person| person.recordings > 1).then(|| {
        // The search on the training trials starts where the search on all trials ended, which saves rounds; its result
        // depends on the training trials alone.
        let training = fit_part(people.len(), base, plan, (&all.pooled, TrialSelection::Training), &likelihoods);
        (judge(people, base, plan, &training, &likelihoods), training)
    });
    let at_modes = sums(&at_each(base, plan, &all.people.modes, TrialSelection::All, &likelihoods));
    let at_pooled = vec![all.pooled.clone(); people.len()];
    let each_pooled = at_each(base, plan, &at_pooled, TrialSelection::All, &likelihoods);
    let pooled = sums(&each_pooled);
    let presses = pooled.presses.max(1) as f64;
    let population = &all.people.estimate;
    let person = |(index, person): (usize, &PersonRecordingCount)| {
        let posterior = &population.people[index];
        PersonSummary::from_posterior(person, each_pooled[index].presses, &plan.parameters, posterior)
    };
    let trained = held_out.as_ref().map(|(_, training)| training);
    PeopleSummary {
        recordings: people.iter().map(|person| person.recordings).sum(),
        human_actions: pooled.presses,
        answers: pooled.answers,
        log_likelihood_pooled: pooled.log_p / presses,
        log_likelihood: at_modes.log_p / presses,
        tries: all.tries + trained.map_or(0, |training| training.tries),
        converged: all.converged && trained.is_none_or(|training| training.converged),
        pooled: plan.parameters.iter().zip(&all.pooled).map(|(one, at)| PooledParameter::new(*one, *at)).collect(),
        population: PopulationParameter::all(&plan.parameters, population),
        people: people.iter().enumerate().map(person).collect(),
        file: file(people, base, plan, &all.people),
        held_out: held_out.map(|(held_out, _)| held_out),
    }
}

/// Fits one set of parameters for all persons, then population and persons, starting from that set.
fn fit_part(
    people: usize,
    base: &HumanModel,
    plan: &FitSettings,
    (start, part): (&[f64], TrialSelection),
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) -> PartFit {
    let losses = |at: &[f64]| {
        let model = model_at(base, &plan.parameters, at);
        let tries =
            || (0..people).map(|person| PersonTry { person, part, model: model.clone() }).collect::<Vec<PersonTry>>();
        is_possible(&model).then(|| sums(&likelihoods(&tries())).losses())
    };
    let pooled = climb(losses, start, &bounds_of(&plan.parameters), plan.most_tries);
    let at: Vec<f64> = pooled.variables.iter().map(|variable| variable.at).collect();
    let what = PeopleSearch { base, parameters: &plan.parameters, people, part };
    let found = search(what, &at, likelihoods);
    let tries = pooled.evaluations as u64 + found.tries;
    PartFit { pooled: at, converged: pooled.converged && found.converged, people: found, tries }
}

/// Likelihood of each person's trials with that person's parameters.
fn at_each(
    base: &HumanModel,
    plan: &FitSettings,
    points: &[Vec<f64>],
    part: TrialSelection,
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) -> Vec<TrialLikelihood> {
    let model = |at: &Vec<f64>| model_at(base, &plan.parameters, at);
    let tries = points.iter().enumerate().map(|(person, at)| PersonTry { person, part, model: model(at) });
    likelihoods(&tries.collect::<Vec<PersonTry>>())
}

fn sums(each: &[TrialLikelihood]) -> TrialLikelihood {
    each.iter().cloned().fold(TrialLikelihood::default(), TrialLikelihood::plus)
}

/// How likely the presses of the trials that were left out of the fit are.
fn judge(
    people: &[PersonRecordingCount],
    base: &HumanModel,
    plan: &FitSettings,
    training: &PartFit,
    likelihoods: impl Fn(&[PersonTry]) -> Vec<TrialLikelihood>,
) -> HeldOut {
    let same = |at: &[f64]| vec![at.to_vec(); people.len()];
    let by = |points: &[Vec<f64>]| at_each(base, plan, points, TrialSelection::HeldOut, &likelihoods);
    let [pooled, population, own] =
        [same(&training.pooled), same(&training.people.mean), training.people.modes.clone()].map(|points| by(&points));
    let judged = (0..people.len()).filter(|&one| pooled[one].presses > 0);
    let per_press = |found: &TrialLikelihood| found.log_p / found.presses as f64;
    let by_person: Vec<HeldOutPerson> = judged
        .map(|one| HeldOutPerson {
            code: people[one].code.clone(),
            human_actions: pooled[one].presses,
            pooled: per_press(&pooled[one]),
            population: per_press(&population[one]),
            own: per_press(&own[one]),
        })
        .collect();
    let is_judged = |person: &&PersonRecordingCount| by_person.iter().any(|one| one.code == person.code);
    let left_out = people.iter().filter(|person| !is_judged(person)).map(|person| person.code.clone()).collect();
    HeldOut { left_out, gain: None, population_gain: None, by_person }
}

/// The file of fitted parameters: those of the population's median person, and those of every person.
fn file(people: &[PersonRecordingCount], base: &HumanModel, plan: &FitSettings, found: &FoundPeople) -> HumanModelFile {
    let values = |at: &Vec<f64>| plan.parameters.iter().zip(at).map(|(one, at)| (*one, one.from_scale(*at))).collect();
    let own: BTreeMap<_, _> =
        people.iter().zip(&found.modes).map(|(person, at)| (person.code.clone(), values(at))).collect();
    HumanModelFile { population: model_at(base, &plan.parameters, &found.mean), people: Some(FittedPeople(own)) }
}
