//! The robot stopped, held, skipped and driven, and corrections of the kitchen.

use tomcom_core::robot::IdleReason;
use tomcom_core::robot::policy::own_ways;
use tomcom_people::participant::population::{Population, TraitSpread};
use tomcom_session::apply::silence_so_far;
use tomcom_session::orders::OrderList;
use tomcom_session::{apply, headless};

use super::{at, check, corrected, engine, engine_of_trial, kitchen, mark, press, refused};
use crate::support::*;

#[test]
fn a_stopped_robot_gives_up_its_press_and_waits_for_the_wizard() {
    let mut engine = engine(|_| ());
    let started = check(&mut engine, &[(0.0, Event::TrialStarted)]);
    assert!(started.contains(&("robot_intends", 0.0)), "{started:?}");
    let stopped = check(&mut engine, &[(1.0, Event::RobotStopped)]);
    assert_eq!(stopped, [("robot_stopped", 1.0), ("robot_aborts", 1.0)]);
    assert_eq!(run_on(&mut engine, 60.0), [("marker", 60.0)]);
    let goes_on = check(&mut engine, &[(61.0, Event::RobotResumed)]);
    assert_eq!(goes_on, [("robot_resumed", 61.0), ("robot_intends", 61.0)]);
}

fn driven(button: &str) -> Event {
    Event::RobotDriven { by: Sender::Wizard, button: button.to_string() }
}

/// Lets the session run on to this time; what happened until then, but for the silence of the human.
fn run_on(engine: &mut SessionEngine, seconds: f64) -> Vec<(&'static str, f64)> {
    let mut kinds = check(engine, &[(seconds, mark())]);
    kinds.retain(|(kind, _)| *kind != "human_waits");
    kinds
}

#[test]
fn a_held_robot_waits_before_its_press_until_it_is_released() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.5, Event::RobotHeld { by: Sender::Wizard })]);
    assert_eq!(run_on(&mut engine, 60.0), [("marker", 60.0)]);
    assert!(engine.session().robot.held && engine.session().robot.intention.is_some());
    assert!(refused(&mut engine, 60.0, Event::RobotHeld { by: Sender::Wizard }).contains("held already"));
    check(&mut engine, &[(61.0, Event::RobotReleased { by: Sender::Wizard })]);
    let goes_on = run_on(&mut engine, 61.5);
    assert_eq!(goes_on[0], ("press", 61.0), "it touches as soon as it may: {goes_on:?}");
    assert!(refused(&mut engine, 62.0, Event::RobotReleased { by: Sender::Wizard }).contains("not held"));
    // Held without a press on its way, it sets out for none.
    check(&mut engine, &[(62.0, Event::RobotStopped), (62.1, Event::RobotHeld { by: Sender::Wizard })]);
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
    let kinds = check(&mut engine, &[(0.5, Event::RobotSkipped { by: Sender::Wizard })]);
    assert_eq!(kinds[..2], [("robot_skipped", 0.5), ("robot_aborts", 0.5)], "{kinds:?}");
    assert_ne!(intention(&engine), Some(first), "{}", kitchen.button(Agent::Robot, first).name);
    // Where only one press helps, the robot waits; a while later it may do that press all the same.
    let mut lonely = self::engine(|_| ());
    check(&mut lonely, &[(0.0, Event::TrialStarted), (0.1, corrected("robot_hand", "crab raw"))]);
    let only = intention(&lonely).expect("what is in the way is thrown away");
    let kinds = check(&mut lonely, &[(0.2, Event::RobotSkipped { by: Sender::Wizard })]);
    if kinds.iter().any(|(kind, _)| *kind == "robot_idles") {
        assert_eq!(lonely.session().robot.idle, Some((IdleReason::Skipped, Vec::new())));
        let kinds = run_on(&mut lonely, 5.3);
        assert!(kinds.contains(&("robot_intends", 5.2)), "{kinds:?}");
        assert_eq!(intention(&lonely), Some(only));
    }
    check(&mut lonely, &[(6.0, Event::RobotStopped)]);
    let told = refused(&mut lonely, 6.5, Event::RobotSkipped { by: Sender::Wizard });
    assert!(told.contains("not on its way to a press"), "{told}");
}

#[test]
fn a_driven_robot_does_the_press_that_the_wizard_chose_also_while_it_is_held() {
    let mut engine = engine(|_| ());
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.2, Event::RobotHeld { by: Sender::Wizard })]);
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

/// A trial of a person whose first orders are these.
fn engine_with_orders(arm: ArmKind, initiative_s: f64, dishes: [&str; 2]) -> SessionEngine {
    let kitchen = kitchen();
    let settings = |spec: &mut SessionSpec| (spec.robot.arm, spec.robot.initiative_s) = (arm, initiative_s);
    let spec = engine(settings).session().spec.clone();
    let begins_with = |trial: &u64| {
        let mut orders = OrderList::new(kitchen.dishes.len(), &spec, *trial);
        dishes.iter().all(|dish| kitchen.dish(orders.draw()).name == *dish)
    };
    engine_of_trial((0..10_000).find(begins_with).expect("a trial with these orders"), settings)
}

/// The robot's presses among these events.
fn done(events: &[TimestampedEvent]) -> Vec<String> {
    let pressed = |stamped: &TimestampedEvent| match &stamped.event {
        Event::Press { agent: Agent::Robot, button, .. } => Some(button.clone()),
        _ => None,
    };
    events.iter().filter_map(pressed).collect()
}

/// A trial at a standstill of a recording: no press of the robot lowers the cost to go, and nine would serve an order.
/// The human presses at the trial's start.
fn at_a_standstill(arm: ArmKind, initiative_s: f64) -> SessionEngine {
    let mut engine = engine_with_orders(arm, initiative_s, ["shrimp nigiri", "crab maki"]);
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.0, Event::RobotHeld { by: Sender::Wizard })]);
    let contents = [("assembly_board", "rice shaped + nori"), ("cooking_pot", "shrimp cooked"), ("robot_hand", "nori")];
    check(&mut engine, &contents.map(|(location, content)| (0.0, corrected(location, content))));
    check(&mut engine, &[(0.0, press("trash")), (0.0, Event::RobotReleased { by: Sender::Wizard })]);
    engine
}

#[test]
fn a_robot_whose_human_is_passive_serves_alone_within_40_s() {
    for arm in [ArmKind::Timed, ArmKind::Physics] {
        let mut engine = at_a_standstill(arm, 6.0);
        let (reason, waits_for) = engine.session().robot.idle.clone().expect("it leaves the next press to the human");
        assert_eq!(reason, IdleReason::HumanTurn);
        let pot = engine.session().kitchen.button_named(Agent::Human, "cooking_pot").expect("a button");
        assert!(waits_for.contains(&pot), "the human could take the shrimp: {waits_for:?}");
        let events = engine.input(at(40.0), mark()).events;
        let served = *engine.session().served.first().expect("it serves an order");
        assert_eq!(engine.session().kitchen.dish(served.dish).name, "shrimp nigiri");
        let done = done(&events);
        assert!(["counter", "rolling_mat"].contains(&done[0].as_str()), "{done:?}");
        let rest = "cooking_pot cutting_board cut cutting_board assembly_board assembly_board plate serve";
        assert_eq!(done[1..9].join(" "), format!("{rest} 1"), "{done:?}");
        assert_eq!(engine.session().robot.initiative_presses as usize, done.len(), "each by its own initiative");
    }
}

#[test]
fn the_robot_takes_the_initiative_after_the_set_time_without_a_press_of_the_human() {
    let first_s = |initiative_s: f64, inputs: &[(f64, Event)]| {
        let mut engine = at_a_standstill(ArmKind::Timed, initiative_s);
        let mut kinds = check(&mut engine, inputs);
        kinds.extend(run_on(&mut engine, 60.0));
        kinds.into_iter().find(|(kind, _)| *kind == "robot_intends").map(|(_, seconds)| seconds)
    };
    assert_eq!(first_s(3.0, &[]), Some(3.0));
    assert_eq!(first_s(7.0, &[]), Some(7.0));
    assert_eq!(first_s(86_400.0, &[]), None);
    assert_eq!(first_s(6.0, &[(2.0, press("trash")), (7.0, press("trash"))]), Some(13.0));
    assert_eq!(first_s(6.0, &[(2.0, Event::TrialPaused), (12.0, Event::TrialResumed)]), Some(16.0));
}

/// Share of its idle time in which the robot could have served an order alone, while the human was passive: over trials
/// of simulated people.
fn needless(name: &str, population: Population, (trials, seconds): (u64, f64)) {
    let kitchen = kitchen();
    let (mut needless_s, mut idle_s, mut all_s) = (0.0, 0.0, 0.0);
    for trial in 0..trials {
        let mut engine = engine_of_trial(trial, |spec| {
            (spec.participant.kind, spec.participant.population) =
                (ParticipantKind::Simulated, Some(population.clone()));
            (spec.trial.condition, spec.trial.seconds, spec.trial.presses) = (Condition::None, seconds, 100_000);
            spec.assistant.shadow = ShadowMode::Off;
        })
        .unassisted();
        let mut events = Vec::new();
        headless::run(&mut engine, |stamped| events.push(stamped.clone()));
        let mut cost = CostToGo::new(kitchen.clone());
        let mut session = Session::new(kitchen.clone(), engine.session().spec.clone(), trial);
        let initiative = at(session.spec.robot.initiative_s);
        for stamped in &events {
            let passed_s = stamped.time.secs_since(session.time);
            if session.is_running() {
                all_s += passed_s;
            }
            let waits = matches!(session.robot.idle, Some((IdleReason::HumanTurn, _)));
            if session.is_running() && session.robot.idle.is_some() {
                idle_s += passed_s;
                let recipes = kitchen.true_recipes();
                let is_passive = silence_so_far(&session, session.time) >= initiative;
                let can = |order: &LocationId| own_ways(&kitchen, &mut cost, session.state, &recipes, *order).is_some();
                if passed_s > 0.0 && waits && is_passive && kitchen.orders.iter().any(can) {
                    needless_s += passed_s;
                }
            }
            apply(&mut session, stamped).expect("an event of the session");
        }
    }
    assert!(idle_s > 0.02 * all_s && needless_s < 0.02 * idle_s, "{name}: {needless_s} of {idle_s} s");
}

#[test]
fn the_robot_does_not_idle_while_it_could_serve_a_passive_human_alone() {
    let spread = |median: f64| TraitSpread { median, sigma: 0.1 };
    needless("usual people", Population::default(), (2, 300.0));
    needless("people who press every 60 s", Population { press_s: spread(60.0), ..Population::default() }, (2, 900.0));
    needless("people who get stuck", Population { gets_stuck: spread(0.1), ..Population::default() }, (2, 300.0));
}
