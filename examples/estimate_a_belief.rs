//! Estimates what a person at the sushi kitchen believes, observation by observation: gaze and presses.
//!
//! `cargo run --example estimate_a_belief --no-default-features`

use std::error::Error;
use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, OrderContent};
use tomcom_core::mind::filter::BeliefFilter;
use tomcom_core::mind::model::HumanModel;
use tomcom_core::mind::observation::{Observation, ObservedEvidence};

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (layout, recipes) =
        (std::fs::read_to_string("layouts/sushi.toml")?, std::fs::read_to_string("recipes/sushi.toml")?);
    let kitchen = Arc::new(Kitchen::from_toml(&layout, &recipes)?);
    let mut cost = CostToGo::new(kitchen.clone());
    let mut filter = BeliefFilter::new(kitchen.clone(), HumanModel::default(), 1);
    let order = kitchen.location_named("order_1").ok_or("an order")?;
    let dish = kitchen.dish_named("salmon nigiri").ok_or("a dish")?;
    let aspect = AspectId::of_location(order);
    let take_shrimp = kitchen.button_named(Agent::Human, "take shrimp").ok_or("a button")?;

    // The trial starts, and the display shows an order that the person has not read yet.
    let mut state = kitchen.empty_state();
    filter.observe(&Observation { time: SessionTime::ZERO, what: ObservedEvidence::Started { state } }, &mut cost);
    state.set_order(order, OrderContent::Dish(dish));
    let shown = Observation { time: SessionTime::from_secs_f64(1.0), what: ObservedEvidence::Displayed { state } };
    filter.observe(&shown, &mut cost);
    print_belief("an order appears", &kitchen, &filter, aspect);

    // The person takes a shrimp, which the order does not need: the order was not read, or misread.
    let press = kitchen.try_press(state, Agent::Human, take_shrimp);
    let pressed = ObservedEvidence::Pressed(press);
    filter.observe(&Observation { time: SessionTime::from_secs_f64(3.0), what: pressed }, &mut cost);
    print_belief("the person takes a shrimp", &kitchen, &filter, aspect);
    let misread = filter.belief().p_truth(&kitchen, state, aspect);

    // The person looks at the order for half a second: 60 gaze samples a second.
    let [x, y] = kitchen.location(order).display.centre();
    for sample in 0..30 {
        let time = SessionTime::from_secs_f64(4.0 + f64::from(sample) / 60.0);
        let looks = ObservedEvidence::Gaze { sample: GazeSample::new(x, y, 1.0), taken: time };
        filter.observe(&Observation { time, what: looks }, &mut cost);
    }
    print_belief("the person looks at the order", &kitchen, &filter, aspect);
    assert!(filter.belief().p_truth(&kitchen, press.after, aspect) > misread);
    Ok(())
}

/// Prints the distribution over one state aspect.
fn print_belief(what: &str, kitchen: &Kitchen, filter: &BeliefFilter, aspect: AspectId) {
    println!("{what}:");
    let labels = &kitchen.aspects[aspect.index()].labels;
    for (label, probability) in labels.iter().zip(filter.belief().aspects[aspect.index()].mean()) {
        if *probability > 0.05 {
            println!("  {label:<16} {probability:.2}");
        }
    }
}
