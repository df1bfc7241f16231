//! The real program in a real terminal: every test runs the binary in tmux, presses keys and moves the mouse as a person
//! does, and reads the screen and the recording. Without tmux the tests say that they were skipped.

mod by_hand;
mod leaving;
mod watching;
mod wizard;

use std::path::Path;
use std::sync::Arc;

use tomcom::edge::files::read_session;
use tomcom::kitchen::Kitchen;

fn kitchen(session: &str) -> Arc<Kitchen> {
    let files = read_session(&Path::new("sessions").join(session)).expect("a session of the project");
    Arc::new(files.kitchen.kitchen)
}
