//! The wizard's console in the Elm architecture: `key -> Message -> update -> Option<Command>`, and a [`view()`] that only reads.
//! Whatever affects participant, robot or analysis becomes an event; everything else stays in the [`ConsoleModel`].

pub mod arrange;
pub mod calibration;
pub mod chord;
pub mod coding;
pub mod compared;
pub mod display;
pub mod form;
pub mod hands;
pub mod key_action;
pub mod keymap;
pub mod keys;
pub mod lesson;
pub mod message;
pub mod model;
pub mod note;
pub mod notice;
pub mod panel;
pub mod panels;
pub mod picker;
pub mod playback;
pub mod preflight;
pub mod question;
pub mod rater_session;
pub mod screen;
mod sending;
mod table;
pub mod update;
pub mod view;

pub use keymap::KeyMap;
pub use keys::KeyBindings;
pub use message::{ConsoleCommand, ConsoleMessage};
pub use model::ConsoleModel;
pub use update::update;
pub use view::view;
