//! The tables: of each what a row is made from, and its columns.

pub mod actions;
pub mod aspect_beliefs;
pub mod communications;
pub mod concepts;
pub mod gaze_runs;
pub mod participants;
pub mod questionnaires;
pub mod trials;
