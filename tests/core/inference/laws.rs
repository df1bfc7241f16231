//! The inference of the human's belief: what it must hold whatever comes, and what its closed forms say.

use std::sync::Arc;

use rand::RngExt;
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, ContentId, Kitchen, LocationId, OrderContent, Press};
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::PAPER_2021;
use tomcom_core::mind::model::{HumanModel, InferenceSettings};
use tomcom_core::mind::observation::{Observation, ObservedEvidence, ProposedPresses};

use super::{Bench, any_number, any_state, at, looks_at_nothing};
use crate::files::kitchen;

const KITCHENS: [&str; 2] = ["sushi", "burger"];

/// Coarse, for tests of many presses.
fn coarse() -> HumanModel {
    let inference = InferenceSettings { beliefs: 8, states: 4, min_effective: 2.0, max_beliefs: 16, predictions: 8 };
    HumanModel { inference, ..HumanModel::default() }
}

/// Something that may happen in a session, or cannot happen at all.
fn anything(kitchen: &Kitchen, time: SessionTime, random: &mut Stream) -> ObservedEvidence {
    let agent = if random.random::<bool>() { Agent::Human } else { Agent::Robot };
    match random.random_range(0..14) {
        0 => ObservedEvidence::Started { state: any_state(kitchen, random) },
        1 => ObservedEvidence::Paused,
        2 => ObservedEvidence::Resumed,
        3 => ObservedEvidence::Displayed { state: any_state(kitchen, random) },
        4 => ObservedEvidence::Told { location: LocationId(random.random_range(0..kitchen.locations.len()) as u8) },
        5..=7 => {
            let button = ButtonId(random.random_range(0..kitchen.buttons[agent.index()].len()) as u8);
            let before = any_state(kitchen, random);
            let after = random.random::<bool>().then(|| any_state(kitchen, random));
            ObservedEvidence::Pressed(Press {
                agent,
                button,
                before,
                after: after.unwrap_or(before),
                effective: after.is_some(),
            })
        }
        13 => {
            let buttons = kitchen.buttons[Agent::Human.index()].len();
            let button = |_| ButtonId(random.random_range(0..buttons) as u8);
            ObservedEvidence::Proposed(ProposedPresses::new((0..3).map(button)))
        }
        _ => {
            let [x, y, confidence] = [(); 3].map(|()| any_number(random));
            let taken = match random.random_range(0..4) {
                0 => SessionTime(time.0.saturating_sub(random.random_range(0..2_000_000_000))),
                1 => SessionTime(time.0.saturating_add(random.random_range(0..2_000_000_000))),
                _ => time,
            };
            ObservedEvidence::Gaze { sample: GazeSample::new(x, y, confidence), taken }
        }
    }
}

#[test]
fn no_sequence_of_events_breaks_a_distribution() {
    for name in KITCHENS {
        let mut bench = Bench::new(name, coarse());
        let kitchen = bench.kitchen.clone();
        for sequence in 0..500 {
            let mut random = stream(11, "hostile sequences", sequence);
            let mut time = SessionTime::ZERO;
            bench.filter = BeliefFilter::new(kitchen.clone(), coarse(), sequence);
            for step in 0..24 {
                time = SessionTime(match random.random_range(0..6) {
                    // Back in time, a thousand samples a second, hours without anything.
                    0 => time.0.saturating_sub(random.random_range(0..1_000_000_000)),
                    1 | 2 => time.0 + 1_000_000,
                    3 => time.0 + 3_600_000_000_000 * random.random_range(1..20),
                    _ => time.0 + random.random_range(0..2_000_000_000),
                });
                let what = anything(&kitchen, time, &mut random);
                bench.observe(time.as_secs_f64(), what);
                bench.check(&format!("{name}, sequence {sequence}, step {step}, {what:?}"));
            }
        }
    }
}

#[test]
fn the_estimate_is_a_function_of_seed_and_events_alone() {
    let run = |cost: &mut CostToGo, kitchen: &Arc<Kitchen>| {
        let mut filter = BeliefFilter::new(kitchen.clone(), coarse(), 5);
        let mut random = stream(12, "events", 0);
        let mut log_p = Vec::new();
        for number in 0..120 {
            let time = at(number as f64);
            let what = if number == 0 {
                ObservedEvidence::Started { state: kitchen.empty_state() }
            } else {
                anything(kitchen, time, &mut random)
            };
            filter.observe(&Observation { time, what }, cost);
            log_p.push(filter.evidence().map(|evidence| evidence.log_p.to_bits()));
        }
        (filter.belief().clone(), log_p)
    };
    for name in KITCHENS {
        let kitchen = kitchen(name);
        let mut cost = CostToGo::new(kitchen.clone());
        let first = run(&mut cost, &kitchen);
        assert_eq!(run(&mut cost, &kitchen), first, "{name}: what is remembered changes nothing");
        let others = std::thread::scope(|scope| {
            let work = || scope.spawn(|| run(&mut CostToGo::new(kitchen.clone()), &kitchen));
            [work(), work()].map(|thread| thread.join().expect("it ends"))
        });
        assert!(others.iter().all(|other| *other == first), "{name}: nor do other threads");
    }
}

#[test]
fn reading_does_not_depend_on_the_sampling_rate() {
    let read = |hz: f64| {
        let mut bench = Bench::new("sushi", HumanModel::default());
        bench.order(0.5, "order_1", "tuna maki");
        bench.look(1.0, 0.3, "order_1", hz);
        // The first sample covers 1/15 s, whatever the rate: the same time is left out at each.
        bench.p("order_1", "tuna maki")
    };
    let (slow, usual, fast) = (read(60.0), read(120.0), read(1000.0));
    assert!((usual - slow).abs() < 0.02 && (usual - fast).abs() < 0.02, "{slow} {usual} {fast}");
    assert!((0.55..0.9).contains(&usual), "a third of a second reads four in five: {usual}");
}

#[test]
fn a_long_look_ends_in_the_confusion_matrix_and_elsewhere_nothing_changes() {
    let mut bench = Bench::new("sushi", looks_at_nothing());
    bench.order(0.5, "order_1", "tuna nigiri");
    bench.press(0.6, Agent::Robot, "take salmon");
    let before = bench.filter.belief().clone();
    bench.look(1.0, 8.0, "robot_hand", 120.0);
    let [right, alike] = [bench.p("robot_hand", "salmon raw"), bench.p("robot_hand", "tuna raw")];
    assert!((right - 0.95).abs() < 1e-3 && (alike - 0.04).abs() < 1e-3, "{right} {alike}");
    let far = bench.aspect("order_2");
    let moved = before.aspect(far).mean()[0] - bench.filter.belief().aspect(far).mean()[0];
    assert!(moved.abs() < 1e-6, "order 2 is {moved} otherwise");
}

#[test]
fn a_press_that_tells_nothing_changes_nothing() {
    let mut model = HumanModel::default();
    (model.decision.lapse, model.decision.lapse_anywhere) = (1.0, 1.0);
    let mut bench = Bench::new("sushi", model);
    bench.order(0.5, "order_1", "tuna nigiri");
    let before = bench.filter.belief().clone();
    bench.press(0.5, Agent::Human, "take rice");
    let hand = bench.aspect("human_hand");
    for index in (0..bench.kitchen.aspects.len()).filter(|&index| index != hand.index()) {
        let (old, new) = (&before.aspects[index], &bench.filter.belief().aspects[index]);
        let change = old.mean().iter().zip(new.mean()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(change < 1e-9, "{}: {change}", bench.kitchen.aspects[index].name);
        assert!((old.precision() / new.precision() - 1.0).abs() < 1e-6, "{old:?} {new:?}");
    }
}

#[test]
fn a_wrong_ingredient_tells_of_a_wrong_recipe() {
    for seed in 0..5 {
        let mut bench = Bench::seeded("sushi", HumanModel::default(), seed);
        bench.order(0.5, "order_1", "salmon nigiri");
        bench.look(1.0, 2.0, "order_1", 120.0);
        bench.look(3.0, 2.0, "order_2", 120.0);
        let before = bench.p("recipe of salmon nigiri", "salmon nigiri");
        bench.press(6.0, Agent::Human, "take shrimp");
        let after = bench.p("recipe of salmon nigiri", "salmon nigiri");
        let shrimp = bench.p("recipe of salmon nigiri", "shrimp nigiri");
        assert!(after < before - 0.2 && shrimp > 0.2, "{before} {after} {shrimp}");
    }
}

#[test]
fn one_knows_what_one_has_done_oneself() {
    let mut bench = Bench::new("sushi", HumanModel::default());
    bench.order(0.5, "order_1", "salmon nigiri");
    bench.press(1.0, Agent::Human, "take rice");
    assert!(bench.p("human_hand", "rice raw") > 0.999);
    bench.press(2.0, Agent::Human, "take nori");
    assert!(bench.p("human_hand", "rice raw") > 0.99, "without effect: the hand was not empty");
    bench.press(3.0, Agent::Human, "cooking_pot");
    assert!(bench.p("cooking_pot", "rice raw") > 0.99 && bench.p("human_hand", "empty") > 0.99);
    bench.press(4.0, Agent::Human, "cook");
    assert!(bench.p("cooking_pot", "rice cooked") > 0.99);
    bench.press(5.0, Agent::Human, "cook");
    assert!(bench.p("cooking_pot", "rice cooked") > 0.99, "nothing raw is in it");
    bench.press(6.0, Agent::Human, "trash");
    assert!(bench.p("human_hand", "empty") > 0.999);
    bench.press(7.0, Agent::Human, "cooking_pot");
    assert!(bench.p("human_hand", "rice cooked") > 0.99 && bench.p("cooking_pot", "empty") > 0.99);
}

#[test]
fn what_has_no_effect_tells_that_something_is_otherwise() {
    let mut bench = Bench::new("sushi", HumanModel::default());
    // Unseen by the human, something lies on the counter.
    let salmon = bench.kitchen.content_named("salmon raw").expect("a content");
    let counter = bench.location("counter");
    bench.press(1.0, Agent::Human, "take nori");
    bench.state.set_content(counter, salmon);
    assert!(bench.p("counter", "empty") > 0.8);
    bench.press(2.0, Agent::Human, "counter");
    let empty = bench.p("counter", "empty");
    assert!(empty < 0.2, "nothing could be put down: {empty}");
    assert!(bench.p("human_hand", "nori") > 0.9, "the hand is known");
}

#[test]
fn a_serve_press_without_effect_speaks_against_plate_order_or_recipe() {
    // Of somebody whose presses tell nothing, so that only what came of them counts.
    let mut model = HumanModel::default();
    (model.decision.lapse, model.decision.lapse_anywhere) = (1.0, 1.0);
    let mut bench = Bench::new("sushi", model);
    bench.order(0.5, "order_1", "salmon nigiri");
    let stack = bench.kitchen.content_named("tuna nigiri").expect("a stack");
    let plate = bench.location("plate");
    bench.state.set_content(plate, stack);
    bench.observe(0.6, ObservedEvidence::Displayed { state: bench.state });
    bench.look(1.0, 3.0, "order_1", 120.0);
    bench.look(4.0, 3.0, "plate", 120.0);
    let held = bench.p("recipe of salmon nigiri", "tuna nigiri");
    bench.press(8.0, Agent::Human, "serve 1");
    let learned = bench.p("recipe of salmon nigiri", "tuna nigiri");
    assert!(learned < held / 2.0, "{held} {learned}");
    bench.state.set_content(plate, bench.kitchen.content_named("salmon nigiri").expect("a stack"));
    bench.observe(8.5, ObservedEvidence::Displayed { state: bench.state });
    bench.look(9.0, 3.0, "plate", 120.0);
    bench.press(13.0, Agent::Human, "serve 1");
    assert!(bench.p("order_1", "served") > 0.99 && bench.p("plate", "empty") > 0.99);
    assert!(bench.p("recipe of salmon nigiri", "salmon nigiri") > 0.9, "it could be served as it was");
    bench.state.set_order(bench.location("order_1"), OrderContent::None);
    bench.observe(15.0, ObservedEvidence::Displayed { state: bench.state });
    assert!(bench.p("order_1", "none") > 0.99, "it is expected to be cleared");
}

#[test]
fn an_unseen_press_of_the_robot_makes_uncertain_what_its_policy_may_change_and_nothing_else() {
    let mut model = HumanModel::default();
    model.transition.foresight = 1.0;
    let mut bench = Bench::new("sushi", model);
    bench.order(0.5, "order_1", "salmon nigiri");
    bench.look(1.0, 6.0, "order_1", 120.0);
    let before = bench.filter.belief().clone();
    bench.press(8.0, Agent::Robot, "take nori");
    let may: f64 = ["nori", "rice raw", "salmon raw"].map(|item| bench.p("robot_hand", item)).iter().sum();
    let empty = bench.p("robot_hand", "empty");
    assert!(may > 0.6 && empty < 0.25, "in its hand is what it may take: {may}, {empty}");
    assert!(bench.p("robot_hand", "salmon maki") < 0.01);
    let counter = bench.aspect("counter");
    let change = (before.aspect(counter).mean()[0] - bench.filter.belief().aspect(counter).mean()[0]).abs();
    assert!(change < 0.05, "the counter hardly: {change}");
}

#[test]
fn recipes_are_forgotten_with_their_half_life_and_pauses_do_not_count() {
    let mut bench = Bench::new("sushi", HumanModel { signal: PAPER_2021.signal, ..HumanModel::default() });
    bench.order(0.5, "order_1", "tuna maki");
    bench.observe(1.0, ObservedEvidence::Told { location: bench.location("order_1") });
    assert!(bench.p("recipe of tuna maki", "tuna maki") > 0.999 && bench.p("order_1", "tuna maki") > 0.999);
    let prior = HumanModel::default().prior.recipe_truth;
    let beyond = |bench: &Bench| (bench.p("recipe of tuna maki", "tuna maki") - prior) / (1.0 - prior);
    bench.observe(1.0, ObservedEvidence::Paused);
    bench.observe(5000.0, ObservedEvidence::Resumed);
    bench.observe(5200.0, ObservedEvidence::Displayed { state: bench.state });
    assert!((beyond(&bench) - 0.5).abs() < 1e-3, "{}", beyond(&bench));
    for step in 0..20 {
        bench.observe(5210.0 + 10.0 * f64::from(step), ObservedEvidence::Displayed { state: bench.state });
    }
    assert!((beyond(&bench) - 0.25).abs() < 1e-3, "in small steps alike: {}", beyond(&bench));
}

#[test]
fn a_signal_makes_certain_what_it_is_about_as_often_as_it_is_noticed() {
    for noticed in [1.0, 0.6] {
        let mut model = looks_at_nothing();
        model.signal.noticed = noticed;
        let mut bench = Bench::new("burger", model);
        let place = bench.kitchen.board;
        bench.state.set_content(place, ContentId(1));
        bench.observe(1.0, ObservedEvidence::Displayed { state: bench.state });
        let aspect = AspectId::of_location(place);
        let before = bench.filter.belief().p_truth(&bench.kitchen, bench.state, aspect);
        bench.observe(2.0, ObservedEvidence::Told { location: place });
        let after = bench.filter.belief().p_truth(&bench.kitchen, bench.state, aspect);
        assert!((after - (noticed + (1.0 - noticed) * before)).abs() < 1e-4, "{noticed}: {before} {after}");
    }
}

#[test]
fn too_few_effective_samples_are_met_with_more() {
    let inference = InferenceSettings { beliefs: 32, states: 8, min_effective: 30.0, max_beliefs: 256, predictions: 8 };
    let mut bench = Bench::new("sushi", HumanModel { inference, ..HumanModel::default() });
    bench.order(0.5, "order_1", "salmon nigiri");
    bench.look(1.0, 6.0, "order_1", 120.0);
    let mut most = 0;
    for (step, button) in ["take crab", "trash", "take shrimp", "trash"].into_iter().enumerate() {
        bench.press(8.0 + step as f64, Agent::Human, button);
        let evidence = bench.filter.evidence().expect("a press");
        assert!(evidence.effective >= 30.0 || evidence.beliefs == 256, "{evidence:?}");
        most = most.max(evidence.beliefs);
    }
    assert!(most > 32, "presses that few beliefs explain took more of them");
}
