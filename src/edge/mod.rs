//! Everything that touches the outside of the program: files, terminal, network, clocks.

pub mod ask;
pub mod clock;
pub mod doctor;
pub mod files;
pub mod forget;
mod frames;
pub mod key_file;
pub mod list_cache;
pub mod near_path;
pub mod picture_file;
pub mod terminal;
pub mod terminal_bytes;
pub mod terminal_input;
