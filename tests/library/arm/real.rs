//! Sessions with a real arm, of which the engine knows only reports: here from a list, with no arm anywhere.

use std::net::{IpAddr, Ipv4Addr};

use tomcom_core::robot::{AbortReason, ArmPhase, ArmSample, ArmStage, SafetyMode};

use crate::support::*;

const REAL: ArmKind = ArmKind::Ur(IpAddr::V4(Ipv4Addr::LOCALHOST));

fn setup(seed: u64) -> SessionSetup {
    let mut files = session_file("default");
    let spec = &mut files.spec;
    (spec.participant.kind, spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    (spec.robot.arm, spec.assistant.shadow, spec.seed) = (REAL, ShadowMode::Off, seed);
    files
}

fn stage(stage: ArmStage) -> Event {
    Event::RobotStage { stage, found: String::new() }
}

fn moves(phase: ArmPhase) -> Event {
    Event::RobotMoves(ArmSample { phase, ..ArmSample::default() })
}

fn safety(mode: SafetyMode) -> Event {
    Event::RobotSafety { mode, force_n: None, joint: None }
}

/// Gives the engine an event a second after the last; what follows from it.
fn input(engine: &mut SessionEngine, event: Event) -> Vec<Event> {
    let outcome = engine.input(engine.session().time + at(1.0), event);
    assert_eq!(outcome.refused, None);
    outcome.events.into_iter().map(|stamped| stamped.event).collect()
}

fn set_out(events: &[Event]) -> Option<String> {
    let of = |event: &Event| if let Event::RobotIntends { button, .. } = event { Some(button.clone()) } else { None };
    events.iter().find_map(of)
}

fn aborts(events: &[Event]) -> Option<AbortReason> {
    let of = |event: &Event| if let Event::RobotAborts { reason, .. } = event { Some(*reason) } else { None };
    events.iter().find_map(of)
}

fn press(button: String) -> Event {
    Event::Press { agent: Agent::Robot, button, at_ns: None, button_box: false }
}

/// An engine whose arm is on its way to a button, and the button.
fn on_the_way() -> (SessionEngine, String) {
    let mut engine = engine_of(setup(1), 0);
    input(&mut engine, Event::TrialStarted);
    let button = set_out(&input(&mut engine, stage(ArmStage::Ready))).expect("something to do");
    (engine, button)
}

#[test]
fn nothing_is_pressed_unless_it_is_reported() {
    let mut engine = engine_of(setup(1), 0);
    assert_eq!(set_out(&input(&mut engine, Event::TrialStarted)), None, "the arm is not ready");
    let button = set_out(&input(&mut engine, stage(ArmStage::Ready))).expect("something to do");
    let order = engine.arm_order().expect("a real arm");
    assert!(order.button.is_some() && !order.may_press && !order.stands);
    let late = engine.input(at(100.0), moves(ArmPhase::Travels)).events;
    assert!(!late.iter().any(|stamped| matches!(stamped.event, Event::Press { agent: Agent::Robot, .. })));
    assert_eq!(engine.arm_order(), Some(order));
    input(&mut engine, moves(ArmPhase::Hovers));
    assert!(engine.arm_order().expect("a real arm").may_press, "it is still useful");
    let events = input(&mut engine, press(button));
    assert_eq!(engine.session().presses[Agent::Robot.index()], 1);
    let next = engine.arm_order().expect("a real arm");
    assert!(set_out(&events).is_none() || next.number == order.number + 1 && !next.may_press);
}

#[test]
fn the_wizard_holds_it_skips_its_press_and_stops_it() {
    let by = Sender::Wizard;
    let (mut engine, _) = on_the_way();
    input(&mut engine, Event::RobotHeld { by });
    input(&mut engine, moves(ArmPhase::Hovers));
    assert!(!engine.arm_order().expect("a real arm").may_press);
    input(&mut engine, Event::RobotReleased { by });
    let order = engine.arm_order().expect("a real arm");
    assert!(order.may_press);
    assert_eq!(aborts(&input(&mut engine, Event::RobotSkipped { by })), Some(AbortReason::Skipped));
    assert_ne!(engine.arm_order().expect("a real arm").number.max(1), 0);
    assert!(!engine.arm_order().expect("a real arm").may_press);

    let (mut engine, _) = on_the_way();
    input(&mut engine, Event::TrialPaused);
    assert!(engine.arm_order().expect("a real arm").stands);
    input(&mut engine, Event::TrialResumed);
    assert!(!engine.arm_order().expect("a real arm").stands);
    assert_eq!(aborts(&input(&mut engine, Event::RobotStopped)), Some(AbortReason::Stopped));
    let order = engine.arm_order().expect("a real arm");
    assert!(order.stands && order.button.is_none());
    assert!(set_out(&input(&mut engine, Event::RobotResumed)).is_some());
    input(&mut engine, Event::TrialEnded { reason: TrialEndReason::Wizard });
    assert!(engine.arm_order().expect("a real arm").stands);
}

#[test]
fn what_stops_the_arm_stops_the_robot_until_wizard_and_arm_are_ready() {
    for (stop, go) in [
        (vec![safety(SafetyMode::ProtectiveStop), stage(ArmStage::Stopped)], vec![safety(SafetyMode::Normal)]),
        (vec![stage(ArmStage::Lost)], vec![]),
        (vec![safety(SafetyMode::EmergencyStop), stage(ArmStage::Off)], vec![safety(SafetyMode::Normal)]),
    ] {
        let (mut engine, _) = on_the_way();
        let events: Vec<Event> = stop.into_iter().flat_map(|event| input(&mut engine, event)).collect();
        assert_eq!(aborts(&events), Some(AbortReason::Stopped));
        assert!(engine.session().robot.stopped && !engine.session().robot.is_stopped_by_wizard());
        assert_eq!(set_out(&input(&mut engine, Event::RobotResumed)), None, "the arm is not ready yet");
        for event in [vec![stage(ArmStage::Starts)], go].concat() {
            assert_eq!(set_out(&input(&mut engine, event)), None);
        }
        assert!(set_out(&input(&mut engine, stage(ArmStage::Ready))).is_some());
    }
    // A hand in the way is waited for.
    let (mut engine, button) = on_the_way();
    assert_eq!(aborts(&input(&mut engine, safety(SafetyMode::Safeguard))), None);
    input(&mut engine, safety(SafetyMode::Normal));
    input(&mut engine, moves(ArmPhase::Hovers));
    input(&mut engine, press(button));
    assert_eq!(engine.session().presses[Agent::Robot.index()], 1);
}

#[test]
fn a_press_that_fails_is_left_out_for_a_while() {
    let (mut engine, button) = on_the_way();
    input(&mut engine, moves(ArmPhase::Hovers));
    let events = input(&mut engine, Event::RobotAborts { button: button.clone(), reason: AbortReason::NoClick });
    assert_ne!(set_out(&events), Some(button), "it is not tried again at once");
    assert!(engine.session().robot.gave_up.is_some() || set_out(&events).is_some());
}

#[test]
fn steps_are_confirmed_in_the_stage_that_asks_for_them() {
    let mut engine = engine_of(setup(1), 0);
    let refused = |engine: &mut SessionEngine, stage| {
        let time = engine.session().time;
        engine.input(time, Event::RobotConfirmed { stage }).refused.is_some()
    };
    assert!(refused(&mut engine, ArmStage::Off), "nothing was reported");
    input(&mut engine, stage(ArmStage::Off));
    assert!(refused(&mut engine, ArmStage::Tried));
    input(&mut engine, Event::RobotConfirmed { stage: ArmStage::Off });
    input(&mut engine, stage(ArmStage::Ready));
    assert!(refused(&mut engine, ArmStage::Ready));
    let mut timed = setup(1);
    timed.spec.robot.arm = ArmKind::Timed;
    assert!(engine_of(timed, 0).input(at(1.0), stage(ArmStage::Off)).refused.is_some());
}

/// Whatever an arm may report, in any order.
fn anything(kitchen: &Kitchen, random: &mut impl RngExt) -> Event {
    let buttons = &kitchen.buttons[Agent::Robot.index()];
    let button = buttons[random.random_range(0..buttons.len())].name.clone();
    let phases = [ArmPhase::Travels, ArmPhase::Hovers, ArmPhase::Presses, ArmPhase::Retracts, ArmPhase::Rests];
    match random.random_range(0..24) {
        0 => stage([ArmStage::Lost, ArmStage::Off, ArmStage::Stopped][random.random_range(0..3)]),
        1 | 2 => stage(ArmStage::Ready),
        3 => safety([SafetyMode::ProtectiveStop, SafetyMode::Safeguard][random.random_range(0..2)]),
        4 | 5 => safety(SafetyMode::Normal),
        6..9 => Event::RobotResumed,
        9 => Event::RobotAborts { button, reason: AbortReason::NoClick },
        10 => Event::RobotHeld { by: Sender::Wizard },
        11 | 12 => Event::RobotReleased { by: Sender::Wizard },
        13 => {
            let human = &kitchen.buttons[Agent::Human.index()];
            let button = human[random.random_range(0..human.len())].name.clone();
            Event::Press { agent: Agent::Human, button, at_ns: None, button_box: false }
        }
        14 => Event::RobotStopped,
        15 | 16 => press(button),
        _ => moves(phases[random.random_range(0..phases.len())]),
    }
}

#[test]
fn its_recordings_verify_without_an_arm() {
    for seed in 1..4 {
        let (mut log, mut engine) = live_recording(setup(seed), 0, &empty_folder(format!("arm/real-{seed}")));
        let kitchen = engine.session().kitchen.clone();
        let mut random = stream(seed, "real arm", 0);
        let mut inputs = vec![Event::TrialStarted, stage(ArmStage::Ready)];
        inputs.extend((0..1500).map(|_| anything(&kitchen, &mut random)));
        inputs.extend([Event::TrialEnded { reason: TrialEndReason::Wizard }, Event::SessionEnded]);
        for event in inputs {
            // What is refused has consequences, too: what was due before.
            let outcome = engine.input(engine.session().time + at(random.random_range(0.0..0.4)), event);
            outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
        }
        assert!(engine.session().presses[Agent::Robot.index()] > 20);
        let text = fs::read_to_string(log.folder().join(LOG_NAME)).expect("a log");
        assert!(text.contains(r#""arm":{"ur":"127.0.0.1"}"#), "{}", &text[..2000]);
        assert!(text.contains("robot_aborts") && text.contains("no_longer_useful"));
        let found = verify(&log.folder().join(LOG_NAME)).expect("a recording");
        assert!(found.verified && !found.cut, "{found:?}");
    }
}
