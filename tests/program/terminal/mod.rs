//! Sessions, trainings and replays at the console.

mod button_box;
mod by_hand;
mod external;
mod films;
mod leaving;
mod observers;
mod watching;
mod wizard;

use std::path::Path;
use std::sync::Arc;

use tomcom::run::files::read_session;
use tomcom_core::kitchen::Kitchen;

fn kitchen(session: &str) -> Arc<Kitchen> {
    let files = read_session(&Path::new("sessions").join(session)).expect("a session of the project");
    Arc::new(files.kitchen.kitchen)
}
