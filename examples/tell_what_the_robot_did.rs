//! The robot cooks rice and puts it onto the assembly board while the human looks at the order. Which signal is worth its cost?

use std::error::Error;
use std::fs::read_to_string;
use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::{Concept, DecisionPoint};
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::Situation;
use tomcom_core::communication::planner::Planner;
use tomcom_core::communication::{HighlightSet, available};
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::{Agent, AspectId, Kitchen, OrderContent, cost_to_go::CostToGo};
use tomcom_core::mind::observation::{Observation, ObservedEvidence};
use tomcom_core::mind::{filter::BeliefFilter, model::HumanModel};

/// What the robot does, one press a second.
const ROBOT: [&str; 5] = ["take rice", "cooking_pot", "cook", "cooking_pot", "assembly_board"];
/// Gaze samples per second.
const GAZE_HZ: usize = 60;

pub fn main() -> Result<(), Box<dyn Error>> {
    let kitchen = Kitchen::from_toml(&read_to_string("layouts/sushi.toml")?, &read_to_string("recipes/sushi.toml")?)?;
    let kitchen = Arc::new(kitchen);
    let (mut human, mut cost) = (HumanModel::default(), CostToGo::new(kitchen.clone()));
    // The human looks at what the next press needs, and at nothing else: what is seen anyway needs no signal.
    (human.looking.other_looks_hz, human.looking.capture) = (0.0, 0.0);
    let mut filter = BeliefFilter::new(kitchen.clone(), human.clone(), 1);
    let mut observe = |seconds: f64, what: ObservedEvidence, cost: &mut CostToGo| {
        filter.observe(&Observation { time: SessionTime::from_secs_f64(seconds), what }, cost);
    };

    // The human knows the order and its recipe, and keeps looking at the order.
    let order = kitchen.location_named("order_1").ok_or("no order")?;
    let dish = kitchen.dish_named("salmon nigiri").ok_or("no dish")?;
    let mut state = kitchen.empty_state();
    observe(0.0, ObservedEvidence::Started { state }, &mut cost);
    state.set_order(order, OrderContent::Dish(dish));
    observe(1.0, ObservedEvidence::Displayed { state }, &mut cost);
    observe(2.0, ObservedEvidence::Told { location: order }, &mut cost);
    let [x, y] = kitchen.location(order).display.centre();
    let mut seconds = 2.0;
    for name in ROBOT {
        for _ in 0..GAZE_HZ {
            seconds += 1.0 / GAZE_HZ as f64;
            let taken = SessionTime::from_secs_f64(seconds);
            observe(seconds, ObservedEvidence::Gaze { sample: GazeSample::new(x, y, 1.0), taken }, &mut cost);
        }
        let button = kitchen.button_named(Agent::Robot, name).ok_or("no such button")?;
        let press = kitchen.try_press(state, Agent::Robot, button);
        state = press.result().ok_or("a press without effect")?;
        observe(seconds, ObservedEvidence::Pressed(press), &mut cost);
    }

    let board = kitchen.location_named("assembly_board").ok_or("no board")?;
    let p_truth = filter.belief().p_truth(&kitchen, state, AspectId::of_location(board));
    println!("the board holds {}; P(truth) is {p_truth:.2}", kitchen.content_label(state, board));

    let mut planner = Planner::new(kitchen.clone(), &human, AssistantSpec::default(), 1);
    let (signals, situation) =
        (available(&kitchen, state, HighlightSet::usual(&kitchen)), Situation::new(state, filter.belief()));
    let (time, presses) = (SessionTime::from_secs_f64(seconds), ROBOT.len() as u32);
    let moment = DecisionPoint { seq: 0, time, presses, situation, signals: &signals, error: None };
    let advice = planner.advise(&mut cost, &moment);
    for option in advice.options.iter().take(3) {
        println!(
            "{:?}: net benefit {:+.2} presses, standard error {:.2}",
            option.signal, option.net, option.standard_error
        );
    }
    let signal = advice.best.as_ref().ok_or("no signal is worth its cost")?;
    assert_eq!(signal.target(), Some("assembly_board"), "the change on the board that the human has not seen");
    println!("send {signal:?}");
    Ok(())
}
