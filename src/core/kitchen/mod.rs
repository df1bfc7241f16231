//! The kitchen: contents, locations and buttons, the rules of a press, and the cost to go.
//!
//! The kitchen is computed from two files ([`files`]) by [`compile`]; no code depends on a particular dish.

pub mod compile;
mod compiled;
pub mod cost_to_go;
pub mod files;
pub mod parts;
pub mod rules;
pub mod state;

pub use compiled::Kitchen;
pub use cost_to_go::Fidelity;
pub use parts::{
    Agent, Appearance, AspectId, AspectKind, Button, ButtonAction, ButtonColour, ButtonId, Content, ContentId, Dish,
    DishId, DisplayArea, IngredientStorage, Location, LocationId, LocationKind, ProcessingStep, StateAspect,
};
pub use state::{KitchenChange, OrderContent, Press, Recipes, State, WeightedWorld, WeightedWorlds, World};
