//! The study: from what single trials show to what a whole study says. Pure; recordings are read elsewhere.

pub mod effect;
pub mod statistics;
pub mod trial;
