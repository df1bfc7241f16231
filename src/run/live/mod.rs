//! A live session: real time, a wizard at the console, every event recorded at once.
//!
//! Frames are composed when something changed, at most 30 per second, and a separate thread writes them, so that a slow
//! terminal delays no press. Before a frame is drawn, its visible content is recorded if it changed. The log is flushed
//! with every event, gaze within 50 ms. Four times a second, the loop checks whether the log is still in place, and
//! saves a log whose folder vanished.

mod capture_orders;
#[cfg(feature = "display")]
pub mod display;
mod filming;
mod gaze_events;
mod inputs;
mod live_session;
mod lsl_streaming;
mod presses;
mod recording;
mod showing;
#[cfg(feature = "rerun")]
mod viewing;

pub(super) use live_session::run;

#[cfg(not(feature = "display"))]
use super::missing_features::display;
#[cfg(not(feature = "rerun"))]
use super::missing_features::rerun as viewing;
