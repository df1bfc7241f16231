//! Basics that every module may use.

pub mod maths;
pub mod number_range;
pub mod rng;
pub mod text;
pub mod time;
