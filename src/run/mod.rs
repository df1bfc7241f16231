//! Shells that run sessions: they combine session, robot, participant, files and clock, which no other module combines.

#[cfg(feature = "cli")]
pub mod accuracy;
#[cfg(feature = "cli")]
mod advisor_desk;
#[cfg(feature = "cli")]
pub mod check_beliefs;
#[cfg(feature = "cli")]
mod coding_desk;
#[cfg(feature = "cli")]
mod desk;
#[cfg(feature = "cli")]
pub mod error;
#[cfg(feature = "cli")]
mod event_loop;
#[cfg(feature = "cli")]
pub mod leaving;
#[cfg(feature = "cli")]
pub mod live;
#[cfg(all(feature = "cli", feature = "rerun"))]
pub mod open_viewer;
#[cfg(feature = "cli")]
pub mod options;
#[cfg(feature = "cli")]
pub mod pick_recording;
#[cfg(feature = "cli")]
pub mod plan;
#[cfg(feature = "cli")]
pub mod recording_list;
#[cfg(feature = "cli")]
pub mod resume;
#[cfg(feature = "cli")]
pub mod review_console;
#[cfg(feature = "cli")]
pub mod robustness;
#[cfg(feature = "cli")]
pub mod seekable_replay;
#[cfg(feature = "cli")]
pub mod series;
#[cfg(feature = "cli")]
pub mod simulate;
#[cfg(feature = "cli")]
pub mod steadiness;
#[cfg(feature = "cli")]
pub mod sweep;
#[cfg(feature = "cli")]
pub mod timing;
#[cfg(feature = "cli")]
pub mod train;
#[cfg(feature = "cli")]
mod training_shell;
#[cfg(feature = "cli")]
mod unfinished_recording;
#[cfg(feature = "cli")]
pub mod watch_desk;
#[cfg(feature = "cli")]
mod wizard_question;
