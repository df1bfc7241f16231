//! Plans: who comes when under which condition with which orders, what comes next whatever was recorded, cut or left, and
//! what happens around a trial.

mod assignment;
mod protocol;
mod questionnaires;
mod tutorial;

use tomcom_session::plan::Study;

use crate::support::*;

fn files() -> SessionSetup {
    session_file("study")
}

fn study(change: impl Fn(&mut SessionSetup)) -> Study {
    let mut files = files();
    change(&mut files);
    files.study().expect("a plan")
}

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("plan/{name}"))
}
