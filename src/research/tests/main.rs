//! The commands of this crate, and the crates of the program against its plain references.

mod commands;
mod cost_to_go;
#[path = "../../../tests/core/files.rs"]
mod files;
mod inference;
mod missed_signals;
mod offers;
mod oracle;
mod robustness;
mod states_met;
mod sweep;

use std::path::{Path, PathBuf};

use tomcom_session::files::{SessionSetup, read_session};
use tomcom_session::headless::{Outside, SimulationShard};
use tomcom_study::files::simulated_trials::{SimulationRequest, each_trial};

/// An empty folder for the test of this name.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("research").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

/// A session file of the project, with an inference that is coarse and quick.
fn session(name: &str) -> SessionSetup {
    let path = files::place(Path::new("sessions").join(name));
    let mut files = read_session(&path, None).unwrap_or_else(|error| panic!("{error}"));
    let inference = &mut files.spec.human.inference;
    (inference.beliefs, inference.states, inference.max_beliefs) = (16, 8, 32);
    files
}

/// The recordings of simulated trials of a session.
fn recorded(files: &SessionSetup, trials: u64, out: &Path) -> Vec<PathBuf> {
    let request =
        SimulationRequest { files: files.clone(), trials, shard: SimulationShard::WHOLE, out: out.to_path_buf() };
    let mut recordings = Vec::new();
    let simulated = each_trial(
        &request,
        Outside::NOTHING,
        || (),
        |trial| {
            recordings.push(trial.folder);
            Ok(())
        },
    );
    simulated.unwrap_or_else(|error| panic!("{error}"));
    recordings
}
