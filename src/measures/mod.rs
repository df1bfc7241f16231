//! Measures of what the human does, used live and in the analysis.

pub mod errors;
