//! The kitchen: contents, locations and buttons, the rules of a press, and the cost to go.
//!
//! Everything is computed from two files ([`layout::LayoutSpec`] and [`recipe::RecipesSpec`]); nothing here knows sushi.
//!
//! The files from the ground up; each imports only from those before it:
//!
//! - The parts: `agent`, `look`, [`content`], `location`, `dish`, `process`, [`action`], [`state`], [`aspect`],
//!   [`content_wording`],
//!   `transition_tables`.
//! - The whole: `compiled` ([`Kitchen`] and what can be looked up in it), `rules` (what a press does),
//!   [`no_effect`] (why it does nothing), [`change`], [`world`].
//! - How far it is: [`cost_to_go`].
//! - Where it comes from: [`layout`] and [`recipe`] (the files as written), [`compile`] (from them to a [`Kitchen`], no larger
//!   than the cost to go can number).

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
pub use aspect::{Aspect, AspectId, AspectKind};
pub use change::{Change, Press};
pub use compiled::Kitchen;
pub use content::{Content, ContentId};
pub use cost_to_go::Fidelity;
pub use dish::{Dish, DishId};
pub use location::{DisplayArea, Location, LocationId, LocationKind, Storage};
pub use look::Appearance;
pub use process::Process;
pub use state::{OrderContent, Recipes, State};
pub use world::{WeightedWorld, WeightedWorlds, World};
