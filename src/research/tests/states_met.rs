//! The states of sessions on which the cost to go is held against exact search (`cost_to_go.rs`).

use std::fs;
use std::path::Path;
use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Kitchen, State};
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::read_session;
use tomcom_session::{Event, TrialPhase};

use crate::files::{kitchen, place, read};

/// States a kitchen.
const STATES: usize = 1000;

/// Different states that simulated sessions went through, a few from every trial.
fn met(kitchen: &Arc<Kitchen>) -> Vec<State> {
    let mut spec = read_session(&place("sessions/default.toml"), None).expect("the default session").spec;
    spec.seed = 3;
    let mut states: Vec<State> = Vec::new();
    for trial in 0.. {
        let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), trial, CostToGo::new(kitchen.clone()));
        let _ = engine.input(SessionTime::ZERO, Event::TrialStarted);
        let mut of_trial = Vec::new();
        while engine.session().phase == TrialPhase::Running {
            engine.fire();
            let state = engine.session().state;
            if of_trial.last() != Some(&state) && kitchen.wanted(state).next().is_some() {
                of_trial.push(state);
            }
        }
        for state in of_trial.into_iter().step_by(4) {
            if !states.contains(&state) {
                states.push(state);
            }
            if states.len() == STATES {
                return states;
            }
        }
    }
    states
}

#[test]
#[ignore = "takes minutes"]
fn the_states_in_the_files_are_those_that_sessions_meet() {
    for name in ["burger", "sushi"] {
        let kitchen = kitchen(name);
        let states: Vec<String> = met(&kitchen).iter().map(|state| format!("{:x}", state.bits())).collect();
        let path = format!("src/research/tests/oracle/{name}_met.txt");
        let text = read(&path);
        let lines = text.lines().filter(|line| !line.starts_with('#'));
        let listed: Vec<&str> = lines.filter_map(|line| line.split(' ').next()).collect();
        if states != listed {
            // The test of the core takes such a file, and replaces the costs.
            let found = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}_met.txt"));
            let lines: String = states.iter().map(|state| format!("{state} 0 0\n")).collect();
            fs::write(&found, lines).expect("the file can be written");
            panic!("{path}: sessions meet other states: {}", found.display());
        }
    }
}
