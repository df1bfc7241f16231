//! Everything that touches the outside of the program: files, terminal, network, clocks.

mod arrival;
pub mod ask;
pub mod clock;
mod compared_clock;
pub mod connection_table;
pub mod datagram_holder;
#[cfg(feature = "display")]
pub mod display;
pub mod doctor;
pub mod files;
pub mod forget;
mod frames;
mod gaze_connection;
pub mod gaze_file;
mod gaze_gate;
pub mod gaze_input;
pub mod gaze_json;
pub mod gaze_line;
mod gaze_rejections;
mod gaze_table;
#[cfg(any(feature = "display", feature = "rerun"))]
mod host_name;
pub mod key_file;
pub mod list_cache;
pub mod lsl;
pub mod near_path;
mod outer_address;
mod pairing;
mod pairing_code;
pub mod picture_file;
pub mod pupil;
#[cfg(feature = "rerun")]
pub mod rerun;
#[cfg(feature = "rerun")]
pub mod rrd;
mod sender_clock;
#[cfg(feature = "rerun")]
pub mod stream;
pub mod stream_head;
pub mod terminal;
pub mod terminal_bytes;
pub mod terminal_input;
mod tracker_folder;
#[cfg(feature = "rerun")]
pub mod viewer;
