//! The model of tomcom: what a human who cooks with a robot believes, and which signal is worth sending.
//!
//! The crate reads no files, asks no clock and opens no connection: texts, times and random seeds come from its caller.
//!
//! - A **kitchen** ([`kitchen::Kitchen`]) is computed from a layout and a recipe file: contents, locations, buttons,
//!   rules. A [`kitchen::State`] is 16 bytes. The **cost to go** ([`kitchen::cost_to_go::CostToGo`]) of a state is the
//!   least number of presses until all orders are served.
//! - A **belief** ([`mind::dirichlet::DirichletBelief`]) is a distribution over each aspect of the state: what lies
//!   where, which recipe a dish has. The **filter** ([`mind::filter::BeliefFilter`]) estimates it from gaze, presses,
//!   orders and signals, under a human model with named parameters ([`mind::model::HumanModel`]): people prefer presses
//!   that reduce the cost to go in the world that they believe in (softmax).
//! - A **communication concept** ([`communication::concept`]) decides from state and belief which signal to send, if
//!   any. The **planner** ([`communication::planner::Planner`]) compares paired rollouts with and without each signal:
//!   a signal is worth sending if it saves more presses than it costs.
//! - The **robot** ([`robot::policy`]) takes the press that lowers the cost to go the most, and the initiative if the human
//!   is passive.
//! - **Measures** ([`measures`]) judge presses (errors, their causes) and estimates (detection of false beliefs).
//!
//! Imports go one way, from right to left: [`base`], [`kitchen`], [`robot`] and [`gaze`], [`mind`], [`measures`],
//! [`communication`].
//!
//! # Example
//!
//! A person takes the wrong ingredient. What do they believe, and which signal should be sent? The folder
//! `examples` of the repository has more.
//!
//! ```
//! use std::sync::Arc;
//! use tomcom_core::base::time::SessionTime;
//! use tomcom_core::communication::concept::{Concept, DecisionPoint, Situation};
//! use tomcom_core::communication::settings::AssistantSpec;
//! use tomcom_core::communication::{HighlightSet, available, planner::Planner};
//! use tomcom_core::kitchen::{Agent, AspectId, Kitchen, OrderContent, cost_to_go::CostToGo};
//! use tomcom_core::mind::observation::{Observation, ObservedEvidence};
//! use tomcom_core::mind::{filter::BeliefFilter, model::HumanModel};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let top = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
//! let read = |name| std::fs::read_to_string(format!("{top}/{name}"));
//! let kitchen = Arc::new(Kitchen::from_toml(&read("layouts/sushi.toml")?, &read("recipes/sushi.toml")?)?);
//! let (human, mut cost) = (HumanModel::default(), CostToGo::new(kitchen.clone()));
//!
//! // The display shows an order, and the person takes a shrimp.
//! let order = kitchen.location_named("order_1").ok_or("no such location")?;
//! let dish = kitchen.dish_named("salmon nigiri").ok_or("no such dish")?;
//! let button = kitchen.button_named(Agent::Human, "take shrimp").ok_or("no such button")?;
//! let mut before = kitchen.empty_state();
//! before.set_order(order, OrderContent::Dish(dish));
//! let press = kitchen.try_press(before, Agent::Human, button);
//! let events = [
//!     (0.0, ObservedEvidence::Started { state: kitchen.empty_state() }),
//!     (1.0, ObservedEvidence::Displayed { state: before }),
//!     (3.0, ObservedEvidence::Pressed(press)),
//! ];
//!
//! // What the person believes now.
//! let mut filter = BeliefFilter::new(kitchen.clone(), human.clone(), 1);
//! for (seconds, what) in events {
//!     filter.observe(&Observation { time: SessionTime::from_secs_f64(seconds), what }, &mut cost);
//! }
//! let state = press.result().ok_or("an ineffective press")?;
//! let p_truth = filter.belief().p_truth(&kitchen, state, AspectId::of_location(order));
//! assert!(p_truth < 0.5, "the person does not know the order: {p_truth}");
//!
//! // Which signal is worth more than it costs.
//! let mut planner = Planner::new(kitchen.clone(), &human, AssistantSpec::default(), 1);
//! let (signals, situation) = (available(&kitchen, state, HighlightSet::usual(&kitchen)), Situation::new(state, filter.belief()));
//! let moment = DecisionPoint { seq: 3, time: SessionTime::ZERO, presses: 1, situation, signals: &signals, error: None };
//! let advice = planner.advise(&mut cost, &moment);
//! println!("{:?}: it saves {:?} presses", advice.best, advice.top().map(|option| option.benefit));
//! # assert!(!advice.options.is_empty());
//! # Ok(())
//! # }
//! ```

#![warn(missing_docs)]
#![deny(unsafe_code)]

pub mod base;
pub mod communication;
pub mod gaze;
pub mod kitchen;
pub mod measures;
pub mod mind;
pub mod robot;
