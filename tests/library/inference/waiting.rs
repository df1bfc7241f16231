//! Waiting as evidence: who believes that nothing is useful now waits, who presses believes that something is.

use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, AspectId, DishId, Kitchen, OrderContent};
use tomcom::mind::filter::BeliefFilter;
use tomcom::mind::model::HumanModel;
use tomcom::mind::observation::{Observation, ObservedEvidence};

use super::world::kitchen;

/// A filter after an order appeared that may have been seen, and the expected probability that the human believes in no order.
struct AfterAnOrder {
    kitchen: Arc<Kitchen>,
    cost: CostToGo,
    filter: BeliefFilter,
}

impl AfterAnOrder {
    fn new(waiting: bool) -> AfterAnOrder {
        let kitchen = kitchen("layouts/sushi.toml");
        let mut model = HumanModel::default();
        model.inference.waiting = waiting;
        let (filter, cost) = (BeliefFilter::new(kitchen.clone(), model, 1), CostToGo::new(kitchen.clone()));
        let mut one = AfterAnOrder { kitchen, cost, filter };
        let mut state = one.kitchen.empty_state();
        one.observe(0.0, ObservedEvidence::Started { state });
        state.set_order(one.kitchen.orders[0], OrderContent::Dish(DishId(0)));
        one.observe(0.5, ObservedEvidence::Displayed { state });
        one
    }

    fn observe(&mut self, seconds: f64, what: ObservedEvidence) {
        let time = SessionTime::from_secs_f64(seconds);
        self.filter.observe(&Observation { time, what }, &mut self.cost);
    }

    /// Expected probability that the human believes in no order.
    fn p_none(&self) -> f64 {
        let order = AspectId::of_location(self.kitchen.orders[0]);
        let value = self.kitchen.aspects[order.index()].index_of(OrderContent::None.code()).expect("a value");
        self.filter.belief().aspect(order).mean()[value]
    }

    /// A press of the human that has no effect.
    fn press(&mut self, seconds: f64, name: &str) {
        let button = self.kitchen.button_named(Agent::Human, name).expect("a button");
        let mut state = self.kitchen.empty_state();
        state.set_order(self.kitchen.orders[0], OrderContent::Dish(DishId(0)));
        let press = self.kitchen.try_press(state, Agent::Human, button);
        self.observe(seconds, ObservedEvidence::Pressed(press));
    }
}

#[test]
fn who_waits_is_thought_to_believe_that_nothing_is_useful() {
    // The less can be explained by thinking for long, the more is told.
    let mut last = None;
    for longer in [1.0, 0.2, 0.0] {
        let mut one = AfterAnOrder::new(true);
        one.observe(1.5, ObservedEvidence::Waited { longer });
        let p_none = one.p_none();
        println!("share of longer intervals {longer}: P(no order) {p_none:.3}");
        if let Some(last) = last {
            assert!(p_none > last + 0.01, "{longer}: {p_none} after {last}");
        }
        last = Some(p_none);
    }
}

#[test]
fn who_presses_is_thought_to_believe_that_something_is_useful() {
    let pressed = |waiting: bool| {
        let mut one = AfterAnOrder::new(waiting);
        one.press(1.5, "trash");
        one.p_none()
    };
    let [with, without] = [true, false].map(pressed);
    println!("P(no order) after a press: {with:.3} where waiting is evidence, else {without:.3}");
    assert!(with < without - 0.005, "{with}, {without}");
}
