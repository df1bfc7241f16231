//! Asks the communication planner which signal is worth sending in one situation, and why.
//!
//! `cargo run --example ask_the_planner --no-default-features`

use std::error::Error;
use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::{Concept, DecisionPoint};
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::Situation;
use tomcom_core::communication::{HighlightSet, available};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{AspectId, Kitchen, OrderContent};
use tomcom_core::mind::dirichlet::{Dirichlet, DirichletBelief};
use tomcom_core::mind::model::HumanModel;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (layout, recipes) =
        (std::fs::read_to_string("layouts/sushi.toml")?, std::fs::read_to_string("recipes/sushi.toml")?);
    let kitchen = Arc::new(Kitchen::from_toml(&layout, &recipes)?);
    // A person who looks at what the next press needs, and at nothing else: what is seen anyway needs no signal.
    let mut human = HumanModel::default();
    (human.looking.other_looks_hz, human.looking.capture) = (0.0, 0.0);
    let order = kitchen.location_named("order_1").ok_or("an order")?;
    let mut state = kitchen.empty_state();
    state.set_order(order, OrderContent::Dish(kitchen.dish_named("salmon nigiri").ok_or("a dish")?));

    // The person knows the kitchen, but is sure that the order is another dish.
    let mut belief = DirichletBelief::prior(&kitchen, &human.prior, state);
    let aspect = AspectId::of_location(order).index();
    let is_shrimp = |label: &String| f64::from(u8::from(label == "shrimp nigiri"));
    belief.aspects[aspect] = Dirichlet::new(kitchen.aspects[aspect].labels.iter().map(is_shrimp).collect(), 100.0);

    let signals = available(&kitchen, state, HighlightSet::usual(&kitchen));
    let mut spec = AssistantSpec::default();
    // Few, so that an unoptimised build answers at once; a session takes more.
    (spec.rollout.rollouts, spec.rollout.least_rollouts) = (32, 32);
    let mut planner = Planner::new(kitchen.clone(), &human, spec, 1);
    let situation = Situation::new(state, &belief);
    let moment =
        DecisionPoint { seq: 0, time: SessionTime::ZERO, presses: 0, situation, signals: &signals, error: None };
    let advice = planner.advise(&mut CostToGo::new(kitchen.clone()), &moment);

    println!("{:<28} {:>8} {:>8}", "signal", "benefit", "net");
    for option in advice.options.iter().take(5) {
        println!("{:<28} {:>8.2} {:>8.2}", format!("{:?}", option.signal), option.benefit, option.net);
    }
    if let Some(reason) = &advice.reason {
        println!(
            "{}: believed {:.0} % {}, is {}",
            reason.aspect,
            100.0 * reason.p_believes,
            reason.believes,
            reason.truth
        );
    }
    let best = advice.best.ok_or("a signal that is worth its cost")?;
    assert_eq!(best.location(&kitchen), Some(order));
    println!("send {best:?}");
    Ok(())
}
