//! The examples run: each checks what it shows.

#[path = "../../examples/ask_the_planner.rs"]
mod ask_the_planner;
#[path = "../../examples/estimate_a_belief.rs"]
mod estimate_a_belief;
#[path = "../../examples/simulate_a_participant.rs"]
mod simulate_a_participant;
#[path = "../../examples/tell_what_the_robot_did.rs"]
mod tell_what_the_robot_did;

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
