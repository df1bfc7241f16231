//! Fitting recovers what is known: the parameters of humans who are simulated from the model itself.

use std::sync::Arc;

use tomcom::kitchen::Kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::mind::fitting::Parameter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::Observation;
use tomcom::run::fit::{Fit, Plan, Trials, describe, fit};

use crate::world::{Human, World, kitchen, live};

/// Trials of humans with these parameters.
fn trials(kitchen: &Arc<Kitchen>, model: &HumanModel, humans: u64, presses: usize, gaze_hz: f64, seed: u64) -> Trials {
    let mut observations = Vec::new();
    let mut cost = CostToGo::new(kitchen.clone());
    for index in 0..humans {
        let mut world = World::new(kitchen.clone(), cost, gaze_hz, seed, index);
        let mut human = Human::new(kitchen, model, seed, index);
        let mut of_trial: Vec<Observation> = Vec::new();
        live(&mut world, &mut human, presses, |observation, _, _| of_trial.push(*observation));
        observations.push((index, of_trial));
        cost = world.cost;
    }
    Trials { kitchen: kitchen.clone(), observations }
}

/// Fits, tells, and demands that each parameter is within so many standard errors of the truth, on the scale of the fit.
fn check(found: &Fit, plan: &Plan, truth: &HumanModel, errors: f64) {
    println!("{}", describe(found));
    for (parameter, fitted) in plan.parameters.iter().zip(&found.parameters) {
        let [from, to] = fitted.interval.unwrap_or_else(|| panic!("{fitted:?}: the likelihood is not curved"));
        let error = (parameter.to_scale(to) - parameter.to_scale(from)) / 3.92;
        let off = parameter.to_scale(fitted.value) - parameter.to_scale(parameter.get(truth));
        println!("{}: true {:.4}, off by {:.2} standard errors", fitted.name, parameter.get(truth), off / error);
        assert!(off.abs() <= errors * error, "{fitted:?}, true {}", parameter.get(truth));
    }
    assert!(found.log_likelihood >= found.log_likelihood_before, "{found:?}");
}

#[test]
fn fitting_recovers_how_a_human_decides() {
    let kitchen = kitchen("layouts/burger.toml");
    let mut truth = HumanModel::default();
    (truth.decision.tau, truth.decision.lapse) = (1.5, 0.12);
    let trials = trials(&kitchen, &truth, 6, 40, 15.0, 17);
    let mut start = HumanModel::default();
    (start.inference.beliefs, start.inference.states, start.inference.max_beliefs) = (64, 16, 64);
    let plan = Plan { parameters: vec![Parameter::Tau, Parameter::Lapse], start, most_tries: 40 };
    check(&fit(&trials, &plan, || {}), &plan, &truth, 4.0);
}

/// The larger run: `cargo test --release --test mind fitting -- --ignored --nocapture`.
#[test]
#[ignore = "takes a quarter of an hour"]
fn fitting_recovers_all_usual_parameters() {
    let kitchen = kitchen("layouts/sushi.toml");
    let mut truth = HumanModel::default();
    (truth.decision.tau, truth.decision.lapse) = (2.5, 0.08);
    (truth.perception.radius_deg, truth.perception.reading_rate_hz) = (1.5, 3.0);
    truth.transition.recipe_half_life_s = 100.0;
    let trials = trials(&kitchen, &truth, 20, 150, 60.0, 19);
    let plan = Plan { parameters: Parameter::USUAL.to_vec(), start: HumanModel::default(), most_tries: 200 };
    check(&fit(&trials, &plan, || {}), &plan, &truth, 4.0);
}
