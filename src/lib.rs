//! tomcom: Wizard-of-Oz experiments in human-robot cooperation, with a model of what the human believes.
//!
//! A human and a robot cook together in a virtual kitchen: each press of a button moves, processes or serves something.
//! The human may hold *false beliefs*, having missed what the robot did, or misremembering a recipe. A wizard, or an
//! assistant, sends *signals* that show the human a recipe or a location. The crate is the program `tomcom` that runs
//! such experiments, and the model behind it for other projects.
//!
//! # The model
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
//! - A **session** ([`session::Session`]) is its event log. [`session::apply()`] is the only way to change one. The
//!   **engine** ([`run::engine::SessionEngine`]) raises the events of robot, simulated participant and clock; its caller
//!   passes the time.
//!
//! # The modules
//!
//! Imports go one way, from right to left: [`base`], [`kitchen`], [`robot`] and [`gaze`], [`mind`], [`measures`],
//! [`communication`], [`participant`], [`wizard`] and [`arm`], [`session`], [`history`], [`analysis`]; then, as Cargo
//! features ask for them, `console`, `study`, `display`, `scene`, `edge`; then [`run`], and `cli`. ARCHITECTURE.md says
//! what each contains, and what it must not depend on.
//!
//! # Features
//!
//! All are on by default. With `default-features = false` the crate is the model: 28 packages, no terminal, no network,
//! no async. It reads no files; texts come from the caller.
//!
//! | feature | adds |
//! |---|---|
//! | `cli` | the program: commands, files, recordings, eye trackers, studies |
//! | `console` | the wizard's console in the terminal |
//! | `display` | the server of the participant's display |
//! | `physics` | the simulated arm and its kinematics |
//! | `rerun` | streams for Rerun's viewers |
//!
//! A build refuses what it leaves out, and names the missing feature: [`base::features`].
//!
//! # Example
//!
//! A person takes the wrong ingredient. What do they believe, and which signal should be sent? The folder `examples`
//! has more.
//!
//! ```
//! use std::sync::Arc;
//! use tomcom::base::time::SessionTime;
//! use tomcom::communication::concept::{Concept, DecisionPoint};
//! use tomcom::communication::settings::AssistantSpec;
//! use tomcom::communication::{HighlightSet, available, planner::Planner, situation::Situation};
//! use tomcom::kitchen::{Agent, AspectId, Kitchen, OrderContent, cost_to_go::CostToGo};
//! use tomcom::mind::observation::{Observation, ObservedEvidence};
//! use tomcom::mind::{filter::BeliefFilter, model::HumanModel};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let read = std::fs::read_to_string;
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

pub mod analysis;
pub mod arm;
pub mod base;
#[cfg(feature = "cli")]
pub mod cli;
pub mod communication;
#[cfg(feature = "console")]
pub mod console;
pub mod display;
#[cfg(feature = "cli")]
pub mod edge;
pub mod gaze;
pub mod history;
pub mod kitchen;
pub mod measures;
pub mod mind;
pub mod participant;
pub mod robot;
pub mod run;
#[cfg(feature = "rerun")]
pub mod scene;
pub mod session;
#[cfg(feature = "cli")]
pub mod study;
pub mod wizard;
