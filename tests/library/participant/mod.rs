//! Simulated participants: they err at the rates of people, for reasons that can be named.

mod accepted;
mod population;

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
