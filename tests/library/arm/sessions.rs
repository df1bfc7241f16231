//! Sessions with the arm: what their events say of it, and how it stops and gives up presses there.

use nalgebra::Point3;
use tomcom_arm::controller::ArmController;
use tomcom_arm::reach::Capsule;
use tomcom_core::robot::AbortReason;
use tomcom_core::robot::SafetyMode;
use tomcom_core::robot::{ArmPhase, ArmSample, JOINTS};

use super::{STILL_RAD, SUSHI};
use crate::support::*;

/// A session at the keyboard, in which nobody presses anything by himself, in this kitchen.
fn session(kitchen: Arc<Kitchen>) -> SessionEngine {
    let mut spec = session_file("default").spec;
    assert_eq!(spec.robot.arm, ArmKind::Physics);
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    spec.assistant.shadow = ShadowMode::Off;
    SessionEngine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen))
}

/// Lets the session go on until such an event, or for so long; everything that happened.
fn until(engine: &mut SessionEngine, at_most_s: f64, is_it: impl Fn(&Event) -> bool) -> Vec<Event> {
    let end = engine.session().time + at(at_most_s);
    let mut seen = Vec::new();
    while engine.next_due().is_some_and(|due| due <= end) {
        seen.extend(engine.fire().into_iter().map(|stamped| stamped.event));
        if seen.iter().any(&is_it) {
            return seen;
        }
    }
    // The time goes by all the same.
    let marked = engine.input(end, Event::Marker { note: String::new(), observer: None }).events;
    seen.extend(marked.into_iter().map(|stamped| stamped.event));
    seen
}

fn arm(engine: &mut SessionEngine) -> &mut ArmController {
    engine.robot().arm().expect("an arm in the physics")
}

fn is_robots_press(event: &Event) -> bool {
    matches!(event, Event::Press { agent: Agent::Robot, .. })
}

fn aborts(events: &[Event]) -> Vec<AbortReason> {
    let reason = |event: &Event| if let Event::RobotAborts { reason, .. } = event { Some(*reason) } else { None };
    events.iter().filter_map(reason).collect()
}

fn modes(events: &[Event]) -> Vec<SafetyMode> {
    let mode = |event: &Event| if let Event::RobotSafety { mode, .. } = event { Some(*mode) } else { None };
    events.iter().filter_map(mode).collect()
}

fn input(engine: &mut SessionEngine, event: Event) -> Vec<Event> {
    let outcome = engine.input(engine.session().time, event);
    assert_eq!(outcome.refused, None);
    outcome.events.into_iter().map(|stamped| stamped.event).collect()
}

/// A session whose trial runs, with its arm on its way.
fn on_its_way() -> SessionEngine {
    let mut engine = session(SUSHI.clone());
    input(&mut engine, Event::TrialStarted);
    until(&mut engine, 10.0, |event| matches!(event, Event::RobotMoves(moment) if moment.phase == ArmPhase::Travels));
    engine
}

#[test]
fn a_session_tells_what_the_arm_does_until_its_press() {
    let mut engine = on_its_way();
    let seen = until(&mut engine, 10.0, is_robots_press);
    let told: Vec<&ArmSample> = seen
        .iter()
        .filter_map(|event| if let Event::RobotMoves(moment) = event { Some(moment) } else { None })
        .collect();
    let time_s = engine.session().time.as_secs_f64();
    assert!((1.0..4.0).contains(&time_s), "{time_s} s");
    assert!(told.len() as f64 <= 14.0 * time_s + 6.0, "{} moments in {time_s} s", told.len());
    assert!(told.iter().any(|moment| moment.phase == ArmPhase::Presses));
    assert_eq!(modes(&seen), [], "nobody is near");
    let felt = until(&mut engine, 1.0, |event| matches!(event, Event::RobotMoves(moment) if moment.force_n > 0.0));
    let force_n = engine.session().robot.arm.last.expect("it was told").1.force_n;
    assert!(!felt.is_empty() && (2.0..30.0).contains(&force_n), "the button was pressed with {force_n} N");
}

/// A stop that the session tells so; then nothing moves or is pressed until the wizard lets the arm go on.
fn check_stop(engine: &mut SessionEngine, seen: &[Event], mode: SafetyMode, reason: AbortReason) {
    assert_eq!(modes(seen).last(), Some(&mode), "{seen:?}");
    assert_eq!(aborts(seen), [reason]);
    assert!(engine.session().robot.stopped);
    until(engine, 1.0, |_| false);
    let there = engine.session().robot.arm.last.expect("it was told").1.joints;
    let meanwhile = until(engine, 30.0, |event| is_robots_press(event) || matches!(event, Event::RobotIntends { .. }));
    assert!(!meanwhile.iter().any(|event| is_robots_press(event) || matches!(event, Event::RobotIntends { .. })));
    let now = arm(engine).joints();
    assert!((0..JOINTS).all(|joint| (now[joint] - there[joint]).abs() < STILL_RAD), "it stays where it is");
    arm(engine).world().fail(None);
    let resumed = input(engine, Event::RobotResumed);
    assert_eq!(modes(&resumed), [SafetyMode::Normal]);
    let after = until(engine, 20.0, is_robots_press);
    assert!(after.iter().any(is_robots_press), "it goes on: {after:?}");
}

#[test]
fn a_session_stops_its_arm_when_it_touches_somebody() {
    let mut engine = on_its_way();
    // Somebody whose hand the arm does not see coming, on the button that it goes for.
    arm(&mut engine).watches_hands = false;
    let board = SUSHI.button_named(Agent::Robot, "assembly_board").expect("a shared button");
    let name = SUSHI.button(Agent::Robot, board).name.clone();
    let pressed = || Event::Press { agent: Agent::Human, button: name.clone(), at_ns: None, button_box: false };
    input(&mut engine, Event::RobotHeld { by: Sender::Wizard });
    input(&mut engine, pressed());
    until(&mut engine, 1.0, |_| false);
    let mut seen = input(&mut engine, Event::RobotDriven { by: Sender::Wizard, button: name.clone() });
    assert_eq!(aborts(&seen), [AbortReason::Driven]);
    seen.clear();
    for _ in 0..5 {
        // So that the hand stays there.
        input(&mut engine, pressed());
        seen.extend(until(&mut engine, 1.0, |event| matches!(event, Event::RobotTouched { .. })));
    }
    input(&mut engine, Event::RobotReleased { by: Sender::Wizard });
    let told = |event: &Event| if let Event::RobotTouched { force_n } = event { Some(*force_n) } else { None };
    let force_n = seen.iter().find_map(told).expect("the contact is told");
    assert!((60.0..150.0).contains(&force_n), "{force_n} N");
    check_stop(&mut engine, &seen, SafetyMode::ProtectiveStop, AbortReason::Contact);
}

#[test]
fn a_session_stops_its_arm_at_the_wizards_key_and_where_a_joint_is_at_fault() {
    let mut engine = on_its_way();
    let seen = input(&mut engine, Event::RobotStopped);
    check_stop(&mut engine, &seen, SafetyMode::EmergencyStop, AbortReason::Stopped);
    let mut engine = on_its_way();
    arm(&mut engine).world().fail(Some(1));
    let seen = until(&mut engine, 2.0, |event| matches!(event, Event::RobotAborts { .. }));
    assert!(seen.iter().any(|event| matches!(event, Event::RobotSafety { joint: Some(2), .. })));
    check_stop(&mut engine, &seen, SafetyMode::Fault, AbortReason::Fault);
}

#[test]
fn the_wizards_key_counts_where_the_arm_has_stopped_by_itself_too() {
    let mut engine = on_its_way();
    arm(&mut engine).world().fail(Some(1));
    until(&mut engine, 2.0, |event| matches!(event, Event::RobotAborts { .. }));
    assert_eq!(modes(&input(&mut engine, Event::RobotStopped)), [SafetyMode::EmergencyStop]);
    let again = engine.input(engine.session().time, Event::RobotStopped);
    assert!(again.refused.is_some(), "it is stopped by the wizard already");
}

/// In a session whose kitchen or arm is changed so, every press is given up for this reason, and tried again later.
fn check_given_up(change: impl Fn(&mut Kitchen), meddle: impl Fn(&mut ArmController), reason: AbortReason) {
    let mut kitchen = Kitchen::clone(&SUSHI);
    change(&mut kitchen);
    let mut engine = session(Arc::new(kitchen));
    meddle(arm(&mut engine));
    let mut seen = input(&mut engine, Event::TrialStarted);
    seen.extend(until(&mut engine, 20.0, is_robots_press));
    let given_up = aborts(&seen);
    assert!(given_up.len() > 3 && given_up.iter().all(|one| *one == reason), "{given_up:?}");
    assert!(!seen.iter().any(is_robots_press));
    assert!(given_up.len() < 40, "what went wrong is left out for a while: {}", given_up.len());
}

#[test]
fn a_press_that_cannot_be_made_is_given_up_for_a_reason() {
    let moved = |at_m: [f64; 2]| {
        move |kitchen: &mut Kitchen| {
            kitchen.buttons[Agent::Robot.index()].iter_mut().for_each(|button| button.at_m = at_m)
        }
    };
    let nothing = |_: &mut ArmController| ();
    check_given_up(moved([1.1, 0.2]), nothing, AbortReason::OutOfReach);
    check_given_up(moved([0.89, 0.0]), nothing, AbortReason::Singular);
    let walled = |arm: &mut ArmController| {
        for button in &SUSHI.buttons[Agent::Robot.index()] {
            let [x, y] = button.at_m;
            let ends_m = [Point3::new(x, y, 0.0), Point3::new(x, y, 0.5)];
            arm.around().obstacles.push(Capsule { ends_m, radius_m: 0.03 });
        }
    };
    check_given_up(|_| (), walled, AbortReason::Obstructed);
    let jammed = |arm: &mut ArmController| {
        (0..SUSHI.buttons[Agent::Robot.index()].len()).for_each(|button| arm.world().jam(button))
    };
    check_given_up(|_| (), jammed, AbortReason::NoClick);
}
