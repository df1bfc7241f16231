//! Gaze: the mapping from a tracker's surface, and what comes of samples.

mod calibration;
mod capture;
mod formats;
mod last_seen;
mod quality;
mod rate;
mod tables;

use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_session;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::SessionSpec;
use tomcom_session::engine::SessionEngine;

/// A session of the sushi kitchen with these settings.
fn engine(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    change(&mut files.spec);
    let kitchen = Arc::new(files.kitchen.kitchen);
    SessionEngine::new(kitchen.clone(), files.spec, 0, CostToGo::new(kitchen))
}
