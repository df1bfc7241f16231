//! The wizard's console in the Elm architecture: `key -> Message -> update -> Option<Command>`, and a [`view()`] that
//! only reads. Whatever affects the participant, the robot or the analysis becomes an event of the session; everything
//! else stays in the [`ConsoleModel`].

pub mod actions;
pub mod beliefs;
pub mod chord;
pub mod coding;
pub mod console_model;
pub mod form;
pub mod gaze_check;
pub mod interventions;
pub mod key_action;
mod key_press;
pub mod keys;
pub mod kitchen_map;
pub mod lists;
pub mod mouse;
pub mod panels;
mod possible;
pub mod preflight;
pub mod probe_keys;
mod table;
pub mod text_columns;
pub mod text_input;
pub mod view;

pub use actions::update;
pub use console_model::{ConsoleCommand, ConsoleMessage, ConsoleModel};
pub use keys::{KeyBindings, KeyFileBindings};
pub use view::view;
