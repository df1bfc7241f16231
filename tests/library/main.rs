//! The crate used as a library, a module a theme.

mod arm;
mod bids_export;
mod cohort;
mod connection_table;
mod console;
mod corrections;
mod display;
mod display_clock;
mod display_palette;
mod display_probes;
mod display_server;
mod display_words;
mod escapes;
mod examples;
mod fit;
mod gathering;
mod gaze;
mod gaze_senders;
mod inference;
mod lsl_streams;
mod malformed_requests;
mod mcap_export;
mod measures;
mod participant;
mod participant_codes;
mod plan;
mod ranges;
mod readers;
mod replay;
mod robot_on_display;
mod session;
mod study;
#[cfg(unix)]
mod terminal_input;
mod viewers;

use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_kitchen;
use tomcom_core::kitchen::Kitchen;

/// The kitchen of one of the layouts in `layouts`.
fn kitchen(name: &str) -> Arc<Kitchen> {
    match read_kitchen(Path::new(&format!("layouts/{name}.toml"))) {
        Ok(files) => Arc::new(files.kitchen),
        Err(error) => panic!("{error}"),
    }
}

/// Holds a text against `tests/snapshots/THEME__NAME.snap`.
fn check_snapshot(theme: &str, name: impl std::fmt::Display, text: impl std::fmt::Display) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(format!("{theme}__{name}"), text.to_string()));
}
