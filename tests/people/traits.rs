//! Traits that nobody has in the calibrated population, and drop-outs of gaze.

use tomcom_core::base::rng::stream;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{Agent, ButtonAction, ButtonId, Kitchen};
use tomcom_people::participant::eyes::GazeDropoutSchedule;
use tomcom_people::participant::population::Population;

use super::behaviour::{Bench, exactly, ignorant, unmoved};

#[test]
fn a_trait_changes_no_other_trait_of_a_person() {
    // Traits are drawn one after the other from one stream: a new one does not change those before it.
    let plain = Bench::new(&Population::default(), 5);
    let stubborn = Bench::new(&Population { keeps_own_recipe: exactly(0.5), ..Population::default() }, 5);
    let (before, mut after) = (plain.one.person().clone(), stubborn.one.person().clone());
    assert_eq!((before.keeps_own_recipe, after.keeps_own_recipe), (0.0, 0.5));
    after.keeps_own_recipe = 0.0;
    assert_eq!(before, after);
}

/// People who see everything rightly, recall no recipe anew and, after each press of theirs, do not know how to go on.
fn stuck() -> Population {
    let never = exactly(0.000_001);
    Population {
        gets_stuck: exactly(0.999_999),
        misreads: never,
        loses_thread_per_min: exactly(0.0001),
        takes_hints: never,
        ..Population::default()
    }
}

/// Number of presses of 20 such people in half a minute after half a minute, in which `what` happens.
fn presses_after(population: &Population, what: impl Fn(&mut Bench)) -> usize {
    let of_one = |seed: u64| {
        let mut bench = Bench::new(population, seed);
        bench.order("order_1", "salmon maki");
        bench.pass(30.0);
        let before = bench.presses.len();
        what(&mut bench);
        bench.pass(30.0);
        bench.presses.len() - before
    };
    (0..20).map(of_one).sum()
}

#[test]
fn who_does_not_know_how_to_go_on_waits_until_something_changes_or_a_signal_is_read() {
    let usual = presses_after(&Population { gets_stuck: exactly(0.0), ..stuck() }, |_| ());
    let alone = presses_after(&stuck(), |_| ());
    let told = presses_after(&stuck(), |bench| bench.highlight("counter"));
    let changed = presses_after(&stuck(), |bench| bench.put("counter", "crab raw"));
    assert!(usual > 50 && alone < usual / 8, "{usual}, {alone}");
    assert!(told >= alone + 10, "four of five read the signal: {told}, {alone}");
    assert!(changed >= alone + 15, "they look around and see the change: {changed}, {alone}");
}

/// In how many of 100 cases the recipe is known after it was shown to somebody who did not know it.
fn told(keeps_own_recipe: f64) -> usize {
    let population = Population { keeps_own_recipe: exactly(keeps_own_recipe), ..ignorant() };
    let knows = |seed: u64| {
        let mut bench = Bench::new(&population, seed);
        bench.order("order_1", "tuna nigiri");
        bench.knows_when_shown()
    };
    (0..100).filter(|&seed| knows(seed)).count()
}

#[test]
fn stubborn_people_keep_their_own_recipe_against_a_signal() {
    let (open, half, stubborn) = (told(0.0), told(0.5), told(0.999_999));
    assert!(
        open >= 65 && (25..=55).contains(&half),
        "{open} of 100 believe the signal, {half} where half keep their own"
    );
    // One or two recall the right recipe by themselves.
    assert!(stubborn <= 4, "{stubborn} of 100");
}

#[test]
fn misremembered_recipes_are_sure_and_wrong_until_they_are_shown() {
    let population = Population { misremembers: exactly(0.999_999), notices_signal: exactly(0.999), ..unmoved() };
    let mut bench = Bench::new(&population, 3);
    let dishes: Vec<String> = bench.kitchen.dishes.iter().map(|dish| dish.name.clone()).collect();
    for dish in &dishes {
        assert!(bench.p_truth(&format!("recipe of {dish}")) < 0.05, "{dish} is known");
    }
    bench.pass(600.0);
    assert!(bench.p_truth("recipe of tuna nigiri") < 0.05, "time alone corrects nothing");
    bench.order("order_1", "tuna nigiri");
    // One of these is noticed.
    for _ in 0..8 {
        bench.show_recipe();
        bench.pass(2.0);
    }
    assert!(bench.p_truth("recipe of tuna nigiri") > 0.9, "a signal corrects it");
    assert!(bench.p_truth("recipe of salmon nigiri") < 0.05, "and no other recipe");
}

/// A button of the robot that takes something from a storage.
fn takes(kitchen: &Kitchen) -> ButtonId {
    let buttons = &kitchen.buttons[Agent::Robot.index()];
    let index = buttons.iter().position(|button| matches!(button.action, ButtonAction::Take(_)));
    ButtonId(index.expect("the robot takes something") as u8)
}

#[test]
fn who_guesses_the_robot_knows_what_it_did_unseen() {
    let after_unseen_press = |guesses_robot: f64| {
        let mut bench = Bench::new(&Population { guesses_robot: exactly(guesses_robot), ..unmoved() }, 7);
        let press = bench.kitchen.try_press(bench.state, Agent::Robot, takes(&bench.kitchen));
        assert!(press.effective);
        bench.state = press.after;
        bench.one.on_press(bench.now, &press);
        bench.p_truth("robot_hand")
    };
    assert!(after_unseen_press(0.0) < 0.3, "known without a look");
    assert!(after_unseen_press(0.999_999) > 0.8, "not guessed");
}

#[test]
fn drop_outs_follow_their_seed() {
    let schedule = |seed| {
        let mut gaps = GazeDropoutSchedule::new(10.0, [1.0, 8.0], stream(seed, "drop-outs", 0));
        (0..60_000)
            .map(|step| gaps.swallows(SessionTime::from_secs_f64(f64::from(step) / 100.0)))
            .collect::<Vec<bool>>()
    };
    let lost = schedule(4);
    assert_eq!(lost, schedule(4));
    assert_ne!(lost, schedule(5));
    let runs: Vec<usize> = lost.chunk_by(|a, b| a == b).filter(|run| run[0]).map(<[bool]>::len).collect();
    assert!(runs.len() > 20, "{}", runs.len());
    // The last one may be cut by the end.
    assert!(runs[..runs.len() - 1].iter().all(|run| (99..=801).contains(run)), "{runs:?}");
}
