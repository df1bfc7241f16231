//! Shells that run sessions: they combine session, robot, participant, files and clock, which no other module combines.

pub mod accuracy;
mod advisor_thread;
pub mod check_beliefs;
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
pub mod robustness;
pub mod seekable_replay;
pub mod series;
pub mod simulate;
mod start_prompt;
pub mod steadiness;
pub mod sweep;
pub mod timing;
pub mod train;
mod training_shell;
