//! Cohorts of simulated participants: scripted wizards, what one trial teaches for the next, parts of a job array, and what
//! was made before.

mod codes;
mod job_array;
mod learning;
mod pool;
mod twins;
mod wizard;

use std::fs;
use std::path::{Path, PathBuf};

use tomcom::edge::files::read_session;
use tomcom::run::simulate::{SimulationRequest, simulate};
use tomcom_session::TimestampedEvent;
use tomcom_session::files::SessionSetup;
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::LogReader;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cohort").join(name);
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// The paper's plan with short trials.
fn paper(presses: u32) -> SessionSetup {
    let mut files = read_session(Path::new("sessions/paper.toml")).expect("the paper's session");
    files.spec.trial.presses = presses;
    files
}

fn run(
    files: &SessionSetup,
    trials: u64,
    shard: SimulationShard,
    out: &Path,
) -> tomcom_study::analysis::trial_summary::SimulationSummary {
    let simulation = SimulationRequest { files: files.clone(), trials, shard, out: out.to_path_buf() };
    simulate(&simulation, || ()).expect("the folder can be written")
}

fn events(recording: &Path) -> (tomcom_session::LogHeader, Vec<TimestampedEvent>) {
    let mut log = LogReader::open(recording).expect("a recording");
    let mut all = Vec::new();
    while let Some(line) = log.next_line().expect("an event") {
        all.push(line.stamped);
    }
    (log.header, all)
}
