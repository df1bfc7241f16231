//! Shells that run sessions: they combine session, robot, participant, files and clock, which no other module combines.

mod advisor_desk;
mod coding_desk;
mod desk;
pub mod error;
mod event_loop;
pub mod leaving;
pub mod live;
#[cfg(feature = "rerun")]
pub mod open_viewer;
pub mod options;
pub mod pick_recording;
pub mod plan;
pub mod recording_list;
pub mod resume;
pub mod review_console;
pub mod seekable_replay;
pub mod series;
pub mod simulate;
pub mod train;
mod training_shell;
mod unfinished_recording;
pub mod watch_desk;
mod wizard_question;
