//! The choice model.

use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::AspectId;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::ChoiceModel;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::choice::ChoiceParameters;

use super::{aspect, state};
use crate::files::kitchen;

#[test]
fn decisions_are_distributions_and_exact_sums_agree_with_many_draws() {
    for (layout, there, falsely) in [
        ("sushi", ["order_1: shrimp nigiri", "human_hand: nori"], ["cooking_pot: shrimp raw", "assembly_board: empty"]),
        ("burger", ["order: leaf burger", "shelf: cheese"], ["grill_plate: soy raw", "shelf: empty"]),
    ] {
        let kitchen = kitchen(layout);
        let mut cost = CostToGo::new(kitchen.clone());
        let state = state(&kitchen, &there);
        let mut held = Belief::of_truth(&kitchen, state);
        for one in falsely {
            let (name, label) = one.split_once(": ").expect("an aspect and a value");
            let id = aspect(&kitchen, name);
            let labels = &kitchen.aspects[id.index()].labels;
            let mut weights = vec![0.0; labels.len()];
            weights[kitchen.true_value(state, id)] += 0.4;
            weights[labels.iter().position(|other| other == label).expect("a value")] += 0.6;
            held.set(id, &weights);
        }
        let exact_model = ChoiceParameters::default();
        let exact_worlds = exact_model.worlds(&kitchen, &held, &mut stream(1, "test", 0));
        assert!(exact_worlds.all.len() <= 4, "{layout}: {} worlds", exact_worlds.all.len());
        let weight: f64 = exact_worlds.all.iter().map(|one| one.weight).sum();
        assert!((weight - 1.0).abs() < 1e-12);
        let exact = ChoiceModel::new(&kitchen, &exact_model).probabilities(&mut cost, &exact_worlds);
        // A trace of everything else keeps the sum from being exact, and leaves it where it was.
        for index in 0..kitchen.aspects.len() {
            let id = AspectId(index as u8);
            let weights: Vec<f64> =
                held.distribution(id).iter().map(|p| p + 3e-3 / kitchen.aspects.len() as f64).collect();
            held.set(id, &weights);
        }
        for (index, count) in [1usize, 2, 32, 4096].into_iter().enumerate() {
            let model = ChoiceParameters { cases: count, ..ChoiceParameters::default() };
            let worlds = model.worlds(&kitchen, &held, &mut stream(1, "test", index as u64));
            let drawn = ChoiceModel::new(&kitchen, &model).probabilities(&mut cost, &worlds);
            let sum: f64 = drawn.press.iter().sum();
            assert!((sum - 1.0).abs() < 1e-9 && (0.0..=1.0).contains(&drawn.wait), "{layout}: {drawn:?}");
            assert!(drawn.press.iter().all(|&p| p > 1e-5), "no press is impossible");
            let apart: f64 = drawn.press.iter().zip(&exact.press).map(|(a, b)| (a - b).abs()).sum::<f64>() / 2.0;
            println!("{layout}: {count} cases, total variation {apart:.3} to the exact sum");
            assert!(count < 4096 || apart < 0.1, "{layout}: {apart} off with {count} cases");
        }
    }
}

#[test]
fn one_waits_where_only_the_robot_can_go_on() {
    let kitchen = kitchen("sushi");
    let mut cost = CostToGo::new(kitchen.clone());
    let model = ChoiceParameters::default();
    let mut waits = |there: &[&str]| {
        let belief = Belief::of_truth(&kitchen, state(&kitchen, there));
        let worlds = model.worlds(&kitchen, &belief, &mut stream(1, "test", 0));
        let chances = ChoiceModel::new(&kitchen, &model).probabilities(&mut cost, &worlds);
        // Compared with the likeliest press.
        chances.wait / ((1.0 - chances.wait) * chances.press.iter().copied().fold(0.0, f64::max))
    };
    assert!(waits(&["order_1: salmon maki"]) < 0.2, "there is much to do");
    assert!(waits(&["order_1: tuna maki", "assembly_board: rice cooked + nori", "robot_hand: tuna raw"]) > 5.0);
    assert!(waits(&[]) > 5.0, "nothing is wanted");
}
