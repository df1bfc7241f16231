//! What every room may use: time, random streams, words, and a search for a minimum.

pub mod bits;
pub mod features;
pub mod minimise;
pub mod rng;
pub mod time;
pub mod words;
