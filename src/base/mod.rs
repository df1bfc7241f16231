//! What every room may use: time, random streams, words.

pub mod rng;
pub mod time;
pub mod words;
