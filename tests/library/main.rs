//! The crate used as a library, a module a theme.

mod arm;
mod bids_export;
mod button_box;
mod cohort;
mod connection_table;
mod console;
mod display;
mod display_palette;
mod display_probes;
mod display_server;
mod escapes;
mod examples;
#[cfg(unix)]
mod external;
mod films;
mod fit;
mod gathering;
mod gaze;
mod gaze_senders;
mod inference;
mod lsl_streams;
mod malformed_requests;
mod mcap_export;
mod measures;
mod observers;
mod outside;
mod participant;
mod plan;
mod ranges;
mod raw_page;
mod readers;
mod replay;
mod robot_on_display;
mod session;
mod session_files;
mod study;
mod support;
#[cfg(unix)]
mod terminal_input;
mod viewers;
