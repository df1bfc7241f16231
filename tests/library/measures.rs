//! Measures: why presses were errors, which errors belong together, and for how long a belief was false.

use std::convert::Infallible;
use std::path::Path;
use std::sync::Arc;

use rand::RngExt;
use tomcom::analysis::follower::Follower;
use tomcom::analysis::trial_summary::{BeliefErrorSummary, TrialSummary};
use tomcom::base::rng::stream;
use tomcom::base::time::SessionTime;
use tomcom::edge::files::read_kitchen;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{
    Agent, AspectId, ButtonId, DishId, Kitchen, LocationId, OrderContent, State, WeightedWorlds, World,
};
use tomcom::measures::JudgedPress;
use tomcom::measures::attribution::{Attributor, Cause, Target};
use tomcom::measures::beliefs::{Detection, EstimateView, PressView, TrialView};
use tomcom::measures::detection::{Calibration, auc};
use tomcom::measures::errors::{PressJudge, PressVerdict};
use tomcom::measures::flags::Thresholds;
use tomcom::measures::likelihood::LogLikelihood;
use tomcom::measures::matching::{
    CommunicationEvent, CommunicationKind, CommunicationTarget, MatchCounts, MatchCriterion, Similarity, matched,
};
use tomcom::measures::sequences::{Episodes, Sequence, sequences, sequences_by_target};
use tomcom::measures::wizard::{
    FalseBeliefPeriod, SignalVerdict, TimeSummary, TrainingCriterion, WizardMeasures, WizardSignal, worths,
};
use tomcom::mind::BeliefWitness;
use tomcom::mind::ChoiceModel;
use tomcom::mind::belief::Belief;
use tomcom::mind::decision::DecisionModel;
use tomcom::run::engine::Engine;
use tomcom::run::headless;
use tomcom::session::{Event, Session, SessionSpec, Stamped};

fn kitchen(name: &str) -> Arc<Kitchen> {
    match read_kitchen(Path::new(&format!("layouts/{name}.toml"))) {
        Ok(files) => Arc::new(files.kitchen),
        Err(error) => panic!("{error}"),
    }
}

fn settings(participant: &str) -> SessionSpec {
    let text = format!(
        "layout = \"\"\nseed = 5\n[trial]\ncondition = \"none\"\n[assistant]\nshadow = \"off\"\n[participant]\n{participant}\n"
    );
    toml::from_str(&text).expect("settings of a session")
}

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

fn aspect(kitchen: &Kitchen, name: &str) -> AspectId {
    let index = kitchen.aspects.iter().position(|aspect| aspect.name == name);
    AspectId(index.unwrap_or_else(|| panic!("no aspect {name}")) as u8)
}

fn dish(kitchen: &Kitchen, name: &str) -> DishId {
    DishId(kitchen.dishes.iter().position(|dish| dish.name == name).expect("a dish") as u8)
}

/// Places and orders given as "name: content".
fn state(kitchen: &Kitchen, there: &[&str]) -> State {
    let mut state = kitchen.empty_state();
    for (name, content) in there.iter().filter_map(|one| one.split_once(": ")) {
        let location = kitchen.location_named(name).expect("a location");
        match kitchen.orders.contains(&location) {
            true => state.set_order(location, OrderContent::Dish(dish(kitchen, content))),
            false => state.set_content(location, kitchen.content_named(content).expect("a content")),
        }
    }
    state
}

/// Everything as it is but what is given as "aspect: value", each believed to `sure`; what is left is spread evenly.
fn belief(kitchen: &Kitchen, state: State, falsely: &[&str], sure: f64) -> Belief {
    let mut belief = Belief::of_truth(kitchen, state);
    for index in 0..kitchen.aspects.len() {
        let (id, one) = (AspectId(index as u8), &kitchen.aspects[index]);
        let held = falsely.iter().filter_map(|told| told.split_once(": ")).find(|(name, _)| *name == one.name);
        let value = match held {
            Some((name, label)) => {
                let value = one.labels.iter().position(|other| other == label);
                value.unwrap_or_else(|| panic!("{label} is no value of {name}: {:?}", one.labels))
            }
            None => kitchen.true_value(state, id),
        };
        let mut weights = vec![(1.0 - sure) / (one.labels.len() - 1) as f64; one.labels.len()];
        weights[value] = sure;
        belief.set(id, &weights);
    }
    belief
}

/// A press in a kitchen under a belief is an error, and for this reason: "slip", or the labels of its targets.
fn check(layout: &str, there: &[&str], falsely: &[&str], pressed: &str, why: &[&str]) {
    let kitchen = kitchen(layout);
    let mut cost = CostToGo::new(kitchen.clone());
    let state = state(&kitchen, there);
    let button = kitchen.button_named(Agent::Human, pressed).expect("a button");
    let press = kitchen.try_press(state, Agent::Human, button);
    let verdict = PressJudge::new(kitchen.clone()).human_pressed(&mut cost, at(1.0), &press);
    assert!(verdict.error, "{pressed} is no error: {verdict:?}");
    let attributor = Attributor::new(DecisionModel::default(), 1);
    for (sure, index) in [(1.0, 0), (0.97, 1), (0.97, 2), (0.97, 3)] {
        let belief = belief(&kitchen, state, falsely, sure);
        let cause = attributor.cause(&kitchen, &mut cost, &belief, &press, index);
        let found: Vec<String> = match cause {
            Cause::Slip => vec!["slip".to_string()],
            Cause::Belief { target, with, .. } => {
                [Some(target), with].into_iter().flatten().map(|target| target.label(&kitchen)).collect()
            }
        };
        let mut sorted = found.clone();
        sorted.sort();
        assert_eq!(sorted, why, "{pressed} with {falsely:?} held to {sure}: {cause:?}");
    }
}

#[test]
fn a_confused_recipe_leads_to_the_wrong_ingredient() {
    let falsely = ["recipe of shrimp nigiri: rice shaped + nori + crab cut"];
    check("sushi", &["order_1: shrimp nigiri"], &falsely, "take crab", &["shrimp nigiri of order 1"]);
    let falsely = ["recipe of garden burger: light bun + cheese + soy grilled + tomato sliced"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["garden burger of order"]);
}

#[test]
fn an_order_that_was_misread_counts_as_one_target_with_its_recipe() {
    check("sushi", &["order_1: crab maki"], &["order_1: shrimp nigiri"], "take shrimp", &["crab maki of order 1"]);
    let falsely = ["order: classic burger"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["garden burger of order"]);
}

#[test]
fn an_error_without_a_false_belief_is_a_slip() {
    check("sushi", &["order_1: salmon maki", "human_hand: nori"], &[], "trash", &["slip"]);
    check("burger", &["order: garden burger", "human_hand: soy raw"], &[], "trash", &["slip"]);
    // A false belief that has nothing to do with it does not make it one.
    let falsely = ["recipe of tuna maki: crab maki", "counter: rice cooked"];
    check("sushi", &["order_1: salmon maki", "human_hand: nori"], &falsely, "trash", &["slip"]);
}

#[test]
fn what_is_done_already_is_done_again_by_those_who_did_not_see_it() {
    let there = ["order_1: tuna maki", "cooking_pot: rice cooked"];
    check("sushi", &there, &["cooking_pot: rice raw"], "cook", &["cooking pot"]);
    let there = ["order: garden burger", "grill_plate: soy grilled", "board: light bun + cheese"];
    check("burger", &there, &["grill_plate: soy raw"], "grill", &["grill plate"]);
}

#[test]
fn two_false_beliefs_that_each_suffice_are_named_together() {
    let there = ["order_1: salmon nigiri", "order_2: salmon maki"];
    let falsely = ["recipe of salmon nigiri: rice shaped + nori + crab cut", "recipe of salmon maki: crab maki"];
    let why = ["salmon maki of order 2", "salmon nigiri of order 1"];
    check("sushi", &there, &falsely, "take crab", &why);
    // Mending one of them alone leaves a good reason to press.
    check("sushi", &there, &falsely[..1], "take crab", &why[1..]);
}

/// Presses by letters, one a second: `.` correct, `s` slip, `r` race, other letters belief related errors about that
/// location.
fn presses(text: &str) -> Vec<JudgedPress> {
    let press = |(index, letter): (usize, char)| {
        let cause = match letter {
            '.' | 'r' => None,
            's' => Some(Cause::Slip),
            letter => {
                let target = Target::Place(LocationId(letter as u8 - b'A'));
                Some(Cause::Belief { gain_nats: 2.0, target, with: None })
            }
        };
        let (race, error) = (letter == 'r', cause.is_some());
        let verdict = PressVerdict { regret: i32::from(error), excess: i32::from(error), race, error };
        JudgedPress { seq: index as u64, time: at(index as f64), verdict, belief_known: true, cause }
    };
    text.chars().enumerate().map(press).collect()
}

/// Sequences as target, length, beginning and recovery in seconds (-1: none).
fn told(sequences: &[Sequence]) -> Vec<(char, u32, i32, i32)> {
    let tell = |one: &Sequence| {
        let Target::Place(LocationId(place)) = one.target else { panic!("a place") };
        let recovered = one.recovered.map_or(-1, |time| time.as_secs_f64() as i32);
        (char::from(b'A' + place), one.length, one.began.as_secs_f64() as i32, recovered)
    };
    sequences.iter().map(tell).collect()
}

#[test]
fn a_sequence_ends_where_more_than_three_presses_are_right() {
    let check = |text: &str, expected: &[(char, u32, i32, i32)], by_target: &[(char, u32, i32, i32)]| {
        assert_eq!(told(&sequences(&presses(text))), expected, "{text}");
        assert_eq!(told(&sequences_by_target(&presses(text))), by_target, "{text} by target");
    };
    check("", &[], &[]);
    check("..s.r.s", &[], &[]);
    check(".A.", &[('A', 1, 1, 2)], &[('A', 1, 1, 2)]);
    check("A...A", &[('A', 2, 0, -1)], &[('A', 2, 0, -1)]);
    check("A....A.", &[('A', 1, 0, 1), ('A', 1, 5, 6)], &[('A', 1, 0, 1), ('A', 1, 5, 6)]);
    // Slips and races are no correct presses, and are no part of a sequence.
    check("A..sr.As.", &[('A', 2, 0, 8)], &[('A', 2, 0, 8)]);
    // Whatever the errors are about; the most frequent target names the sequence, of equals the first.
    check("AB.BA.B...", &[('B', 5, 0, 7)], &[('A', 2, 0, 5), ('B', 3, 1, 7)]);
    check("BA.AB", &[('B', 4, 0, -1)], &[('B', 2, 0, -1), ('A', 2, 1, -1)]);
    // By single targets they fragment: an error about something else is no correct press, but keeps nothing together.
    check("A..B..A.", &[('A', 3, 0, 7)], &[('A', 1, 0, 1), ('B', 1, 3, 4), ('A', 1, 6, 7)]);
}

#[test]
fn an_episode_lasts_from_the_change_that_was_missed_to_the_look_that_mends_it() {
    let kitchen = kitchen("sushi");
    let pot = kitchen.location_named("cooking_pot").expect("a pot");
    let raw = state(&kitchen, &["order_1: tuna maki", "cooking_pot: rice raw"]);
    let cooked = state(&kitchen, &["order_1: tuna maki", "cooking_pot: rice cooked"]);
    let unseen = ["cooking_pot: rice raw"];
    let confused = ["cooking_pot: rice raw", "recipe of crab maki: rice cooked + nori + shrimp cut"];
    let mut changed_at = vec![SessionTime::ZERO; kitchen.locations.len()];
    let mut episodes = Episodes::default();
    let believe = |episodes: &mut Episodes, seconds, state, falsely: &[&str], changed_at: &[SessionTime]| {
        episodes.believed(&kitchen, at(seconds), state, &belief(&kitchen, state, falsely, 0.9), changed_at);
    };
    let wrong = Cause::Belief { gain_nats: 3.0, target: Target::Place(pot), with: None };
    believe(&mut episodes, 2.0, raw, &[], &changed_at);
    changed_at[pot.index()] = at(3.0);
    // A harmless false belief (the recipe) is no episode.
    believe(&mut episodes, 4.0, cooked, &confused, &changed_at);
    assert_eq!(episodes.harmful().count(), 0, "no error yet");
    episodes.erred(&kitchen, Cause::Slip);
    episodes.erred(&kitchen, wrong);
    believe(&mut episodes, 6.0, cooked, &unseen, &changed_at);
    episodes.erred(&kitchen, wrong);
    let tell = |episodes: &Episodes| {
        let tell = |one: &tomcom::measures::sequences::Episode| {
            (one.began.as_secs_f64(), one.corrected.map(SessionTime::as_secs_f64), one.errors)
        };
        episodes.harmful().map(tell).collect::<Vec<_>>()
    };
    assert_eq!(tell(&episodes), [(3.0, None, 2)], "still open");
    believe(&mut episodes, 8.0, cooked, &[], &changed_at);
    assert_eq!(tell(&episodes), [(3.0, Some(8.0), 2)]);
    // An error that is put down to it afterwards finds no false belief.
    episodes.erred(&kitchen, wrong);
    assert_eq!(tell(&episodes), [(3.0, Some(8.0), 2)]);
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
        let exact_model = DecisionModel::default();
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
            let model = DecisionModel { cases: count, ..DecisionModel::default() };
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
    let model = DecisionModel::default();
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
        let mut engine = Engine::new(kitchen.clone(), settings(""), 0, CostToGo::new(kitchen.clone()));
        let mut witnesses: Vec<BeliefWitness> = Vec::new();
        let mut told = Vec::new();
        let mut replay = Follower::new(Session::new(kitchen.clone(), settings(""), 0), CostToGo::new(kitchen.clone()));
        let mut keep = |stamped: &Stamped| {
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
        let spoilt = |change: fn(&mut BeliefWitness)| {
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
        let follower =
            Follower::new(Session::new(kitchen.clone(), settings(participant), 0), CostToGo::new(kitchen.clone()));
        BeliefErrorSummary::from_trials([&TrialSummary::from_follower(&follower)])
    };
    let nobody = figures("kind = \"keyboard\"\ngaze = \"none\"");
    assert_eq!(nobody, BeliefErrorSummary::default(), "a person tells no beliefs");
    let simulated = figures("");
    assert_eq!((simulated.belief_related_errors, simulated.sequences), (Some(0), Some(0)));
    assert_eq!(simulated.mean_sequence_length, None, "no mean of nothing");
}

#[test]
fn the_area_under_the_roc_counts_pairs_in_order_and_ties_as_half() {
    let check = |cases: &[f64], others: &[f64], expected: Option<f64>| {
        let scored: Vec<(f64, bool)> =
            cases.iter().map(|&score| (score, true)).chain(others.iter().map(|&score| (score, false))).collect();
        assert_eq!(auc(&scored), expected, "{cases:?} against {others:?}");
    };
    check(&[0.9, 0.8], &[0.1, 0.2, 0.3], Some(1.0));
    check(&[0.1], &[0.9], Some(0.0));
    check(&[0.5, 0.5], &[0.5], Some(0.5));
    // Pairs in order: 0.9 beats all three; 0.4 beats 0.1, ties with 0.4, loses to 0.6: 4.5 of 6.
    check(&[0.4, 0.9], &[0.1, 0.4, 0.6], Some(0.75));
    check(&[], &[0.5], None);
    check(&[0.5], &[], None);
}

#[test]
fn the_calibration_error_weighs_bins_by_their_predictions() {
    let predictions = [(0.62, true), (0.68, false), (0.15, false), (0.01, true), (0.99, false)];
    let found = Calibration::from_predictions(predictions, [0.0, 0.95], 19);
    // Bins of 0.05: 0.62 in one, 0.68 in another, 0.15 (on the edge) in a third, 0.01 in the first; 0.99 is out of range.
    assert!((found.ece.expect("predictions") - (0.38 + 0.68 + 0.15 + 0.99) / 4.0).abs() < 1e-12, "{found:?}");
    let found = Calibration::from_predictions(predictions, [0.05, 0.95], 2);
    // From 0.05 to 0.5: 0.15, none true; from 0.5 to 0.95: 0.62 and 0.68, half of them true.
    assert!((found.ece.expect("predictions") - (0.15 + 2.0 * 0.15) / 3.0).abs() < 1e-12, "{found:?}");
    assert_eq!(Calibration::from_predictions([(0.99, true)], [0.05, 0.95], 10).ece, None);
}

/// A trial about two aspects of a kitchen: letters of the location, then of the recipe, then the estimates in tenths.
/// `.` is believed right, `w` wrong, `E` wrong and the reason of an error.
fn trial(kitchen: &Kitchen, place: AspectId, recipe: AspectId, text: [&str; 4]) -> TrialView {
    let letters: Vec<Vec<char>> = text.iter().map(|letters| letters.chars().collect()).collect();
    let press = |index: usize| {
        let (mut held, mut p_wrong) = (vec![0.9; kitchen.aspects.len()], vec![0.0; kitchen.aspects.len()]);
        let mut errs_about = Vec::new();
        for (group, aspect) in [place, recipe].into_iter().enumerate() {
            if letters[group][index] != '.' {
                held[aspect.index()] = 0.2;
            }
            if letters[group][index] == 'E' {
                errs_about.push(aspect);
            }
            let tenths = letters[group + 2][index].to_digit(10).expect("a digit");
            p_wrong[aspect.index()] = f64::from(tenths) / 10.0;
        }
        PressView {
            state: kitchen.empty_state(),
            button: ButtonId(0),
            held: Some(held),
            estimate: Some(EstimateView { p_wrong, log_p: -1.0 }),
            unseen_change: vec![false; kitchen.locations.len()],
            errs_about,
        }
    };
    (0..letters[0].len()).map(press).collect()
}

#[test]
fn flags_catch_an_episode_between_its_beginning_and_the_third_error() {
    let kitchen = kitchen("sushi");
    let (place, recipe) = (aspect(&kitchen, "cooking_pot"), aspect(&kitchen, "recipe of crab maki"));
    let check = |text: [&str; 4], episodes: u64, caught: Option<f64>, false_flags: f64| {
        let trials = [trial(&kitchen, place, recipe, text)];
        let thresholds = Thresholds { locations: 0.5, recipes: 0.3 };
        let flags = Detection::from_trials(&kitchen, &trials, Some(thresholds)).flags;
        assert_eq!((flags.episodes, flags.flagged_before_third_error), (Some(episodes), caught), "{text:?}");
        let rate = 20.0 * false_flags / text[0].len() as f64;
        assert!((flags.false_flags_per_20_actions.expect("a rate") - rate).abs() < 1e-12, "{text:?}: {flags:?}");
    };
    // One error makes no episode of two; a flag before the belief is false is a false one; one that stays is raised once.
    check([".wE..", ".....", "08800", "00000"], 0, None, 0.0);
    check(["..EE.", ".....", "88880", "00000"], 1, Some(1.0), 1.0);
    check(["..EE.", ".....", "88000", "00000"], 1, Some(0.0), 1.0);
    // Before the third error counts, from then on not.
    check(["EEEw.", ".....", "00800", "00000"], 1, Some(1.0), 0.0);
    check(["EEEw.", ".....", "00080", "00000"], 1, Some(0.0), 0.0);
    // Without a third error, until it is over; each group has its own threshold.
    check(["EEww.", "EwwE.", "00040", "00400"], 2, Some(0.5), 0.0);
    // A flag that was right and stays too long is not raised again; one that comes back is.
    check(["EE...", ".....", "88808", "00000"], 1, Some(1.0), 1.0);
}

#[test]
fn thresholds_are_chosen_that_catch_most_within_what_is_allowed() {
    let kitchen = kitchen("sushi");
    let (place, recipe) = (aspect(&kitchen, "cooking_pot"), aspect(&kitchen, "recipe of crab maki"));
    let quiet = ".".repeat(60);
    let zero = "0".repeat(60);
    let text = [&format!("{quiet}EEw."), &format!("{quiet}...."), &format!("{zero}0702"), &format!("{zero}0000")];
    let found = Detection::from_trials(&kitchen, &[trial(&kitchen, place, recipe, text.map(String::as_str))], None);
    let flags = &found.flags;
    assert_eq!((flags.episodes, flags.flagged_before_third_error), (Some(1), Some(1.0)), "{flags:?}");
    assert_eq!(
        flags.false_flags_per_20_actions,
        Some(0.0),
        "of the thresholds that catch it the one without false flags"
    );
    let thresholds = flags.thresholds.expect("thresholds");
    assert!(thresholds.locations > 0.2 && thresholds.locations <= 0.7, "{thresholds:?}");
    // Of the pairs of a press and a location three were wrong, at 0, 0.7 and 0; all others are at 0 but one at 0.2.
    let others = (64 * kitchen.locations.len() - 3) as f64;
    let area = (others + 0.5 * (others - 1.0) + 0.5 * (others - 1.0)) / (3.0 * others);
    assert!((found.auc_locations.expect("an area") - area).abs() < 1e-12, "{:?} or {area}", found.auc_locations);
    let of_pot = (61.0 + 0.5 * 60.0 + 0.5 * 60.0) / (3.0 * 61.0);
    assert!((found.auc_mean_of_aspects.expect("an area") - of_pot).abs() < 1e-12, "{found:?}");
    assert_eq!((found.auc, found.auc_recipes), (found.auc_locations, None));
    assert_eq!(found.auc_baseline, Some(0.5), "nothing ever changed unseen");
}

#[test]
fn what_may_be_flagged_wrongly_is_a_share_of_the_time_of_all_aspects_together() {
    let kitchen = kitchen("sushi");
    let (place, recipe) = (aspect(&kitchen, "cooking_pot"), aspect(&kitchen, "recipe of crab maki"));
    let of = |doubted: usize| {
        let (right, known) = (".".repeat(64), "0".repeat(66));
        let estimates = format!("{}{}33", "0".repeat(64 - doubted), "3".repeat(doubted));
        let text = [&format!("{right}.."), &format!("{right}EE"), &known, &estimates];
        Detection::from_trials(&kitchen, &[trial(&kitchen, place, recipe, text.map(String::as_str))], None).flags
    };
    // 66 presses and 16 aspects: 1,056 pairs, of which 52 may be flagged wrongly; of the recipes' alone 5 % were 19.
    assert_eq!(of(40).flagged_before_third_error, Some(1.0));
    assert_eq!(of(60).flagged_before_third_error, Some(0.0));
}

#[test]
fn a_human_who_knows_everything_is_fitted_to_the_presses() {
    let kitchen = kitchen("sushi");
    let mut cost = CostToGo::new(kitchen.clone());
    let there = state(&kitchen, &["order_1: salmon maki", "human_hand: nori"]);
    let (board, trash) = (kitchen.board, kitchen.button_named(Agent::Human, "trash").expect("a button"));
    let put = kitchen.button_named(Agent::Human, &kitchen.location(board).name.clone()).expect("a button");
    let press = |button, log_p| PressView {
        state: there,
        button,
        held: None,
        estimate: Some(EstimateView { p_wrong: vec![0.0; kitchen.aspects.len()], log_p }),
        unseen_change: vec![false; kitchen.locations.len()],
        errs_about: Vec::new(),
    };
    // The wise press nine times of ten.
    let of_trial: TrialView = (0..20).map(|index| press(if index % 10 == 0 { trash } else { put }, -0.1)).collect();
    let trials = vec![of_trial; 5];
    let model = DecisionModel::default();
    let found = LogLikelihood::from_trials(&kitchen, &mut cost, &model, &trials, 1);
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
    assert_eq!(LogLikelihood::from_trials(&kitchen, &mut cost, &model, &[], 1), LogLikelihood::default());
}

/// A lane from "press:content" items: `q`, `w` are recipes of two orders, `a`, `b` highlights, `p` a proposal; a press is
/// two seconds.
fn lane(text: &str) -> Vec<CommunicationEvent> {
    let said = |item: &str| {
        let (press, letter) = item.split_once(':').expect("press:content");
        let press: u32 = press.parse().expect("a number");
        let (kind, target) = match letter {
            "q" => (CommunicationKind::Recipe, Some(0)),
            "w" => (CommunicationKind::Recipe, Some(1)),
            "a" => (CommunicationKind::Highlight, Some(2)),
            "b" => (CommunicationKind::Highlight, Some(3)),
            _ => (CommunicationKind::Proposal, None),
        };
        CommunicationEvent {
            press,
            clock: at(2.0 * f64::from(press)),
            content: CommunicationTarget { kind, target: target.map(LocationId) },
        }
    };
    text.split_whitespace().map(said).collect()
}

/// The figures of two lanes in a trial of so many presses.
fn alike(of: &str, with: &str, presses: u32, window: u32) -> Similarity {
    let mut tally = MatchCounts::default();
    tally.add(&lane(of), &lane(with), presses, window);
    tally.similarity()
}

fn near(found: Option<f64>, wanted: f64, what: &str) {
    let found = found.unwrap_or_else(|| panic!("{what} is null"));
    assert!((found - wanted).abs() < 1e-12, "{what} = {found}, not {wanted}");
}

#[test]
fn communications_match_one_to_one_within_the_window() {
    // Of the wizard's three, the recipe is one press early, the highlight too far, the third another target.
    let found = alike("4:q 10:a 20:b", "5:q 14:a 20:a", 30, 3);
    assert_eq!((found.of_n, found.with_n, found.matched), (3, 3, 1));
    near(found.strict.recall, 1.0 / 3.0, "recall");
    near(found.lenient.recall, 2.0 / 3.0, "lenient recall");
    near(found.timing.recall, 2.0 / 3.0, "recall by time");
    near(found.median_lead_s, -2.0, "the assistant came one press, two seconds, later");
    near(alike("4:q 10:a 20:b", "5:q 14:a 20:a", 30, 4).strict.recall, 2.0 / 3.0, "with a larger window");
    // One communication matches one, however many are near; the nearest, unless another pair would be lost.
    let found = alike("4:q", "2:q 4:q 6:q", 10, 3);
    assert_eq!(found.matched, 1);
    near(found.strict.precision, 1.0 / 3.0, "precision");
    near(found.strict.f1, 0.5, "F1");
    near(found.median_lead_s, 0.0, "the nearest");
    assert_eq!(matched(&lane("3:q 6:q"), &lane("5:q 9:q"), 3, MatchCriterion::Strict), [(0, 0), (1, 1)]);
    // Different targets may cross.
    assert_eq!(matched(&lane("3:q 4:a"), &lane("3:a 4:q"), 1, MatchCriterion::Strict), [(0, 1), (1, 0)]);
}

#[test]
fn what_cannot_be_said_of_empty_lanes_is_null() {
    let found = alike("", "3:q", 10, 3);
    assert_eq!((found.strict.recall, found.strict.f1), (None, Some(0.0)));
    assert_eq!((found.median_lead_s, found.chance_recall), (None, None));
    let nothing = alike("", "", 10, 3);
    assert_eq!((nothing.kappa, nothing.strict.f1), (None, None));
    assert_eq!(alike("2:q", "2:q", 4, 3).chance_recall, None, "too short for a shift by more than the window");
}

#[test]
fn kappa_is_over_presses_and_counts_matched_pairs_as_agreement() {
    // Nine presses make ten places: six silent, one agreed recipe, one only of each, one with two targets.
    let found = alike("2:q 4:a 8:a", "3:q 6:b 8:b", 9, 1);
    let units: f64 = 6.0 + 1.0 + 1.0 + 1.0 + 1.0;
    let agreed = 7.0 / units;
    // Margins of the first lane: nothing 7, q 1, a 2; of the second: nothing 7, q 1, b 2.
    let chance = (7.0 * 7.0 + 1.0) / (units * units);
    near(found.kappa, (agreed - chance) / (1.0 - chance), "kappa");
    near(alike("2:q 4:a", "2:q 4:a", 9, 3).kappa, 1.0, "kappa of equal lanes");
    let apart = alike("1:q", "8:q", 9, 0).kappa.expect("a kappa");
    assert!(apart < 0.0, "less than chance: {apart}");
}

#[test]
fn the_chance_level_is_what_circular_shifts_leave() {
    // Eleven places; the one communication of the second lane meets the first's in one of the ten shifts.
    near(alike("3:q", "7:q", 10, 0).chance_recall, 0.1, "one place of ten");
    // Without a shift by at most one press: eight shifts, of which seven to nine land within one press of press 3.
    near(alike("3:q", "7:q", 10, 1).chance_recall, 3.0 / 8.0, "three places of eight");
    near(alike("3:q", "7:w", 10, 1).chance_recall, 0.0, "another target never matches");
}

/// The most pairs, and with those the least presses between them, by trying everything.
fn most(of: &[CommunicationEvent], with: &[CommunicationEvent], window: u32, likeness: MatchCriterion) -> (usize, u32) {
    let Some((first, rest)) = of.split_first() else { return (0, 0) };
    let mut best = most(rest, with, window, likeness);
    for (index, other) in with.iter().enumerate() {
        let same = match likeness {
            MatchCriterion::Strict => first.content == other.content,
            MatchCriterion::Lenient => first.content.kind == other.content.kind,
            MatchCriterion::Timing => true,
        };
        let apart = first.press.abs_diff(other.press);
        if same && apart <= window {
            let left: Vec<CommunicationEvent> =
                with.iter().enumerate().filter(|(at, _)| *at != index).map(|(_, one)| *one).collect();
            let (pairs, between) = most(rest, &left, window, likeness);
            let found = (pairs + 1, between + apart);
            if found.0 > best.0 || found.0 == best.0 && found.1 < best.1 {
                best = found;
            }
        }
    }
    best
}

#[test]
fn no_matching_has_more_or_nearer_pairs() {
    let mut random = stream(1, "lanes", 0);
    for round in 0..300 {
        let mut draw = || {
            let mut presses: Vec<u32> = (0..random.random_range(0..6)).map(|_| random.random_range(0..14)).collect();
            presses.sort_unstable();
            let items: Vec<String> = presses
                .iter()
                .map(|press| format!("{press}:{}", ["q", "w", "a", "b", "p"][random.random_range(0..5)]))
                .collect();
            items.join(" ")
        };
        let (of, with) = (draw(), draw());
        let (a, b) = (lane(&of), lane(&with));
        let mut wider = 0;
        for window in 0..6 {
            for likeness in [MatchCriterion::Strict, MatchCriterion::Lenient, MatchCriterion::Timing] {
                let pairs = matched(&a, &b, window, likeness);
                let between: u32 = pairs.iter().map(|&(i, j)| a[i].press.abs_diff(b[j].press)).sum();
                let wanted = most(&a, &b, window, likeness);
                assert_eq!(
                    (pairs.len(), between),
                    wanted,
                    "round {round}: {of} | {with} within {window}, {likeness:?}"
                );
                let mirrored = matched(&b, &a, window, likeness);
                assert_eq!(mirrored.len(), pairs.len(), "it is symmetric");
            }
            let found = alike(&of, &with, 14, window);
            assert!(found.matched >= wider, "a wider window loses nothing");
            wider = found.matched;
            assert!(found.kappa.is_none_or(|kappa| kappa <= 1.0 + 1e-12));
            let shares = [found.strict.recall, found.strict.precision, found.strict.f1, found.chance_recall];
            assert!(shares.iter().flatten().all(|share| (0.0..=1.0 + 1e-12).contains(share)), "{shares:?}");
        }
    }
}

/// A signal about these aspects, so many seconds after the trial's beginning and after a press every two seconds.
fn sent(seconds: f64, aspects: &[u8]) -> WizardSignal {
    let aspects = aspects.iter().map(|&aspect| AspectId(aspect)).collect();
    WizardSignal { clock: at(seconds), press: (seconds / 2.0) as u32, aspects, to_display_ms: None, taken_back: false }
}

#[test]
fn a_wizards_signals_are_held_against_what_was_believed_wrong() {
    let spell = |aspect: u8, from: f64, until: f64, errors: u32| FalseBeliefPeriod {
        aspect: AspectId(aspect),
        began: at(from),
        corrected: Some((at(until), (until / 2.0) as u32)),
        errors,
    };
    let mut spells = vec![spell(1, 10.0, 30.0, 2), spell(2, 20.0, 26.0, 0), spell(3, 50.0, 60.0, 1)];
    spells.push(FalseBeliefPeriod { aspect: AspectId(4), began: at(80.0), corrected: None, errors: 1 });
    let signals = [
        (4.0, vec![1], SignalVerdict::Needless),
        (12.5, vec![1], SignalVerdict::Hit { latency_s: 2.5, spell: 0 }),
        (14.0, vec![1], SignalVerdict::Again),
        (21.0, vec![2], SignalVerdict::Harmless),
        // An order with its recipe: the one that led to an error counts.
        (22.0, vec![2, 1], SignalVerdict::Again),
        (24.0, vec![5], SignalVerdict::WrongTarget),
        // Right again since two presses; and since too long.
        (34.0, vec![1], SignalVerdict::Late),
        (40.0, vec![1], SignalVerdict::Needless),
        (90.0, vec![4], SignalVerdict::Hit { latency_s: 10.0, spell: 3 }),
    ];
    let all: Vec<WizardSignal> = signals.iter().map(|(seconds, aspects, _)| sent(*seconds, aspects)).collect();
    let wanted: Vec<SignalVerdict> = signals.iter().map(|(.., worth)| *worth).collect();
    assert_eq!(worths(&all, &spells), wanted);
    let found = WizardMeasures::from_signals(&all, Some(&spells));
    assert_eq!(
        (found.episodes, found.hits, found.omissions),
        (Some(3), Some(2), Some(1)),
        "the one of aspect 3 is missed"
    );
    assert_eq!(found.latency_s, TimeSummary::from_times(vec![2.5, 10.0]));
    let counts = [found.repeated, found.late, found.wrong_targets, found.needless, found.harmless];
    assert_eq!(counts, [2, 1, 1, 2, 1].map(Some));
    let named: u64 = counts.iter().flatten().sum::<u64>() + found.hits.unwrap_or(0);
    assert_eq!(named, found.signals, "every signal is one of these");
    // Of people nobody knows.
    let unknown = WizardMeasures::from_signals(&all, None);
    assert_eq!((unknown.signals, unknown.hits, unknown.omissions), (9, None, None));
    // Two of three hit; three of nine wrong.
    let met = |hits: f64, wrong: f64| TrainingCriterion { hits, wrong }.is_met(&found);
    assert!(met(0.66, 0.34) && !met(0.67, 0.34) && !met(0.66, 0.33));
    assert!(
        !TrainingCriterion { hits: 0.0, wrong: 1.0 }.is_met(&WizardMeasures::from_signals(&[], Some(&[]))),
        "nothing to hit"
    );
    let twice = WizardMeasures::sum([&found, &found]);
    assert_eq!((twice.hits, twice.signals), (Some(4), 18));
    assert_eq!(twice.latency_s, Some(TimeSummary { n: 4, median: 6.25, max: 10.0 }));
    assert_eq!(WizardMeasures::sum([&found, &unknown]).hits, None);
    // A signal more or less changes nothing about the others before it.
    for end in 0..all.len() {
        assert_eq!(worths(&all[..end], &spells), wanted[..end]);
    }
}
