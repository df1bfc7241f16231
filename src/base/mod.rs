//! What every room may use: time, random streams, words, and the search for a minimum.

pub mod minimise;
pub mod rng;
pub mod time;
pub mod words;
