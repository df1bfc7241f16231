//! The wizard's console in the Elm architecture: `key -> Message -> update -> Option<Command>`, and a [`view()`] that only reads.
//! Whatever affects participant, robot or analysis becomes an event; everything else stays in the [`ConsoleModel`].

pub mod arrange;
mod beliefs;
pub mod chord;
pub mod codebook;
pub mod coding;
pub mod coding_list;
pub mod compared;
pub mod console_message;
pub mod console_model;
pub mod display_status;
pub mod form;
pub mod gaze_targets;
pub mod hands;
pub mod key_action;
pub mod keymap;
pub mod keys;
pub mod lesson;
pub mod note;
pub mod notice;
pub mod panel;
pub mod panels;
pub mod picker;
pub mod playback;
pub mod preflight;
pub mod question;
pub mod rater_session;
pub mod recording_picker;
pub mod screen;
mod sending;
mod table;
pub mod update;
pub mod view;

pub use console_message::{ConsoleCommand, ConsoleMessage};
pub use console_model::ConsoleModel;
pub use keymap::KeyMap;
pub use keys::KeyBindings;
pub use update::update;
pub use view::view;
