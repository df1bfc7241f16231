//! Shells that run sessions: they combine session, robot, participant, files and clock, which no other module combines. What
//! they stand on touches the outside: terminal, clock, key file, doctor, forget.

mod advisor_thread;
pub mod ask;
mod assistant_link;
pub mod clock;
pub mod comparison_thread;
pub mod doctor;
pub mod error;
mod event_loop;
pub mod files;
pub mod film;
#[cfg(unix)]
mod film_player;
#[cfg(not(unix))]
#[path = "without_film_player.rs"]
mod film_player;
pub mod forget;
mod frames;
pub mod key_file;
pub mod leaving;
pub mod list_cache;
pub mod live;
mod mind_link;
#[cfg(not(all(feature = "display", feature = "rerun", feature = "ur")))]
mod missing_features;
#[cfg(feature = "rerun")]
pub mod open_viewer;
mod operator_station;
pub mod options;
mod participant_link;
pub mod picture_file;
pub mod plan;
mod rater_files;
mod recorded_films;
pub mod recording_list;
pub mod resume;
pub mod review_console;
#[cfg(feature = "display")]
pub mod screen_frame;
pub mod seekable_replay;
pub mod series;
pub mod simulate;
mod start_prompt;
pub mod terminal;
pub mod terminal_bytes;
pub mod terminal_input;
pub mod tournament;
pub mod train;
mod training_shell;
