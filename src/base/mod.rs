//! What every room may use: time, random streams, identifiers of agents.

pub mod rng;
pub mod time;
