//! Signals that take time to be read: what gaze, unknown gaze and presses say about whether one was read.

use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, DishId, Kitchen, LocationKind, OrderContent, State};
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::mind::model::SignalModel;

use super::looks_at_nothing;
use crate::files::kitchen;

/// A human who reads signals in time, and looks at nothing else while the gaze is unknown.
fn reads_in_time() -> HumanModel {
    let signal = SignalModel { noticed: 0.8, delay_s: 1.0, ..SignalModel::default() };
    HumanModel { signal, ..looks_at_nothing() }
}

/// A filter of a trial in which the first order wants shrimp nigiri, whose recipe is not known for certain.
struct SignalBench {
    kitchen: Arc<Kitchen>,
    filter: BeliefFilter,
    cost: CostToGo,
    state: State,
    recipe: AspectId,
}

impl SignalBench {
    fn new(model: HumanModel) -> SignalBench {
        let kitchen = kitchen("sushi");
        let dish = kitchen.dishes.iter().position(|dish| dish.name == "shrimp nigiri").expect("a dish");
        let dish = DishId(dish as u8);
        let mut state = kitchen.empty_state();
        state.set_order(kitchen.orders[0], OrderContent::Dish(dish));
        let filter = BeliefFilter::new(kitchen.clone(), model, 9803);
        let (cost, recipe) = (CostToGo::new(kitchen.clone()), kitchen.aspect_of_dish(dish));
        let mut bench = SignalBench { kitchen, filter, cost, state, recipe };
        bench.observe(0.0, ObservedEvidence::Started { state });
        bench
    }

    fn observe(&mut self, seconds: f64, what: ObservedEvidence) {
        let observation = Observation { time: SessionTime::from_secs_f64(seconds), what };
        self.filter.observe(&observation, &mut self.cost);
    }

    fn tell(&mut self, seconds: f64) {
        self.observe(seconds, ObservedEvidence::Told { location: self.kitchen.orders[0] });
    }

    /// Gaze at the middle of a location between two times, in seconds, with 50 samples a second.
    fn gaze(&mut self, from: f64, until: f64, at: &str) {
        let location = self.kitchen.location_named(at).expect("a location");
        let [x, y] = self.kitchen.location(location).display.centre();
        for step in 0..((until - from) * 50.0).round() as u32 {
            let seconds = from + f64::from(step) / 50.0;
            let taken = SessionTime::from_secs_f64(seconds);
            let sample = GazeSample { x, y, confidence: 1.0, device_ns: None, taken_ns: None };
            self.observe(seconds, ObservedEvidence::Gaze { sample, taken });
        }
    }

    /// P(truth) of the recipe beyond what it was at the start, as a share of what was missing.
    fn learned(&self) -> f64 {
        let before = HumanModel::default().prior.recipe_truth;
        (self.filter.belief().p_truth(&self.kitchen, self.state, self.recipe) - before) / (1.0 - before)
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
    let mut bench = SignalBench::new(reads_in_time());
    bench.gaze(0.0, 1.0, "cooking_pot");
    bench.tell(1.0);
    assert!(bench.learned().abs() < FORGOTTEN, "nothing is read at once: {}", bench.learned());
    bench.gaze(1.0, 2.0, "cooking_pot");
    bench.gaze(2.0, 3.0, "order_1");
    let expected = 1.0 - (-3.0_f64).exp();
    assert!((bench.learned() - expected).abs() < FORGOTTEN, "{} after a second, {expected}", bench.learned());
    bench.gaze(3.0, 5.0, "cooking_pot");
    let read = bench.read(5.0);
    assert!((read - expected).abs() < 0.01, "{read}");
    assert_eq!(bench.filter.forecast().probability(LocationKind::Order), 0.8);
}

#[test]
fn gaze_that_is_elsewhere_for_all_of_its_time_has_missed_it() {
    let mut bench = SignalBench::new(reads_in_time());
    bench.gaze(0.0, 1.0, "cooking_pot");
    bench.tell(1.0);
    bench.gaze(1.0, 5.0, "cooking_pot");
    assert!(bench.learned().abs() < FORGOTTEN, "{}", bench.learned());
    let read = bench.read(5.0);
    assert!(read < 0.01, "{read}");
}

#[test]
fn unknown_gaze_reads_it_with_the_probability_that_it_is_noticed_however_a_gap_is_divided() {
    let learned = |asked: &[f64]| {
        let mut bench = SignalBench::new(reads_in_time());
        bench.tell(1.0);
        for &seconds in asked {
            let now = SessionTime::from_secs_f64(seconds);
            bench.filter.advance(now, &mut bench.cost);
        }
        let read = bench.read(9.0);
        (bench.learned(), read)
    };
    let (whole, read) = learned(&[]);
    assert!((read - 0.8).abs() < 0.001 && (whole - 0.8).abs() < FORGOTTEN, "{whole} {read}");
    let (parts, read_in_parts) = learned(&[1.2, 1.9, 2.0, 4.4, 8.0]);
    assert!((whole - parts).abs() < 1e-6 && (read - read_in_parts).abs() < 1e-9, "{parts} {read_in_parts}");
    // After the mean delay, 1 - exp(-1) of its hazard has passed.
    let mut bench = SignalBench::new(reads_in_time());
    bench.tell(1.0);
    let expected = 1.0 - 0.2_f64.powf(1.0 - (-1.0_f64).exp());
    let read = bench.read(2.0);
    assert!((read - expected).abs() < 1e-6, "{read} instead of {expected}");
}

#[test]
fn a_press_by_the_look_alike_recipe_is_evidence_that_it_was_missed() {
    let read_after = |button: &str| {
        let mut bench = SignalBench::new(reads_in_time());
        bench.tell(1.0);
        let pressed = bench.kitchen.button_named(Agent::Human, button).expect("a button");
        let press = bench.kitchen.try_press(bench.state, Agent::Human, pressed);
        bench.observe(2.5, ObservedEvidence::Pressed(press));
        (bench.read(2.5), bench.filter.belief().p_truth(&bench.kitchen, bench.state, bench.recipe))
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
    let mut bench = SignalBench::new(reads_in_time());
    bench.gaze(0.0, 1.0, "cooking_pot");
    bench.tell(1.0);
    let p = |bench: &mut SignalBench, seconds: f64| {
        let now = SessionTime::from_secs_f64(seconds);
        let foreseen = bench.filter.foreseen(now, true, &mut bench.cost);
        foreseen.p_truth(&bench.kitchen, bench.state, bench.recipe)
    };
    let before = HumanModel::default().prior.recipe_truth;
    let at_once = p(&mut bench, 1.0);
    assert!((at_once - (1.0 - (1.0 - before) * 0.2)).abs() < 0.01, "{at_once}");
    bench.gaze(1.0, 4.0, "cooking_pot");
    let later = p(&mut bench, 4.0);
    assert!(later < at_once - 0.05 && later > before, "who has not looked so far looks hardly any more: {later}");
}

#[test]
fn without_a_delay_a_signal_is_believed_at_once_and_never_counted() {
    let mut bench = SignalBench::new(looks_at_nothing());
    bench.tell(1.0);
    assert!(bench.learned() > 0.999, "{}", bench.learned());
    bench.observe(5.0, ObservedEvidence::EndedSignal);
    assert_eq!(bench.filter.take_signal_over(), None);
    assert_eq!(bench.filter.forecast().probability(LocationKind::Order), 1.0);
}
