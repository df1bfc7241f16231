//! Basics that every module may use: session time, random streams, bit sets, words, printable text, paths as text, cells of
//! tables, number ranges, the beta distribution.

pub mod bits;
pub mod incomplete_beta;
pub mod number_range;
pub mod path_text;
pub mod printable;
pub mod rng;
pub mod spreadsheet;
pub mod time;
pub mod words;
