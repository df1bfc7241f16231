//! Measures: why presses were errors, which errors belong together, for how long a belief was false, how well a wizard does.

mod detection;
mod matching;

use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, DishId, Kitchen, LocationId, OrderContent, State};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::{ErrorAttributor, ErrorCause, FalseBeliefTarget};
use tomcom_core::measures::errors::{PressJudge, PressVerdict};
use tomcom_core::measures::sequences::{ErrorSequence, FalseBeliefTracker, sequences, sequences_any_aspect};
use tomcom_core::measures::wizard_performance::{
    FalseBeliefPeriod, SignalVerdict, TimeSummary, TrainingCriterion, WizardMeasures, WizardSignal, verdicts,
};
use tomcom_core::mind::ChoiceModel;
use tomcom_core::mind::belief::Belief;
use tomcom_core::mind::choice::ChoiceParameters;

use crate::files::kitchen;

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

fn aspect(kitchen: &Kitchen, name: &str) -> AspectId {
    kitchen.aspect_named(name).unwrap_or_else(|| panic!("no aspect {name}"))
}

/// Places and orders given as "name: content".
fn state(kitchen: &Kitchen, there: &[&str]) -> State {
    let mut state = kitchen.empty_state();
    for (name, content) in there.iter().filter_map(|one| one.split_once(": ")) {
        let location = kitchen.location_named(name).expect("a location");
        match kitchen.orders.contains(&location) {
            true => state.set_order(location, OrderContent::Dish(kitchen.dish_named(content).expect("a dish"))),
            false => state.set_content(location, kitchen.content_named(content).expect("a content")),
        }
    }
    state
}

/// Everything as it is but what is given as "aspect: value", each believed to `sure`; what is left is spread evenly.
fn belief(kitchen: &Kitchen, state: State, falsely: &[&str], sure: f64) -> Belief {
    let mut belief = Belief::of_truth(kitchen, state);
    for (id, one) in kitchen.aspect_ids().zip(&kitchen.aspects) {
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
    let attributor = ErrorAttributor::new(ChoiceParameters::default(), 1);
    for (sure, index) in [(1.0, 0), (0.97, 1), (0.97, 2), (0.97, 3)] {
        let belief = belief(&kitchen, state, falsely, sure);
        let cause = attributor.cause(&kitchen, &mut cost, &belief, &press, index);
        let found: Vec<String> = match cause {
            ErrorCause::Slip | ErrorCause::Planning => vec!["slip".to_string()],
            ErrorCause::Belief { target, with, .. } => {
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
    check("sushi", &["order_1: shrimp nigiri"], &falsely, "take crab", &["recipe of shrimp nigiri (order 1)"]);
    let falsely = ["recipe of garden burger: light bun + cheese + soy grilled + tomato sliced"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["recipe of garden burger (order)"]);
}

#[test]
fn an_order_that_was_misread_counts_as_one_target_with_its_recipe() {
    check(
        "sushi",
        &["order_1: crab maki"],
        &["order_1: shrimp nigiri"],
        "take shrimp",
        &["recipe of crab maki (order 1)"],
    );
    let falsely = ["order: classic burger"];
    check("burger", &["order: garden burger"], &falsely, "take tomato", &["recipe of garden burger (order)"]);
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
    let why = ["recipe of salmon maki (order 2)", "recipe of salmon nigiri (order 1)"];
    check("sushi", &there, &falsely, "take crab", &why);
    // Mending one of them alone leaves a good reason to press.
    check("sushi", &there, &falsely[..1], "take crab", &why[1..]);
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
        for id in kitchen.aspect_ids() {
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

/// Presses by letters, one a second: `.` correct, `s` slip, `r` race, other letters belief related errors about that
/// location.
fn presses(text: &str) -> Vec<JudgedPress> {
    let press = |(index, letter): (usize, char)| {
        let cause = match letter {
            '.' | 'r' => None,
            's' => Some(ErrorCause::Slip),
            letter => {
                let target = FalseBeliefTarget::Place(LocationId(letter as u8 - b'A'));
                Some(ErrorCause::Belief { gain_nats: 2.0, target, with: None })
            }
        };
        let (race, error) = (letter == 'r', cause.is_some());
        let excess = i32::from(error);
        let verdict = PressVerdict { regret: excess, excess, race, error, is_proven: true, best: None };
        let before = kitchen("sushi").empty_state();
        let (seq, time, button) = (index as u64, at(index as f64), ButtonId(0));
        JudgedPress { seq, time, button, before, verdict, belief_known: true, cause }
    };
    text.chars().enumerate().map(press).collect()
}

#[test]
fn an_order_and_its_recipe_are_one_false_belief() {
    let (order, tuna, salmon) = (LocationId(0), DishId(0), DishId(1));
    let targets = [
        FalseBeliefTarget::Order(order, Some(tuna)),
        FalseBeliefTarget::Order(order, Some(salmon)),
        FalseBeliefTarget::Recipe(tuna),
        FalseBeliefTarget::Order(LocationId(1), Some(tuna)),
    ];
    let mut all = presses("AAAA");
    for (press, target) in all.iter_mut().zip(targets) {
        press.cause = Some(ErrorCause::Belief { gain_nats: 2.0, target, with: None });
    }
    let found = sequences(&all);
    // The salmon that comes in place of the tuna is another false belief.
    let errors: Vec<&[usize]> = found.iter().map(|one| one.errors.as_slice()).collect();
    assert_eq!(errors, [&[0, 2, 3][..], &[1]]);
}

/// Sequences as target, length, beginning and recovery in seconds (-1: none).
fn told(sequences: &[ErrorSequence]) -> Vec<(char, u32, i32, i32)> {
    let tell = |one: &ErrorSequence| {
        let FalseBeliefTarget::Place(LocationId(place)) = one.target else { panic!("a place") };
        let recovered = one.recovered.map_or(-1, |time| time.as_secs_f64() as i32);
        (char::from(b'A' + place), one.length(), one.began.as_secs_f64() as i32, recovered)
    };
    sequences.iter().map(tell).collect()
}

#[test]
fn a_sequence_ends_where_more_than_three_presses_are_right() {
    let check = |text: &str, any_aspect: &[(char, u32, i32, i32)], related: &[(char, u32, i32, i32)]| {
        assert_eq!(told(&sequences(&presses(text))), related, "{text}");
        assert_eq!(told(&sequences_any_aspect(&presses(text))), any_aspect, "{text}, whatever the aspect");
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
    // An error about something else is no correct press, but keeps nothing together.
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
    let mut episodes = FalseBeliefTracker::default();
    let believe = |episodes: &mut FalseBeliefTracker, seconds, state, falsely: &[&str], changed_at: &[SessionTime]| {
        episodes.believed(&kitchen, at(seconds), state, &belief(&kitchen, state, falsely, 0.9), changed_at);
    };
    let wrong = ErrorCause::Belief { gain_nats: 3.0, target: FalseBeliefTarget::Place(pot), with: None };
    believe(&mut episodes, 2.0, raw, &[], &changed_at);
    changed_at[pot.index()] = at(3.0);
    // A harmless false belief (the recipe) is no episode.
    believe(&mut episodes, 4.0, cooked, &confused, &changed_at);
    assert_eq!(episodes.harmful().count(), 0, "no error yet");
    episodes.erred(&kitchen, ErrorCause::Slip);
    episodes.erred(&kitchen, wrong);
    believe(&mut episodes, 6.0, cooked, &unseen, &changed_at);
    episodes.erred(&kitchen, wrong);
    let tell = |episodes: &FalseBeliefTracker| {
        let tell = |one: &tomcom_core::measures::sequences::FalseBeliefEpisode| {
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

/// A signal about these aspects, so many seconds after the trial's beginning and after a press every two seconds.
fn sent(seconds: f64, aspects: &[u8]) -> WizardSignal {
    let aspects = aspects.iter().map(|&aspect| AspectId(aspect)).collect();
    WizardSignal { clock: at(seconds), press: (seconds / 2.0) as u32, aspects, to_display_ms: None, taken_back: false }
}

#[test]
fn a_wizards_signals_are_held_against_what_was_believed_wrong() {
    let period = |aspect: u8, from: f64, until: f64, errors: u32| FalseBeliefPeriod {
        aspect: AspectId(aspect),
        began: at(from),
        corrected: Some((at(until), (until / 2.0) as u32)),
        errors,
    };
    let mut periods = vec![period(1, 10.0, 30.0, 2), period(2, 20.0, 26.0, 0), period(3, 50.0, 60.0, 1)];
    periods.push(FalseBeliefPeriod { aspect: AspectId(4), began: at(80.0), corrected: None, errors: 1 });
    let signals = [
        (4.0, vec![1], SignalVerdict::Needless),
        (12.5, vec![1], SignalVerdict::Hit { latency_s: 2.5, period: 0 }),
        (14.0, vec![1], SignalVerdict::Repeated),
        (21.0, vec![2], SignalVerdict::Harmless),
        // An order with its recipe: the one that led to an error counts.
        (22.0, vec![2, 1], SignalVerdict::Repeated),
        (24.0, vec![5], SignalVerdict::Wrong),
        // Right again since two presses; and since too long.
        (34.0, vec![1], SignalVerdict::Late),
        (40.0, vec![1], SignalVerdict::Needless),
        (90.0, vec![4], SignalVerdict::Hit { latency_s: 10.0, period: 3 }),
    ];
    let all: Vec<WizardSignal> = signals.iter().map(|(seconds, aspects, _)| sent(*seconds, aspects)).collect();
    let wanted: Vec<SignalVerdict> = signals.iter().map(|(.., verdict)| *verdict).collect();
    assert_eq!(verdicts(&all, &periods), wanted);
    let found = WizardMeasures::from_signals(&all, Some(&periods));
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
    let words = ["3 false beliefs with errors: 2 hit, 1 missed", "2 repeated, 1 late, 1 wrong, 2 needless, 1 harmless"];
    assert_eq!(found.words(), Some(words.map(str::to_string)));
    // Of people nobody knows.
    let unknown = WizardMeasures::from_signals(&all, None);
    assert_eq!(unknown.words(), None);
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
        assert_eq!(verdicts(&all[..end], &periods), wanted[..end]);
    }
}
