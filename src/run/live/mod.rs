//! A live session: real time, a wizard at the console, every event recorded at once.

mod calibration;
#[cfg(feature = "display")]
mod display;
#[cfg(not(feature = "display"))]
#[path = "without_display.rs"]
mod display;
mod gaze;
mod inputs;
mod live_session;
mod recording;
mod showing;
#[cfg(feature = "rerun")]
mod viewing;
#[cfg(not(feature = "rerun"))]
#[path = "without_rerun.rs"]
mod viewing;

pub(super) use live_session::run;
