//! What every room may use: time, random streams, words, and a little numerical mathematics.

pub mod ascent;
pub mod bits;
pub mod features;
pub mod linear;
pub mod minimise;
pub mod rng;
pub mod surface;
pub mod time;
pub mod words;
