//! The examples run: each checks what it shows.

#[path = "../../examples/ask_the_planner.rs"]
mod ask_the_planner;
#[path = "../../examples/estimate_a_belief.rs"]
mod estimate_a_belief;
#[path = "../../examples/ideal_observer/main.rs"]
#[allow(dead_code)] // Its command line is for people.
mod ideal_observer;
#[path = "../../examples/simulate_a_participant.rs"]
mod simulate_a_participant;
#[path = "../../examples/tell_what_the_robot_did.rs"]
mod tell_what_the_robot_did;

use std::fs;
use std::path::Path;

use ideal_observer::particles::ObserverSettings;
use tomcom::edge::files::read_session;
use tomcom::run::simulate::{SimulationRequest, SimulationShard, simulate};
use tomcom::session::settings::{ArmKind, Condition};

/// Followers whose population is that of the recorded person press as it does, and know better than a baseline.
#[test]
fn an_ideal_observer_follows_recordings() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ideal_observer");
    let _ = fs::remove_dir_all(&out);
    let mut files = read_session(Path::new("sessions/default.toml")).expect("the default session");
    (files.spec.robot.arm, files.spec.trial.condition, files.spec.seed) = (ArmKind::Timed, Condition::None, 9912);
    files.spec.trial.presses = 60;
    let request = SimulationRequest { files, trials: 5, shard: SimulationShard::WHOLE, out };
    let recordings = simulate(&request, || ()).expect("trials").recordings;
    let recordings: Vec<_> = recordings.iter().map(|path| Path::new(path).to_path_buf()).collect();
    let trials = ideal_observer::read(&recordings).expect("unassisted trials with gaze");
    let settings = ObserverSettings { particles: 64, seed: 1, varies: 0.01 };
    let found = ideal_observer::follow(&trials, &settings);
    let [presses, agreed, ..] = found.presses;
    assert!(agreed as f64 > 0.8 * presses as f64, "{agreed} of {presses} presses");
    let (name, locations) = &found.groups[0];
    let [baseline, _, ideal] = locations.log_score;
    assert!(ideal > baseline, "{name}: {ideal} and {baseline}");
    assert_eq!(format!("{found:?}"), format!("{:?}", ideal_observer::follow(&trials, &settings)), "the same again");
}

#[test]
fn a_belief_is_estimated() {
    estimate_a_belief::main().unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn the_planner_is_asked() {
    ask_the_planner::main().unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn a_participant_is_simulated() {
    simulate_a_participant::main().unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn a_signal_is_recommended_for_what_the_robot_did_unseen() {
    tell_what_the_robot_did::main().unwrap_or_else(|error| panic!("{error}"));
}
