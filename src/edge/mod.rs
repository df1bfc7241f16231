//! Everything that touches the outside: files, terminal, network, clock.

pub mod clock;
pub mod files;
pub mod log;
