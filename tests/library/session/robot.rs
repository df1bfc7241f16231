//! The robot stopped, held, skipped and driven, and corrections of the kitchen.

use tomcom::communication::Sender;
use tomcom::kitchen::Agent;
use tomcom::run::engine::SessionEngine;
use tomcom::session::Event;

use super::{check, engine, press, refused};

#[test]
fn a_stopped_robot_gives_up_its_press_and_waits_for_the_wizard() {
    let mut engine = engine(|_| ());
    let started = check(&mut engine, &[(0.0, Event::TrialStarted)]);
    assert!(started.contains(&("robot_intends", 0.0)), "{started:?}");
    let stopped = check(&mut engine, &[(1.0, Event::RobotStopped)]);
    assert_eq!(stopped, [("robot_stopped", 1.0), ("robot_aborts", 1.0)]);
    let waits = check(&mut engine, &[(60.0, Event::Marker { note: String::new() })]);
    assert_eq!(waits, [("marker", 60.0)]);
    let goes_on = check(&mut engine, &[(61.0, Event::RobotResumed)]);
    assert_eq!(goes_on, [("robot_resumed", 61.0), ("robot_intends", 61.0)]);
}

fn by_wizard(event: fn(Sender) -> Event) -> Event {
    event(Sender::Wizard)
}

fn corrected(location: &str, content: &str) -> Event {
    Event::KitchenCorrected { location: location.to_string(), content: content.to_string() }
}

fn driven(button: &str) -> Event {
    Event::RobotDriven { by: Sender::Wizard, button: button.to_string() }
}

/// Lets the session run on to this time; what happened until then.
fn run_on(engine: &mut SessionEngine, seconds: f64) -> Vec<(&'static str, f64)> {
    check(engine, &[(seconds, Event::Marker { note: String::new() })])
}

#[test]
fn a_held_robot_waits_before_its_press_until_it_is_released() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.5, by_wizard(|by| Event::RobotHeld { by }))]);
    assert_eq!(run_on(&mut engine, 60.0), [("marker", 60.0)]);
    assert!(engine.session().robot.held && engine.session().robot.intention.is_some());
    assert!(refused(&mut engine, 60.0, by_wizard(|by| Event::RobotHeld { by })).contains("held already"));
    check(&mut engine, &[(61.0, by_wizard(|by| Event::RobotReleased { by }))]);
    let goes_on = run_on(&mut engine, 61.5);
    assert_eq!(goes_on[0], ("press", 61.0), "it touches as soon as it may: {goes_on:?}");
    assert!(refused(&mut engine, 62.0, by_wizard(|by| Event::RobotReleased { by })).contains("not held"));
    // Held without a press on its way, it sets out for none.
    check(&mut engine, &[(62.0, Event::RobotStopped), (62.1, by_wizard(|by| Event::RobotHeld { by }))]);
    check(&mut engine, &[(62.2, Event::RobotResumed)]);
    assert_eq!(run_on(&mut engine, 80.0), [("marker", 80.0)]);
}

#[test]
fn a_skipped_press_is_given_up_and_not_decided_for_again_at_once() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted)]);
    let kitchen = engine.session().kitchen.clone();
    let intention = |engine: &SessionEngine| engine.session().robot.intention.map(|(button, ..)| button);
    let first = intention(&engine).expect("it sets out at once");
    let kinds = check(&mut engine, &[(0.5, by_wizard(|by| Event::RobotSkipped { by }))]);
    assert_eq!(kinds[..2], [("robot_skipped", 0.5), ("robot_aborts", 0.5)], "{kinds:?}");
    assert_ne!(intention(&engine), Some(first), "{}", kitchen.button(Agent::Robot, first).name);
    // Where only one press helps, the robot waits; a while later it may do that press all the same.
    let mut lonely = self::engine(|_| ());
    check(&mut lonely, &[(0.0, Event::TrialStarted), (0.1, corrected("robot_hand", "crab raw"))]);
    let only = intention(&lonely).expect("what is in the way is thrown away");
    let kinds = check(&mut lonely, &[(0.2, by_wizard(|by| Event::RobotSkipped { by }))]);
    if kinds.iter().any(|(kind, _)| *kind == "robot_idles") {
        assert_eq!(lonely.session().robot.idle, Some(tomcom::robot::IdleReason::Skipped));
        let kinds = run_on(&mut lonely, 5.3);
        assert!(kinds.contains(&("robot_intends", 5.2)), "{kinds:?}");
        assert_eq!(intention(&lonely), Some(only));
    }
    check(&mut lonely, &[(6.0, Event::RobotStopped)]);
    assert!(
        refused(&mut lonely, 6.5, by_wizard(|by| Event::RobotSkipped { by })).contains("not on its way to a press")
    );
}

#[test]
fn a_driven_robot_does_the_press_that_the_wizard_chose_also_while_it_is_held() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.2, by_wizard(|by| Event::RobotHeld { by }))]);
    // Trash with an empty hand has no effect, and is pressed all the same.
    for (seconds, button) in [(0.5, "trash"), (20.0, "take nori")] {
        let kinds = check(&mut engine, &[(seconds, driven(button))]);
        assert_eq!(kinds.last(), Some(&("robot_intends", seconds)), "{kinds:?}");
        assert!(engine.session().robot.driven_to.is_some());
        let kinds = run_on(&mut engine, seconds + 15.0);
        assert_eq!(kinds.iter().filter(|(kind, _)| *kind == "press").count(), 1, "{kinds:?}");
        assert!(engine.session().robot.driven_to.is_none() && engine.session().robot.intention.is_none());
    }
    let hand = engine.session().kitchen.hands[Agent::Robot.index()];
    let nori = engine.session().kitchen.content_named("nori").expect("a content");
    assert_eq!(engine.session().state.content(hand), nori);
    assert!(refused(&mut engine, 40.0, driven("wash")).contains("a button that the agent has"));
    check(&mut engine, &[(41.0, Event::RobotStopped)]);
    assert!(refused(&mut engine, 42.0, driven("trash")).contains("stopped"));
    let assistant = Event::RobotHeld { by: Sender::Assistant };
    assert!(refused(&mut engine, 43.0, assistant).contains("only the wizard"));
}

#[test]
fn a_correction_is_a_change_by_nobody() {
    let mut engine = engine(|_| ());
    assert!(refused(&mut engine, 0.0, corrected("counter", "nori")).contains("during a trial"));
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.1, Event::TrialPaused)]);
    check(&mut engine, &[(0.2, corrected("counter", "nori")), (0.3, Event::TrialResumed)]);
    check(&mut engine, &[(1.0, corrected("counter", "empty")), (1.1, corrected("human_hand", "rice raw"))]);
    assert_eq!(engine.session().presses, [0, 0]);
    let cases = [
        ("human_hand", "rice raw", "the program assumes this content already"),
        ("order_1", "empty", "orders"),
        ("cellar", "nori", "no location with this name"),
        ("counter", "gold", "no content with this name"),
        ("rolling_mat", "salmon raw", "cannot be at this place"),
    ];
    for (location, content, reason) in cases {
        let told = refused(&mut engine, 1.2, corrected(location, content));
        assert!(told.contains(reason), "{location} {content}: {told}");
    }
    // A press at a place that somebody else changed a moment ago is a race; later it is judged.
    check(&mut engine, &[(1.3, press("take rice"))]);
    assert!(engine.judged()[0].verdict.race, "{:?}", engine.judged());
    check(&mut engine, &[(2.0, press("take rice"))]);
    assert!(!engine.judged()[1].verdict.race && engine.judged()[1].verdict.error);
}

#[test]
fn a_robot_whose_press_became_useless_by_a_correction_decides_anew() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted)]);
    let kinds = check(&mut engine, &[(0.5, corrected("robot_hand", "nori"))]);
    assert_eq!(kinds, [("kitchen_corrected", 0.5), ("robot_aborts", 0.5), ("robot_intends", 0.5)]);
}
