//! Humans who are simulated from the model itself: what is inferred of them must be what they hold, as often as it says.

use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{AspectId, Kitchen, State};
use tomcom_core::measures::detection::Calibration;
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_research::reference::person::{draw, pick};

use super::particles::ParticleFilter;
use super::tiny_model;
use super::world::{Human, KitchenAtWork, live};
use crate::files::load;

const HUMANS: u64 = 160;
const PRESSES: usize = 8;
const PARTICLES: usize = 400;
/// Humans in the large kitchens.
const LOOKED_AT: u64 = 100;
/// Number of bins of ranks; chi square with 9 degrees of freedom is above 27.88 once in a thousand.
const BINS: usize = 10;
const CHI_SQUARE: f64 = 27.88;

/// Where a value stands among others, 0 to 1; among equals at random.
fn rank(value: f64, others: &[f64], random: &mut Stream) -> f64 {
    let below = others.iter().filter(|&&other| other < value - 1e-12).count() as f64;
    let equal = others.iter().filter(|&&other| (other - value).abs() <= 1e-12).count() as f64;
    (below + (equal + 1.0) * random.random::<f64>()) / (others.len() as f64 + 1.0)
}

fn chi_square(ranks: &[f64]) -> f64 {
    let expected = ranks.len() as f64 / BINS as f64;
    let count = |bin: usize| ranks.iter().filter(|rank| ((*rank * BINS as f64) as usize).min(BINS - 1) == bin).count();
    (0..BINS).map(|bin| (count(bin) as f64 - expected).powi(2) / expected).sum()
}

fn truth(kitchen: &Kitchen, state: State, aspect: usize) -> usize {
    kitchen.true_value(state, AspectId(aspect as u8))
}

/// Simulation-based calibration (Talts et al. 2018): the rank of what a human believes among the draws of its posterior is
/// uniform.
#[test]
fn the_unprojected_posterior_is_calibrated_and_what_the_projection_adds_is_told() {
    let kitchen = Arc::new(load("tests/kitchens/tiny.toml"));
    let model = tiny_model();
    let mut fast_model = model.clone();
    fast_model.inference = HumanModel::default().inference;
    let cost = CostToGo::new(kitchen.clone());
    let aspects = kitchen.aspects.len();
    let (mut kept, mut projected) = (vec![Vec::new(); aspects], vec![Vec::new(); aspects]);
    for index in 0..HUMANS {
        let mut world = KitchenAtWork::new(kitchen.clone(), cost.clone(), 15.0, None, 11, index);
        let mut human = Human::new(&kitchen, &model, 11, index);
        let mut particles = ParticleFilter::new(&kitchen, &model, PARTICLES, 11, index);
        let mut fast = BeliefFilter::new(kitchen.clone(), fast_model.clone(), index);
        live(&mut world, &mut human, PRESSES, |observation, _, cost| {
            particles.observe(observation, cost);
            fast.observe(observation, cost);
        });
        let mut random = stream(11, "ranks", index);
        let drawn: Vec<usize> = (0..PARTICLES).map(|_| pick(&particles.weights, &mut random)).collect();
        for aspect in 0..aspects {
            let value = truth(&kitchen, world.state, aspect);
            let held = human.people.of[0].of[aspect][value];
            let others: Vec<f64> = drawn.iter().map(|&one| particles.people.of[one].of[aspect][value]).collect();
            kept[aspect].push(rank(held, &others, &mut random));
            let of = &fast.belief().aspects[aspect];
            let others: Vec<f64> = (0..PARTICLES).map(|_| draw(of, &mut random)[value]).collect();
            projected[aspect].push(rank(held, &others, &mut random));
        }
    }
    println!("chi square of the ranks of b(truth), {HUMANS} humans, {PRESSES} presses (9 degrees of freedom):");
    for aspect in 0..aspects {
        let [of_kept, of_projected] = [chi_square(&kept[aspect]), chi_square(&projected[aspect])];
        println!("{:<24} kept {of_kept:>7.1}   projected {of_projected:>7.1}", kitchen.aspects[aspect].name);
        assert!(of_kept < CHI_SQUARE, "{}: {of_kept}", kitchen.aspects[aspect].name);
    }
}

/// Of the beliefs called 70 % likely about 70 % are held. Each human is looked at once: what it holds of a recipe it holds
/// for a whole trial, so that more looks at few humans would measure those humans.
#[test]
fn what_is_called_likely_is_held_as_often() {
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = Arc::new(load(layout));
        let model = HumanModel::default();
        let mut cost = CostToGo::new(kitchen.clone());
        let (mut named, mut held_most) = (Vec::new(), Vec::new());
        for index in 0..LOOKED_AT {
            let mut world = KitchenAtWork::new(kitchen.clone(), cost, 15.0, None, 5, index);
            let mut human = Human::new(&kitchen, &model, 5, index);
            let mut fast = BeliefFilter::new(kitchen.clone(), model.clone(), index);
            live(&mut world, &mut human, PRESSES, |observation, _, cost| fast.observe(observation, cost));
            let mut random = stream(5, "named", index);
            for (of, estimate) in human.people.of[0].of.iter().zip(&fast.belief().aspects) {
                let most = (0..of.len()).fold(0, |best, one| if of[one] > of[best] { one } else { best });
                let name = pick(of, &mut random);
                let called = || estimate.mean().iter().copied().enumerate();
                named.extend(called().map(|(value, p)| (p, value == name)));
                held_most.extend(called().map(|(value, p)| (p, value == most)));
            }
            cost = world.cost;
        }
        let [found, of_most] =
            [named, held_most].map(|called| Calibration::from_predictions(called, [0.05, 0.95], BINS));
        let [ece, ece_of_most] = [&found, &of_most].map(|found| found.ece.expect("predictions"));
        println!(
            "{layout}, {LOOKED_AT} humans asked once about each aspect: expected calibration error {ece:.4} ({ece_of_most:.4} \
             if they name what they hold most likely)"
        );
        for bin in &found.bins {
            println!("  called {:.3}   held {:.3}   ({})", bin.predicted, bin.observed, bin.n);
        }
        assert!(ece <= 0.05, "{layout}: {ece}");
    }
}
