//! Signals that take time to be read: what gaze, unknown gaze and presses say about whether one was read.

use tomcom_core::kitchen::{Agent, LocationKind, OrderContent};
use tomcom_core::mind::model::{HumanModel, SignalModel};
use tomcom_core::mind::observation::ObservedEvidence;

use super::{Bench, at, looks_at_nothing};
use crate::files::kitchen;

/// A human who reads signals in time, and looks at nothing else while the gaze is unknown.
fn reads_in_time() -> HumanModel {
    let signal = SignalModel { noticed: 0.8, delay_s: 1.0, ..SignalModel::default() };
    HumanModel { signal, ..looks_at_nothing() }
}

/// A trial in which the first order wants shrimp nigiri, whose recipe is not known for certain.
fn trial(model: HumanModel) -> Bench {
    let kitchen = kitchen("sushi");
    let mut state = kitchen.empty_state();
    state.set_order(kitchen.orders[0], OrderContent::Dish(kitchen.dish_named("shrimp nigiri").expect("a dish")));
    Bench::started(kitchen, state, model, 9803)
}

impl Bench {
    fn tell(&mut self, seconds: f64) {
        self.observe(seconds, ObservedEvidence::Told { location: self.kitchen.orders[0] });
    }

    /// The expected probability of the recipe's truth.
    fn p_recipe(&self) -> f64 {
        self.p("recipe of shrimp nigiri", "shrimp nigiri")
    }

    /// P(truth) of the recipe beyond what it was at the start, as a share of what was missing.
    fn learned(&self) -> f64 {
        let before = HumanModel::default().prior.recipe_truth;
        (self.p_recipe() - before) / (1.0 - before)
    }

    /// Ends the signal; the probability that it was read.
    fn read(&mut self, seconds: f64) -> f64 {
        self.observe(seconds, ObservedEvidence::EndedSignal);
        let over = self.filter.take_signal_over().expect("a signal that is over");
        assert_eq!(over.location, self.kitchen.orders[0]);
        over.read
    }
}

/// Forgetting takes a little from all that was learned.
const FORGOTTEN: f64 = 0.03;

#[test]
fn a_known_look_at_the_signal_reads_it() {
    let mut bench = trial(reads_in_time());
    bench.look(0.0, 1.0, "cooking_pot", 50.0);
    bench.tell(1.0);
    assert!(bench.learned().abs() < FORGOTTEN, "nothing is read at once: {}", bench.learned());
    bench.look(1.0, 1.0, "cooking_pot", 50.0);
    bench.look(2.0, 1.0, "order_1", 50.0);
    let expected = 1.0 - (-3.0_f64).exp();
    assert!((bench.learned() - expected).abs() < FORGOTTEN, "{} after a second, {expected}", bench.learned());
    bench.look(3.0, 2.0, "cooking_pot", 50.0);
    let read = bench.read(5.0);
    assert!((read - expected).abs() < 0.01, "{read}");
    assert_eq!(bench.filter.forecast().probability(LocationKind::Order), 0.8);
}

#[test]
fn gaze_that_is_elsewhere_for_all_of_its_time_has_missed_it() {
    let mut bench = trial(reads_in_time());
    bench.look(0.0, 1.0, "cooking_pot", 50.0);
    bench.tell(1.0);
    bench.look(1.0, 4.0, "cooking_pot", 50.0);
    assert!(bench.learned().abs() < FORGOTTEN, "{}", bench.learned());
    let read = bench.read(5.0);
    assert!(read < 0.01, "{read}");
}

#[test]
fn unknown_gaze_reads_it_with_the_probability_that_it_is_noticed_however_a_gap_is_divided() {
    let learned = |asked: &[f64]| {
        let mut bench = trial(reads_in_time());
        bench.tell(1.0);
        for &seconds in asked {
            bench.filter.advance(at(seconds), &mut bench.cost);
        }
        let read = bench.read(9.0);
        (bench.learned(), read)
    };
    let (whole, read) = learned(&[]);
    assert!((read - 0.8).abs() < 0.001 && (whole - 0.8).abs() < FORGOTTEN, "{whole} {read}");
    let (parts, read_in_parts) = learned(&[1.2, 1.9, 2.0, 4.4, 8.0]);
    assert!((whole - parts).abs() < 1e-6 && (read - read_in_parts).abs() < 1e-9, "{parts} {read_in_parts}");
    // After the mean delay, 1 - exp(-1) of its hazard has passed.
    let mut bench = trial(reads_in_time());
    bench.tell(1.0);
    let expected = 1.0 - 0.2_f64.powf(1.0 - (-1.0_f64).exp());
    let read = bench.read(2.0);
    assert!((read - expected).abs() < 1e-6, "{read} instead of {expected}");
}

#[test]
fn a_press_by_the_look_alike_recipe_is_evidence_that_it_was_missed() {
    let read_after = |button: &str| {
        let mut bench = trial(reads_in_time());
        bench.tell(1.0);
        bench.press(2.5, Agent::Human, button);
        (bench.read(2.5), bench.p_recipe())
    };
    let (right, knows) = read_after("take shrimp");
    let (wrong, errs) = read_after("take crab");
    println!(
        "read with {right:.3} before the right press (P(truth) {knows:.3}), {wrong:.3} before the wrong one ({errs:.3})"
    );
    // Before the press, 1 - 0.2^(1 - exp(-1.5)) = 0.71.
    assert!(wrong < 0.5 && right > 0.75 && errs < 0.7 && knows > 0.95);
}

#[test]
fn advice_counts_on_the_signal_that_stands_on_the_display() {
    let mut bench = trial(reads_in_time());
    bench.look(0.0, 1.0, "cooking_pot", 50.0);
    bench.tell(1.0);
    let recipe = bench.aspect("recipe of shrimp nigiri");
    let p = |bench: &mut Bench, seconds: f64| {
        let foreseen = bench.filter.foreseen(at(seconds), true, &mut bench.cost);
        foreseen.p_truth(&bench.kitchen, bench.state, recipe)
    };
    let before = HumanModel::default().prior.recipe_truth;
    let at_once = p(&mut bench, 1.0);
    assert!((at_once - (1.0 - (1.0 - before) * 0.2)).abs() < 0.01, "{at_once}");
    bench.look(1.0, 3.0, "cooking_pot", 50.0);
    let later = p(&mut bench, 4.0);
    assert!(later < at_once - 0.05 && later > before, "who has not looked so far looks hardly any more: {later}");
}

#[test]
fn without_a_delay_a_signal_is_believed_at_once_and_never_counted() {
    let mut bench = trial(looks_at_nothing());
    bench.tell(1.0);
    assert!(bench.learned() > 0.999, "{}", bench.learned());
    bench.observe(5.0, ObservedEvidence::EndedSignal);
    assert_eq!(bench.filter.take_signal_over(), None);
    assert_eq!(bench.filter.forecast().probability(LocationKind::Order), 1.0);
}
