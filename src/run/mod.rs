//! Shells that run sessions: they combine session, robot, participant, files and clock, which no other module combines.

mod advisor_thread;
pub mod comparison_thread;
pub mod error;
mod event_loop;
pub mod leaving;
pub mod live;
#[cfg(feature = "rerun")]
pub mod open_viewer;
mod operator_station;
pub mod options;
pub mod plan;
mod rater_files;
pub mod recording_list;
pub mod resume;
pub mod review_console;
pub mod seekable_replay;
pub mod series;
pub mod simulate;
mod start_prompt;
pub mod train;
mod training_shell;
