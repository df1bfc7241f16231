//! Gaze: the mapping from a tracker's surface, and what comes of samples.

mod calibration;
mod capture;
mod formats;
mod quality;

use crate::support::*;

/// A session of the sushi kitchen with these settings.
fn engine(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    let mut files = session_file("default");
    change(&mut files.spec);
    engine_of(files, 0)
}
