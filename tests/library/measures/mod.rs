//! Measures of whole sessions: what is known of the beliefs behind presses, and how signals are judged.

mod choices;
mod judged_signals;

use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_kitchen;
use tomcom_core::kitchen::Kitchen;

fn kitchen(name: &str) -> Arc<Kitchen> {
    match read_kitchen(Path::new(&format!("layouts/{name}.toml"))) {
        Ok(files) => Arc::new(files.kitchen),
        Err(error) => panic!("{error}"),
    }
}
