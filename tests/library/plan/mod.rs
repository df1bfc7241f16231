//! Plans: who comes when under which condition with which orders, what comes next whatever was recorded, cut or left, and
//! what happens around a trial.

mod assignment;
mod progress;
mod protocol;
mod questionnaires;
mod tutorial;

use std::fs;
use std::path::{Path, PathBuf};

use tomcom::edge::files::read_session;
use tomcom_session::files::SessionSetup;
use tomcom_session::plan::Study;

fn files() -> SessionSetup {
    read_session(Path::new("sessions/study.toml")).expect("the study of the project")
}

fn study(change: impl Fn(&mut SessionSetup)) -> Study {
    let mut files = files();
    change(&mut files);
    files.study().expect("a plan")
}

/// An empty folder for the test of this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plan").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}
