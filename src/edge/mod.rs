//! Everything that touches the outside: files, terminal, network, clock.

pub mod files;
