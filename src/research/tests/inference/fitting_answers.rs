//! Answers to probes in a fit: their likelihood, and what they tell that presses do not.

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, AspectKind};
use tomcom_core::mind::dirichlet::Dirichlet;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::fitting::{
    FitObservations, HumanModelParameter, ProbeAnswerObservation, TrialLikelihood, likelihood, p_answer,
};
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_study::analysis::fitting::{FitSettings, describe};
use tomcom_study::fit::{FitTrials, fit};

use super::world::{Human, KitchenAtWork, live};
use crate::files::kitchen;

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

#[test]
fn an_answer_is_as_likely_as_the_estimate_at_the_freeze_says() {
    let (kitchen, model) = (kitchen("sushi"), HumanModel::default());
    let mut cost = CostToGo::new(kitchen.clone());
    let state = kitchen.empty_state();
    let observations: Vec<Observation> = [
        (0.0, ObservedEvidence::Started { state }),
        (40.0, ObservedEvidence::Frozen),
        (60.0, ObservedEvidence::Thawed { by: at(20.0), asked: 0, teaches: 0.0 }),
    ]
    .map(|(seconds, what)| Observation { time: at(seconds), what })
    .to_vec();
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), 7);
    filter.observe(&observations[0], &mut cost);
    let frozen = filter.at(at(40.0), &mut cost);
    let aspect =
        AspectId(kitchen.aspects.iter().position(|one| matches!(one.kind, AspectKind::Recipe(_))).unwrap() as u8);
    let answer = |value: Option<usize>| ProbeAnswerObservation { after: 2, aspect, value };
    let answers = vec![answer(Some(0)), answer(None)];
    let trial = FitObservations { seed: 7, observations, answers };
    let found = likelihood(&kitchen, &model, &trial, &mut cost);
    let p = |value| p_answer(frozen.aspect(aspect), value);
    let wanted = p(Some(0)).ln() + p(None).ln();
    assert_eq!((found.presses, found.answers), (0, 2));
    assert!((found.log_p_answers - wanted).abs() < 1e-12, "{found:?} instead of {wanted}");
    assert_eq!(found.total(), found.log_p_answers);
    let none = FitObservations { answers: Vec::new(), ..trial };
    assert_eq!(likelihood(&kitchen, &model, &none, &mut cost), TrialLikelihood::default());
}

/// People who know half of the recipes at first, forget within a minute, and are asked about four recipes every ten presses.
fn probed(people: u64, presses: usize) -> (FitTrials, HumanModel) {
    let kitchen = kitchen("sushi");
    let mut start = HumanModel::default();
    (start.inference.beliefs, start.inference.states, start.inference.max_beliefs) = (512, 32, 512);
    start.prior.recipe_truth = 0.5;
    (start.decision.tau, start.decision.lapse) = (2.5, 0.08);
    let mut truth = start.clone();
    truth.transition.recipe_half_life_s = 60.0;
    let recipes = kitchen.aspects.iter().filter(|one| matches!(one.kind, AspectKind::Recipe(_))).count();
    let places = kitchen.locations.len();
    let (mut cost, mut observations) = (CostToGo::new(kitchen.clone()), Vec::new());
    for index in 0..people {
        let mut world = KitchenAtWork::new(kitchen.clone(), cost, 15.0, Some(10.0), 31, index);
        let mut human = Human::new(&kitchen, &truth, 31, index);
        let mut random = stream(31, "questions", index);
        let mut trial = FitObservations { seed: index, ..FitObservations::default() };
        let mut pressed = 0;
        live(&mut world, &mut human, presses, |observation, human, _| {
            if matches!(observation.what, ObservedEvidence::Pressed(press) if press.agent == Agent::Human) {
                pressed += 1;
                if pressed % 10 == 0 {
                    let pause = |what| Observation { time: observation.time, what };
                    trial.observations.push(pause(ObservedEvidence::Frozen));
                    let after = trial.observations.len();
                    for _ in 0..4 {
                        let about = places + random.random_range(0..recipes);
                        let believed = &human.people.of[0].of[about];
                        let value = believed.iter().position(|p| *p >= 0.5);
                        trial.answers.push(ProbeAnswerObservation { after, aspect: AspectId(about as u8), value });
                    }
                    let going_on = ObservedEvidence::Thawed { by: SessionTime::ZERO, asked: 0, teaches: 0.0 };
                    trial.observations.push(pause(going_on));
                }
            }
            trial.observations.push(*observation);
        });
        observations.push(trial);
        cost = world.cost;
    }
    (FitTrials { kitchen, model: start, others: Vec::new(), left_out: Vec::new(), observations }, truth)
}

/// A belief over two values of which both are as likely, and over three of which one is: by the uniform density of the simplex, and its
/// symmetry, the probability of one half or more is 1/2 each, and 1/4 each, so that nobody knows in 1 of 4 cases.
#[test]
fn chances_of_answers_sum_to_one() {
    let even = |values: usize| Dirichlet::new(vec![1.0; values], values as f64);
    let at_random = |values: usize, p: f64| 0.98 * p + 0.02 / (values + 1) as f64;
    for (values, named, unsure) in [(2, 0.5, 0.0), (3, 0.25, 0.25)] {
        let estimate = even(values);
        for value in 0..values {
            assert!((p_answer(&estimate, Some(value)) - at_random(values, named)).abs() < 1e-9);
        }
        assert!((p_answer(&estimate, None) - at_random(values, unsure)).abs() < 1e-9);
    }
    let estimate = Dirichlet::new(vec![0.6, 0.3, 0.05, 0.05], 7.3);
    let sum: f64 = (0..4).map(Some).chain([None]).map(|value| p_answer(&estimate, value)).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
}

/// With the model `plain` answers to probes hardly narrow the interval (140 % of that by presses alone, here): what the approximate filter
/// believes of recipes is rounder than what people of the model believe. But they lead to the truth as presses do.
#[test]
fn the_interval_of_a_fit_to_presses_and_answers_holds_the_truth() {
    let (trials, truth) = probed(20, 60);
    let parameters = vec![HumanModelParameter::RecipeHalfLifeS];
    let plan = FitSettings { parameters, start: None, most_tries: 60 };
    let found = fit(&trials, &plan, || {});
    println!("{}", describe(&found));
    let answers = found.answers.as_ref().expect("answers were used");
    assert_eq!(answers.answers, 20 * 6 * 4);
    let [half_life] = &found.parameters[..] else { panic!("{found:?}") };
    let [alone] = &answers.shrinkage[..] else { panic!("{answers:?}") };
    let wanted = truth.transition.recipe_half_life_s;
    for interval in [half_life.interval, alone.interval] {
        let Some([Some(low), Some(high)]) = interval else { panic!("{half_life:?}, by presses alone {alone:?}") };
        assert!(low < wanted && wanted < high, "{half_life:?}, by presses alone {alone:?}");
    }
    let off = |value: f64| (value / wanted).ln().abs();
    assert!(off(half_life.value) < off(half_life.before), "{half_life:?}");
}
