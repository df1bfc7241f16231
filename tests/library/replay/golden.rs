//! Writes the golden recordings anew, which is needed only when the format changes:
//! `cargo test --test library -- --ignored golden_recordings_are_written`, then `INSTA_UPDATE=always cargo test --test
//! library replay::equality`.

use std::fs;
use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom::run::simulate::{SimulationRequest, simulate};
use tomcom_core::communication::settings::ShadowMode;
use tomcom_session::SessionSpec;
use tomcom_session::header::VERSION;
use tomcom_session::headless::SimulationShard;
use tomcom_session::log::LOG_NAME;
use tomcom_session::settings::{ArmKind, Condition, GazeSource};

use super::{by_hand, folder};

/// Copies a log to the golden recordings.
fn keep(log: &Path, name: &str) {
    fs::copy(log, format!("tests/golden/format-{VERSION}-{name}.jsonl")).expect("a golden recording can be written");
}

/// Simulates a trial of a session file, changed by `change`, and keeps it.
fn keep_simulated(name: &str, session: &str, change: fn(&mut SessionSpec)) {
    let mut files = read_session(&Path::new("sessions").join(session)).expect("a session file");
    (files.spec.trial.condition, files.spec.robot.arm) = (Condition::None, ArmKind::Timed);
    change(&mut files.spec);
    let out = folder(&format!("golden-{name}"));
    let request = SimulationRequest { files, trials: 1, shard: SimulationShard::WHOLE, out };
    let made = simulate(&request, || ()).expect("the folder can be written");
    keep(&Path::new(&made.recordings[0]).join(LOG_NAME), name);
}

#[test]
#[ignore = "writes tests/golden"]
fn golden_recordings_are_written() {
    let (log, _) = by_hand("default.toml", ArmKind::Timed, "golden-hand", 2);
    keep(&log, "hand");
    keep_simulated("simulated", "default.toml", |spec| {
        (spec.seed, spec.trial.presses, spec.assistant.shadow) = (7, 8, ShadowMode::Off);
    });
    keep_simulated("offers", "default.toml", |spec| {
        (spec.seed, spec.trial.presses, spec.participant.gaze) = (11, 36, GazeSource::None);
    });
    keep_simulated("probes", "probes.toml", |spec| {
        (spec.seed, spec.trial.seconds, spec.participant.gaze) = (3, 75.0, GazeSource::None);
        let probes = spec.probes.as_mut().expect("the session has probes");
        (probes.per_trial, probes.apart_s) = (2, 20.0);
    });
}
