//! On a kitchen small enough to go through all beliefs on a grid.

use std::sync::Arc;

use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Kitchen, Press};
use tomcom_core::mind::dirichlet::DirichletBelief;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_research::reference::ReferenceFilter;

use super::grid::{GridFilter, quadrature};
use super::particles::ParticleFilter;
use super::tiny_model;
use super::world::{Human, KitchenAtWork, distance, live};
use crate::files::load;

/// Events that are not gaze samples.
const EVENTS: usize = 20;

fn means(belief: &DirichletBelief) -> Vec<Vec<f64>> {
    belief.aspects.iter().map(|aspect| aspect.mean().to_vec()).collect()
}

#[test]
fn the_grid_holds_the_moments_of_a_beta() {
    for (a, b, n) in [(0.48, 0.12, 12), (1e-4, 0.6, 4), (9.0, 1.0, 3), (0.5, 0.5, 2), (300.0, 2.0, 2)] {
        let nodes = quadrature(a, b, n);
        let moment = |power: i32| nodes.iter().map(|(x, w)| w * x.powi(power)).sum::<f64>();
        let (mean, second) = (a / (a + b), a * (a + 1.0) / ((a + b) * (a + b + 1.0)));
        assert!((moment(0) - 1.0).abs() < 1e-9, "Beta({a}, {b}): {nodes:?}");
        assert!((moment(1) - mean).abs() < 1e-9 && (moment(2) - second).abs() < 1e-9, "Beta({a}, {b}): {nodes:?}");
    }
}

/// Total variation of the estimated mean belief, largest over the aspects, after 20 events with gaze between them: with
/// many samples, so that it is the algorithm that is tested. What chance adds at the default number of samples is told.
#[test]
fn the_estimate_is_close_to_exact_assumed_density_filtering() {
    let kitchen = Arc::new(load("tests/kitchens/tiny.toml"));
    let mut model = tiny_model();
    // Forgetting has a closed form of its own; the grid leaves it out.
    model.transition.recipe_half_life_s = 1e12;
    let mut usual = model.clone();
    usual.inference = HumanModel::default().inference;
    let mut fine = usual.clone();
    (fine.inference.beliefs, fine.inference.max_beliefs, fine.inference.min_effective) = (8192, 32_768, 2048.0);
    fine.inference.predictions = 1024;
    let mut plain = model.clone();
    plain.inference.beliefs = 16_384;
    let mut ends = Vec::new();
    for seed in 1..=3 {
        let mut grid = GridFilter::new(kitchen.clone(), model.clone());
        let mut filters = [usual.clone(), fine.clone()].map(|model| BeliefFilter::new(kitchen.clone(), model, seed));
        let mut reference = ReferenceFilter::new(kitchen.clone(), plain.clone(), seed);
        let mut particles = ParticleFilter::new(&kitchen, &model, 8192, seed, 0);
        let mut world = KitchenAtWork::new(kitchen.clone(), CostToGo::new(kitchen.clone()), 15.0, None, seed, 0);
        let mut human = Human::new(&kitchen, &model, seed, 0);
        let mut apart = [0.0; 4];
        let mut events = 0;
        live(&mut world, &mut human, EVENTS, |observation: &Observation, _, cost| {
            if events > EVENTS {
                return;
            }
            grid.observe(observation, cost);
            filters.iter_mut().for_each(|filter| filter.observe(observation, cost));
            reference.observe(observation, cost);
            particles.observe(observation, cost);
            if !matches!(observation.what, ObservedEvidence::Gaze { .. }) {
                events += 1;
                let found =
                    [&filters[1].belief().clone(), &filters[0].belief().clone(), &reference.belief()].map(means);
                let [fine, usual, plain] = found;
                apart = [fine, usual, plain, particles.mean()].map(|found| distance(&means(&grid.belief), &found));
                let [fine, usual, plain, kept] = apart;
                println!(
                    "seed {seed}, {:<22} filter {fine:.4} (default {usual:.4}) reference {plain:.4} unprojected {kept:.4}",
                    told(&kitchen, &observation.what),
                );
            }
        });
        ends.push(apart);
    }
    let mean = |index: usize| ends.iter().map(|apart| apart[index]).sum::<f64>() / ends.len() as f64;
    println!(
        "total variation after {EVENTS} events: filter {:.4} (default fidelity {:.4}), reference {:.4}; gap to the exact \
         unprojected posterior {:.4}",
        mean(0),
        mean(1),
        mean(2),
        mean(3)
    );
    for [fine, _, plain, _] in &ends {
        assert!(*fine <= 0.03 && *plain <= 0.03, "filter {fine}, reference {plain}");
    }
    assert!(mean(1) <= 0.05, "at the default number of samples: {}", mean(1));
}

fn told(kitchen: &Kitchen, what: &ObservedEvidence) -> String {
    match what {
        ObservedEvidence::Pressed(Press { agent, button, effective, .. }) => {
            let effect = if *effective { "" } else { " (nothing)" };
            format!("{} {}{effect}", agent.name(), kitchen.button(*agent, *button).name)
        }
        ObservedEvidence::Displayed { .. } => "the display changes".to_string(),
        _ => "the start".to_string(),
    }
}
