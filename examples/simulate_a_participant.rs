//! Runs a trial with a simulated participant and a robot with a timed arm, in virtual time.
//!
//! `cargo run --example simulate_a_participant --no-default-features`

use std::error::Error;
use std::sync::Arc;

use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen};
use tomcom_session::engine::SessionEngine;
use tomcom_session::headless;
use tomcom_session::{Event, SessionSpec};

const SETTINGS: &str = r#"
layout = "sushi.toml"
seed = 7
[trial]
condition = "none"
presses = 60
"#;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (layout, recipes) =
        (std::fs::read_to_string("layouts/sushi.toml")?, std::fs::read_to_string("recipes/sushi.toml")?);
    let kitchen = Arc::new(Kitchen::from_toml(&layout, &recipes)?);
    let spec = SessionSpec::from_toml(SETTINGS)?;
    let mut engine = SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen.clone()));

    // Every event of the session, stamped with its time: the same events that a recording has.
    let mut samples = 0;
    headless::run(&mut engine, |stamped| match &stamped.event {
        Event::Gaze(_) => samples += 1,
        Event::Press { agent, button, .. } => println!("{:>7.2} s {agent:?}: {button}", stamped.time.as_secs_f64()),
        _ => {}
    });

    let session = engine.session();
    let presses = session.presses[Agent::Human.index()];
    let errors = engine.judged().iter().filter(|press| press.verdict.error).count();
    println!("{presses} presses of the human, {errors} errors, {} orders served", session.served.len());
    println!("{samples} gaze samples");
    assert_eq!(session.all_presses(), 60);
    assert_eq!(engine.judged().len(), presses as usize);
    Ok(())
}
