//! What is observed in a session with a simulated participant.

use std::sync::Arc;

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Kitchen;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::mind::observation::Observation;
use tomcom_session::engine::SessionEngine;
use tomcom_session::follower::SessionFollower;
use tomcom_session::{Event, Session, SessionSpec};

/// All observations of an unassisted trial, until this number of presses of both agents.
pub fn recorded(kitchen: &Arc<Kitchen>, seed: u64, presses: u32) -> Vec<Observation> {
    let text = format!("layout = \"\"\nseed = {seed}\n[trial]\ncondition = \"none\"\npresses = {presses}\n");
    let mut spec: SessionSpec = toml::from_str(&text).expect("settings of a session");
    // The estimate of the session itself is of no interest here.
    (spec.human.inference.beliefs, spec.human.inference.states, spec.human.inference.max_beliefs) = (1, 1, 1);
    let cost = CostToGo::new(kitchen.clone());
    let mut engine = SessionEngine::new(kitchen.clone(), spec.clone(), 0, cost.clone());
    let mut follower = SessionFollower::new(Session::new(kitchen.clone(), spec, 0), cost);
    let mut observations = Vec::new();
    let mut events = engine.input(SessionTime::ZERO, Event::TrialStarted).events;
    loop {
        for stamped in &events {
            let applied = follower.apply(stamped).expect("an event of the session");
            if let Some(what) = follower.observed(stamped, &applied.change) {
                observations.push(Observation { time: stamped.time, what });
            }
        }
        if !engine.session().is_running() {
            return observations;
        }
        events = engine.fire();
    }
}
