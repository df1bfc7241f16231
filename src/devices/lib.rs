//! What a session has around it: eye trackers ([`pupil`], [`gaze_json`], [`lsl`], [`gaze_file`]), the participant's display
//! ([`sight`]: what the page may see; `display`: the server with its page), the observers' page of
//! the wizard's screen (`observers`), Rerun (`scene`: a session as entities;
//! `rerun`, `stream`, `rrd`: viewers and files), programs that take the part of a concept or of the participant
//! ([`external`]), a button box ([`button_box`]), cameras that film the room ([`film_recorder`]), and a simulated controller of a UR5 (`ur`).
//!
//! The crate knows nothing of the console and of studies.

#![deny(unsafe_code)]

mod arrival;
pub mod button_box;
pub mod child_process;
mod compared_clock;
pub mod connection_table;
#[cfg(feature = "display")]
pub mod display;
pub mod external;
pub mod ffmpeg;
pub mod film_recorder;
mod gaze_connection;
pub mod gaze_file;
mod gaze_gate;
pub mod gaze_input;
pub mod gaze_json;
pub mod gaze_line;
mod gaze_table;
#[cfg(any(feature = "display", feature = "rerun"))]
mod host_name;
pub mod lsl;
#[cfg(feature = "display")]
pub mod observers;
mod outer_address;
#[cfg(feature = "display")]
mod page_server;
mod pairing;
pub mod pupil;
#[cfg(feature = "rerun")]
pub mod rerun;
#[cfg(feature = "rerun")]
pub mod rrd;
#[cfg(feature = "rerun")]
pub mod scene;
mod sender_clock;
pub mod sight;
#[cfg(feature = "rerun")]
pub mod stream;
pub mod stream_head;
#[cfg(feature = "ur")]
pub mod ur;
#[cfg(feature = "rerun")]
pub mod viewer;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Locks a mutex, which stays usable after a panic of another thread.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
