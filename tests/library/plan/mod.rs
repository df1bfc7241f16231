//! Plans: who comes when under which condition with which orders, what comes next whatever was recorded, cut or left, and
//! what happens around a trial.

mod assignment;
mod protocol;
mod questionnaires;
mod tutorial;

use tomcom_session::plan::Study;

use crate::support::*;

/// The study of the project as it is rehearsed: with simulated participants.
fn files() -> SessionSetup {
    let mut files = session_file("study");
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Simulated, GazeSource::Simulated);
    files
}

fn study(change: impl Fn(&mut SessionSetup)) -> Study {
    let mut files = files();
    change(&mut files);
    files.study().expect("a plan")
}

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("plan/{name}"))
}
