//! Declarations of the CSV tables of a study: the type of a row, and the columns.

pub mod actions;
pub mod communications;
pub mod participants;
pub mod probe_table;
pub mod trials;
