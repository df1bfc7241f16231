//! The choice model and the belief behind a press.

use std::convert::Infallible;

use tomcom::analysis::follower::SessionFollower;
use tomcom::analysis::likelihood::PressLogLikelihood;
use tomcom::analysis::trial_summary::{FalseBeliefErrorSummary, TrialSummary};
use tomcom::run::engine::SessionEngine;
use tomcom::run::headless;
use tomcom::session::{Event, Session, SessionSpec, TimestampedEvent};
use tomcom_core::base::rng::stream;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, WeightedWorlds, World};
use tomcom_core::measures::belief_detection::{BeliefsBeforePress, EstimateBeforePress, TrialBeliefs};
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::choice_parameters::ChoiceParameters;
use tomcom_core::mind::{ChoiceModel, RecordedBelief};

use super::{aspect, kitchen, state};

fn settings(participant: &str) -> SessionSpec {
    let text = format!(
        "layout = \"\"\nseed = 5\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n[participant]\n{participant}\n"
    );
    toml::from_str(&text).expect("settings of a session")
}

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

#[test]
fn a_belief_can_be_told_from_its_witness() {
    for layout in ["sushi", "burger"] {
        let kitchen = kitchen(layout);
        let mut engine = SessionEngine::new(kitchen.clone(), settings(""), 0, CostToGo::new(kitchen.clone()));
        let mut witnesses: Vec<RecordedBelief> = Vec::new();
        let mut told = Vec::new();
        let mut replay =
            SessionFollower::new(Session::new(kitchen.clone(), settings(""), 0), CostToGo::new(kitchen.clone()));
        let mut keep = |stamped: &TimestampedEvent| {
            replay.apply(stamped).expect("what was recorded can be replayed");
            if let Event::ParticipantBelieves(witness) = &stamped.event {
                let state = replay.session.state;
                told.push((state, Belief::of_witness(&kitchen, state, witness).expect("a belief of this kitchen")));
                witnesses.push(witness.clone());
            }
            Ok::<(), Infallible>(())
        };
        headless::run(&mut engine, &mut keep).unwrap_or_else(|never| match never {});
        assert!(told.len() > 100);
        for ((state, belief), witness) in told.iter().zip(&witnesses) {
            for (index, held) in witness.aspects.iter().enumerate() {
                let (id, labels) = (AspectId(index as u8), &kitchen.aspects[index].labels);
                let values = belief.distribution(id);
                assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-9);
                assert!((belief.p_truth(&kitchen, *state, id) - held.p_truth).abs() < 1e-3, "{held:?}");
                let most = (0..values.len()).fold(0, |best, one| if values[one] > values[best] { one } else { best });
                assert_eq!(labels[most], held.believes);
            }
        }
        // What does not fit is no belief, and brings nothing down.
        let (state, good) = (told[0].0, &witnesses[0]);
        let spoilt = |change: fn(&mut RecordedBelief)| {
            let mut witness = good.clone();
            change(&mut witness);
            Belief::of_witness(&kitchen, state, &witness)
        };
        assert_eq!(spoilt(|witness| witness.aspects.truncate(3)), None);
        assert_eq!(spoilt(|witness| witness.aspects[0].p_truth = f64::NAN), None);
        assert_eq!(spoilt(|witness| witness.aspects[0].p_truth = -0.5), None);
        assert_eq!(spoilt(|witness| witness.aspects[1].values.extend([("a shoe".to_string(), 0.5)])), None);
        // The session that ran and its replay say the same.
        let (ran, replayed) = (engine.into_follower(), replay);
        assert_eq!(TrialSummary::from_follower(&ran), TrialSummary::from_follower(&replayed));
    }
}

#[test]
fn what_nobody_knows_stays_unknown() {
    let kitchen = kitchen("sushi");
    let figures = |participant: &str| {
        let follower = SessionFollower::new(
            Session::new(kitchen.clone(), settings(participant), 0),
            CostToGo::new(kitchen.clone()),
        );
        FalseBeliefErrorSummary::from_trials([&TrialSummary::from_follower(&follower)])
    };
    let nobody = figures("kind = \"keyboard\"\ngaze = \"none\"");
    assert_eq!(nobody, FalseBeliefErrorSummary::default(), "a person tells no beliefs");
    let simulated = figures("");
    assert_eq!((simulated.belief_related_errors, simulated.sequences), (Some(0), Some(0)));
    assert_eq!(simulated.mean_sequence_length, None, "no mean of nothing");
}

#[test]
fn a_human_who_knows_everything_is_fitted_to_the_presses() {
    let kitchen = kitchen("sushi");
    let mut cost = CostToGo::new(kitchen.clone());
    let there = state(&kitchen, &["order_1: salmon maki", "human_hand: nori"]);
    let (board, trash) = (kitchen.board, kitchen.button_named(Agent::Human, "trash").expect("a button"));
    let put = kitchen.button_named(Agent::Human, &kitchen.location(board).name.clone()).expect("a button");
    let press = |button, log_p| BeliefsBeforePress {
        state: there,
        button,
        held: None,
        estimate: Some(EstimateBeforePress { p_false: vec![0.0; kitchen.aspects.len()], log_p }),
        unseen_change: vec![false; kitchen.locations.len()],
        since_change_s: vec![None; kitchen.locations.len()],
        errs_about: Vec::new(),
    };
    // The wise press nine times of ten.
    let of_trial: TrialBeliefs = (0..20).map(|index| press(if index % 10 == 0 { trash } else { put }, -0.1)).collect();
    let trials = vec![of_trial; 5];
    let model = ChoiceParameters::default();
    let found = PressLogLikelihood::from_trials(&kitchen, &mut cost, &model, &trials, &[0, 1, 2, 3, 4], 1);
    let informed = found.informed.expect("presses");
    let best = 0.9 * 0.9_f64.ln() + 0.1 * 0.1_f64.ln();
    assert!(informed < 0.0 && informed <= best + 1e-9, "no better than knowing the shares: {found:?}");
    let truth = WeightedWorlds::certain(World::with_true_recipes(&kitchen, there));
    let unfitted = ChoiceModel::new(&kitchen, &model).probabilities(&mut cost, &truth).press;
    let unfitted = 0.9 * unfitted[put.index()].ln() + 0.1 * unfitted[trash.index()].ln();
    assert!(informed > unfitted, "fitting makes it likelier: {informed} against {unfitted}");
    assert_eq!(found.uniform, Some(-(kitchen.buttons[Agent::Human.index()].len() as f64).ln()));
    let gain = found.gain.expect("an estimate");
    assert!((gain - (-0.1 - informed)).abs() < 1e-9);
    // Trials that are all alike leave no doubt.
    let [from, to] = found.gain_interval.expect("an interval");
    assert!((from - gain).abs() < 1e-9 && (to - gain).abs() < 1e-9);
    assert_eq!(
        PressLogLikelihood::from_trials(&kitchen, &mut cost, &model, &[], &[], 1),
        PressLogLikelihood::default()
    );
}
