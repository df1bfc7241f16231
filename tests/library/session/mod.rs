//! What a running session does: the trial's clock, pauses, the robot, signals, and the judgement of presses.

mod advice;
mod files;
mod probes;
mod robot;
mod trial;

use tomcom_session::engine::InputResult;

use crate::support::*;

fn kitchen() -> Arc<Kitchen> {
    Arc::new(session_file("default").kitchen.kitchen)
}

/// An engine of the default session with a person at the keyboard and a timed arm, and `change`d settings.
fn engine(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    engine_of_trial(0, change)
}

/// The same for another trial.
fn engine_of_trial(trial: u64, change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    let mut spec = session_file("default").spec;
    spec.participant.kind = ParticipantKind::Keyboard;
    spec.participant.gaze = GazeSource::None;
    spec.robot.arm = ArmKind::Timed;
    change(&mut spec);
    let kitchen = kitchen();
    SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen))
}

fn press(button: &str) -> Event {
    Event::Press { agent: Agent::Human, button: button.to_string(), at_ns: None, button_box: false }
}

fn corrected(location: &str, content: &str) -> Event {
    Event::KitchenCorrected { location: location.to_string(), content: content.to_string() }
}

/// A mark of the wizard, which changes nothing.
fn mark() -> Event {
    Event::Marker { note: String::new(), observer: None }
}

/// Gives the inputs in turn; the kinds of all events with their seconds.
fn check(engine: &mut SessionEngine, inputs: &[(f64, Event)]) -> Vec<(&'static str, f64)> {
    let mut kinds = Vec::new();
    for (seconds, event) in inputs {
        let InputResult { events, refused } = engine.input(at(*seconds), event.clone());
        assert_eq!(refused, None, "{event:?}");
        kinds.extend(events.iter().map(|stamped| (stamped.event.kind(), stamped.time.as_secs_f64())));
    }
    kinds
}

/// Why the input is refused.
fn refused(engine: &mut SessionEngine, seconds: f64, event: Event) -> String {
    engine.input(at(seconds), event).refused.expect("a refusal")
}
