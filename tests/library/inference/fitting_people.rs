//! A hierarchical fit recovers people who differ: the population, and each person better than its own presses alone tell.

use std::sync::Arc;

use tomcom::analysis::fitting::FitSettings;
use tomcom::analysis::fitting::people_summary::{PeopleSummary, describe_people};
use tomcom::kitchen::Kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::mind::fitting::{FitObservations, HumanModelParameter};
use tomcom::mind::model::HumanModel;
use tomcom::run::fit::{FitTrials, fit};
use tomcom::run::fit_people;

use super::world::{Human, World, kitchen, live};

/// A parameter that differs between persons: the median person, and the standard deviation on the scale of the fit.
type Spread = (HumanModelParameter, f64, f64);

/// Where persons stand in the population, in standard deviations: quantiles of a normal distribution, so that small groups have the
/// population's mean, and about its standard deviation.
const QUANTILES: [f64; 8] = [-1.53, -0.89, -0.49, -0.16, 0.16, 0.49, 0.89, 1.53];

/// The models of people who differ in these parameters, independently of each other.
fn people(base: &HumanModel, spreads: &[Spread], count: usize) -> Vec<HumanModel> {
    let model = |person: usize| {
        let mut model = base.clone();
        for (index, (parameter, median, sd)) in spreads.iter().enumerate() {
            // Steps of 1, 3 and 5 through the quantiles, from other ends: no two parameters go together.
            let place = (person * (2 * index + 1) + 3 * index + person / QUANTILES.len()) % QUANTILES.len();
            let at = parameter.to_scale(*median) + sd * QUANTILES[place];
            parameter.set(&mut model, parameter.from_scale(at));
        }
        model
    };
    (0..count).map(model).collect()
}

/// Trials of these people. The fit begins with `start`.
fn trials(
    kitchen: &Arc<Kitchen>,
    truths: &[HumanModel],
    start: &HumanModel,
    (each, presses): (u64, usize),
    (gaze_hz, seed): (f64, u64),
) -> FitTrials {
    let (mut observations, mut people) = (Vec::new(), Vec::new());
    let mut cost = CostToGo::new(kitchen.clone());
    for (person, truth) in truths.iter().enumerate() {
        for trial in 1..=each {
            let index = person as u64 * 100 + trial;
            let mut world = World::new(kitchen.clone(), cost, gaze_hz, seed, index);
            let mut human = Human::new(kitchen, truth, seed, index);
            let mut of_trial = Vec::new();
            live(&mut world, &mut human, presses, |observation, _, _| of_trial.push(*observation));
            observations.push(FitObservations { seed: index, observations: of_trial, answers: Vec::new() });
            people.push((format!("P{person:02}"), trial));
            cost = world.cost;
        }
    }
    FitTrials { kitchen: kitchen.clone(), model: start.clone(), differ: false, observations, people }
}

/// Means and standard deviations of persons lie within the intervals of the population.
fn check_population(found: &PeopleSummary, truths: &[HumanModel], parameters: &[HumanModelParameter]) {
    for (parameter, one) in parameters.iter().zip(&found.population) {
        let at: Vec<f64> = truths.iter().map(|truth| parameter.to_scale(parameter.get(truth))).collect();
        let mean = at.iter().sum::<f64>() / at.len() as f64;
        let sd = (at.iter().map(|at| (at - mean).powi(2)).sum::<f64>() / (at.len() - 1) as f64).sqrt();
        println!("{}: true mean {mean:.3} and sd {sd:.3} on the scale of the fit, found {one:?}", parameter.name());
        assert!((one.scale_mean - mean).abs() < 2.5 * one.scale_mean_error, "{one:?}, true {mean}");
        let [low, high] = one.scale_sd_interval;
        assert!(low.is_none_or(|low| low <= sd) && high.is_none_or(|high| high >= sd), "{one:?}, true {sd}");
    }
}

/// Root mean square errors on the scale of the fit: of the persons' modes, of fits to each person's presses alone, and of the median
/// person.
fn errors(found: &PeopleSummary, trials: &FitTrials, plan: &FitSettings, truths: &[HumanModel]) -> Vec<[f64; 3]> {
    let alone: Vec<Vec<f64>> = fit_people::by_person(trials)
        .into_values()
        .map(|own| {
            let observations: Vec<FitObservations> = own.into_iter().cloned().collect();
            let people = trials.people[..observations.len()].to_vec();
            let one = FitTrials { observations, people, ..trials.clone() };
            fit(&one, plan, || {}).parameters.iter().map(|parameter| parameter.value).collect()
        })
        .collect();
    let each = |(index, parameter): (usize, &HumanModelParameter)| {
        let off = |value: f64, truth: &HumanModel| {
            (parameter.to_scale(value) - parameter.to_scale(parameter.get(truth))).powi(2)
        };
        let mean = |of: &dyn Fn(usize) -> f64| {
            let sum: f64 = truths.iter().enumerate().map(|(person, truth)| off(of(person), truth)).sum();
            (sum / truths.len() as f64).sqrt()
        };
        let found = [
            mean(&|person| found.people[person].parameters[index].value),
            mean(&|person| alone[person][index]),
            mean(&|_| found.population[index].value),
        ];
        println!(
            "{}: off by {:.3} shrunk, {:.3} alone, {:.3} the median person",
            parameter.name(),
            found[0],
            found[1],
            found[2]
        );
        found
    };
    plan.parameters.iter().enumerate().map(each).collect()
}

/// Few samples, for a test that has to be fast.
fn coarse() -> HumanModel {
    let mut model = HumanModel::default();
    (model.inference.beliefs, model.inference.states, model.inference.max_beliefs) = (96, 8, 96);
    model
}

#[test]
fn people_who_differ_are_found_better_with_their_population() {
    let kitchen = kitchen("layouts/burger.toml");
    let start = coarse();
    let spreads = [(HumanModelParameter::Lapse, 0.1, 1.3)];
    let truths = people(&start, &spreads, 8);
    let trials = trials(&kitchen, &truths, &start, (2, 120), (5.0, 9828));
    let plan = FitSettings { parameters: vec![HumanModelParameter::Lapse], start: None, most_tries: 100 };
    let found = fit_people::fit(&trials, &plan, || {});
    println!("{}", describe_people(&found));
    assert!(found.converged, "{found:?}");
    check_population(&found, &truths, &plan.parameters);
    let [[shrunk, alone, median]] = errors(&found, &trials, &plan, &truths)[..] else { panic!("{found:?}") };
    assert!(shrunk < alone && shrunk < median, "{shrunk} shrunk, {alone} alone, {median} the median person");
    let held_out = found.held_out.as_ref().expect("everybody has two trials");
    let gain = held_out.gain.expect("there are eight persons");
    assert!(gain.mean > 0.0 && held_out.left_out.is_empty() && held_out.by_person.len() == 8, "{held_out:?}");
    let shrinkage: Vec<f64> = found.people.iter().map(|person| person.parameters[0].shrinkage).collect();
    assert!(shrinkage.iter().all(|share| (0.01..0.99).contains(share)), "{shrinkage:?}");
}

#[test]
fn a_person_with_one_trial_counts_for_the_population_and_is_not_judged() {
    let kitchen = kitchen("layouts/burger.toml");
    let start = coarse();
    let truths = people(&start, &[(HumanModelParameter::Lapse, 0.12, 1.0)], 3);
    let mut trials = trials(&kitchen, &truths, &start, (2, 12), (10.0, 9825));
    // The first person's second trial.
    trials.observations.remove(1);
    trials.people.remove(1);
    let plan = FitSettings { parameters: vec![HumanModelParameter::Lapse], start: None, most_tries: 40 };
    let found = fit_people::fit(&trials, &plan, || {});
    let held_out = found.held_out.as_ref().expect("two persons have two trials");
    assert_eq!(held_out.left_out, ["P00"]);
    assert_eq!(held_out.by_person.iter().map(|one| &*one.code).collect::<Vec<_>>(), ["P01", "P02"]);
    assert_eq!(found.people.iter().map(|person| person.recordings).collect::<Vec<_>>(), [1, 2, 2]);
    assert!(describe_people(&found).contains("not judged, with one trial only: P00"));
    let again = fit_people::fit(&trials, &plan, || {});
    assert_eq!(serde_json::to_string(&found).expect("JSON"), serde_json::to_string(&again).expect("JSON"));
}

/// By hand: `cargo test --test library people_who_differ_in_three -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn people_who_differ_in_three_parameters_are_found() {
    let kitchen = kitchen("layouts/burger.toml");
    let mut start = coarse();
    (start.inference.beliefs, start.inference.max_beliefs) = (256, 256);
    // Their radius reaches beyond the place that is looked at: else the rate of reading would matter little.
    start.perception.radius_deg = 3.0;
    let spreads = [
        (HumanModelParameter::Tau, 2.0, 0.4),
        (HumanModelParameter::Lapse, 0.1, 0.9),
        (HumanModelParameter::ReadingRateHz, 2.0, 0.9),
    ];
    let truths = people(&start, &spreads, 16);
    let trials = trials(&kitchen, &truths, &start, (3, 80), (15.0, 9826));
    let parameters = spreads.map(|(parameter, _, _)| parameter).to_vec();
    let plan = FitSettings { parameters, start: None, most_tries: 300 };
    let found = fit_people::fit(&trials, &plan, || {});
    println!("{}", describe_people(&found));
    check_population(&found, &truths, &plan.parameters);
    for [shrunk, alone, _] in errors(&found, &trials, &plan, &truths) {
        assert!(shrunk < alone, "{shrunk} shrunk, {alone} alone");
    }
    let gain = found.held_out.as_ref().and_then(|held_out| held_out.gain).expect("a gain");
    assert!(gain.interval[0] > 0.0, "{gain:?}");
}
