//! The wizard's console in the Elm architecture: `key -> Message -> update -> Option<Command>`, and a [`view()`] that
//! only reads. Whatever affects the participant, the robot or the analysis becomes an event of the session; everything
//! else stays in the [`ConsoleModel`].

pub mod arrange;
mod beliefs;
pub mod chord;
pub mod click;
pub mod click_question;
pub mod codebook;
pub mod coding;
pub mod coding_list;
pub mod compared;
mod console_actions;
pub mod console_message;
pub mod console_model;
pub mod display_status;
pub mod form;
pub mod gaze_advice;
pub mod gaze_pairing;
pub mod gaze_targets;
pub mod hands;
mod held_keys;
pub mod key_action;
mod key_press;
pub mod keymap;
pub mod keys;
pub mod lesson;
pub mod list_cursor;
pub mod map_items;
mod mouse;
pub mod note;
pub mod notice;
pub mod palette;
pub mod panel;
pub mod panels;
pub mod picker;
pub mod playback;
mod possible;
pub mod preflight;
pub mod probe_entry;
pub mod probe_keys;
pub mod question;
pub mod rater_session;
pub mod recording_picker;
pub mod screen;
mod sending;
mod sheet_key;
mod table;
pub mod text_columns;
pub mod update;
pub mod view;

pub use console_message::{ConsoleCommand, ConsoleMessage};
pub use console_model::ConsoleModel;
pub use keymap::KeyFileBindings;
pub use keys::KeyBindings;
pub use update::update;
pub use view::view;
