//! Cohorts of simulated participants: scripted wizards, what one trial teaches for the next, parts of a job array, and what
//! was made before.

mod codes;
mod job_array;
mod pool;
mod wizard;

use tomcom_study::analysis::trial_summary::SimulationSummary;

use crate::support::*;

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("cohort/{name}"))
}

/// The paper's plan with short trials.
fn paper(presses: u32) -> SessionSetup {
    let mut files = session_file("paper");
    files.spec.trial.presses = presses;
    files
}

fn run(files: &SessionSetup, trials: u64, shard: SimulationShard, out: &Path) -> SimulationSummary {
    let simulation = SimulationRequest { files: files.clone(), trials, shard, out: out.to_path_buf() };
    simulate(&simulation, || ()).expect("the folder can be written")
}

fn events(recording: &Path) -> (LogHeader, Vec<TimestampedEvent>) {
    let mut log = LogReader::open(recording).expect("a recording");
    let mut all = Vec::new();
    while let Some(line) = log.next_line().expect("an event") {
        all.push(line.stamped);
    }
    (log.header, all)
}
