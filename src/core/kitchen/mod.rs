//! The kitchen: contents, locations and buttons, the rules of a press, and the cost to go.
//!
//! The kitchen is computed from two files ([`layout::LayoutSpec`] and [`recipe::RecipesSpec`]); no code depends on a
//! particular dish.
//!
//! The files from the ground up; each imports only from those before it:
//!
//! - The parts: `agent`, `look`, [`content`], `location`, `dish`, `process`, [`action`], [`state`], [`aspect`],
//!   [`content_wording`], `transition_tables`.
//! - The whole: `compiled` ([`Kitchen`] and its look-ups), `rules` (effects of presses), [`no_effect`] (why a press has
//!   no effect), [`change`], [`world`].
//! - Distance to the goal: [`cost_to_go`].
//! - Loading: [`layout`] and [`recipe`] (the files as written), [`compile`] (from the files to a [`Kitchen`], whose
//!   size the keys of the cost to go limit).

pub mod action;
mod agent;
pub mod aspect;
pub mod change;
pub mod compile;
mod compiled;
pub mod content;
pub mod content_wording;
pub mod cost_to_go;
mod dish;
pub mod layout;
pub mod layout_ranges;
mod location;
pub mod look;
pub mod no_effect;
mod process;
pub mod recipe;
mod rules;
pub mod state;
mod transition_tables;

pub mod world;

pub use action::{Button, ButtonAction, ButtonColour, ButtonId};
pub use agent::Agent;
pub use aspect::{AspectId, AspectKind, StateAspect};
pub use change::{KitchenChange, Press};
pub use compiled::Kitchen;
pub use content::{Content, ContentId};
pub use cost_to_go::Fidelity;
pub use dish::{Dish, DishId};
pub use location::{DisplayArea, IngredientStorage, Location, LocationId, LocationKind};
pub use look::Appearance;
pub use process::ProcessingStep;
pub use state::{OrderContent, Recipes, State};
pub use world::{WeightedWorld, WeightedWorlds, World};
