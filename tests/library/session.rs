//! What a running session does: the trial's clock, pauses, the robot, signals, and the judgement of presses.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::communication::settings::AssistantSpec;
use tomcom::communication::{Sender, Signal};
use tomcom::console::{KeyBindings, KeyMap};
use tomcom::edge::files::read_session;
use tomcom::edge::parse::parse;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{Agent, Kitchen, OrderContent, State};
use tomcom::measures::errors::{PressJudge, PressVerdict};
use tomcom::run::engine::{Engine, InputResult};
use tomcom::session::event::{EndReason, SignalEnd};
use tomcom::session::settings::{ArmKind, Condition, GazeSource, ParticipantKind, RobotSpec, SessionSpec};
use tomcom::session::{Event, Phase};

fn kitchen() -> Arc<Kitchen> {
    Arc::new(read_session(Path::new("sessions/default.toml")).expect("the default session").kitchen.kitchen)
}

/// An engine of the default session with a person at the keyboard and a timed arm, and `change`d settings.
fn engine(change: impl Fn(&mut SessionSpec)) -> Engine {
    let mut spec = read_session(Path::new("sessions/default.toml")).expect("the default session").spec;
    spec.participant.kind = ParticipantKind::Keyboard;
    spec.participant.gaze = GazeSource::None;
    spec.robot.arm = ArmKind::Timed;
    change(&mut spec);
    let kitchen = kitchen();
    Engine::new(kitchen.clone(), spec, 0, CostToGo::new(kitchen))
}

#[test]
fn every_session_file_loads_and_its_keys_are_unambiguous() {
    for entry in std::fs::read_dir("sessions").expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let mut files = read_session(&path).unwrap_or_else(|error| panic!("{error}"));
        files.spec.participant.kind = ParticipantKind::Keyboard;
        KeyBindings::live(&files.kitchen.kitchen, &files.spec, &KeyMap::default())
            .unwrap_or_else(|clash| panic!("{}: {clash}", path.display()));
    }
}

#[test]
fn the_default_session_spells_out_every_default() {
    let path = Path::new("sessions/default.toml");
    let only_layout: SessionSpec = parse(path, "layout = \"../layouts/sushi.toml\"").expect("a session file");
    let spec = read_session(path).expect("the default session").spec;
    // But for the arm, which is timed where nothing is said, as in recordings of before there was another; and for what is
    // fitted to its simulated participant: the human model, and where people look in rollouts.
    let robot = RobotSpec { arm: ArmKind::Timed, ..spec.robot };
    assert_ne!(spec.human, only_layout.human);
    assert_ne!(spec.assistant.rollout, only_layout.assistant.rollout);
    let rollout = only_layout.assistant.rollout.clone();
    let assistant = AssistantSpec { rollout, ..spec.assistant };
    assert_eq!(SessionSpec { human: only_layout.human.clone(), assistant, robot, ..spec }, only_layout);
}

fn at(seconds: f64) -> SessionTime {
    SessionTime::from_secs_f64(seconds)
}

fn press(button: &str) -> Event {
    Event::Press { agent: Agent::Human, button: button.to_string(), at_ns: None }
}

fn highlight(location: &str) -> Event {
    Event::SignalShown { by: Sender::Wizard, signal: Signal::Highlight(location.to_string()), accepted: None }
}

/// Gives the inputs in turn; the kinds of all events with their seconds.
fn check(engine: &mut Engine, inputs: &[(f64, Event)]) -> Vec<(&'static str, f64)> {
    let mut kinds = Vec::new();
    for (seconds, event) in inputs {
        let InputResult { events, refused } = engine.input(at(*seconds), event.clone());
        assert_eq!(refused, None, "{event:?}");
        kinds.extend(events.iter().map(|stamped| (stamped.event.kind(), stamped.time.as_secs_f64())));
    }
    kinds
}

/// Why the input is refused.
fn refused(engine: &mut Engine, seconds: f64, event: Event) -> String {
    engine.input(at(seconds), event).refused.expect("a refusal")
}

#[test]
fn a_trial_ends_after_its_time_and_pauses_do_not_count() {
    let mut engine = engine(|spec| spec.trial.seconds = 10.0);
    check(&mut engine, &[(1.0, Event::TrialStarted), (4.0, Event::TrialPaused), (9.0, Event::TrialResumed)]);
    assert_eq!(engine.session().trial_clock(at(10.0)), at(4.0));
    let kinds = check(&mut engine, &[(30.0, Event::Marker { note: "later".to_string() })]);
    assert!(kinds.contains(&("trial_ended", 16.0)), "{kinds:?}");
    assert_eq!(engine.session().phase, Phase::Over(EndReason::Time));
    assert_eq!(engine.next_due(), None);
}

#[test]
fn a_trial_ends_after_its_number_of_presses_at_once() {
    let mut engine = engine(|spec| spec.trial.presses = 2);
    check(&mut engine, &[(0.0, Event::TrialStarted), (0.5, press("take rice"))]);
    let kinds = check(&mut engine, &[(0.6, press("counter"))]);
    assert_eq!(kinds, [("press", 0.6), ("belief_estimated", 0.6), ("trial_ended", 0.6)]);
}

#[test]
fn presses_before_the_start_and_in_a_pause_are_recorded_and_change_nothing() {
    let mut engine = engine(|_| ());
    let started = [(0.1, press("take rice")), (1.0, Event::TrialStarted), (1.1, Event::TrialPaused)];
    let kinds = check(&mut engine, &started);
    assert_eq!(kinds[0], ("press", 0.1));
    let before = engine.session().state;
    check(&mut engine, &[(1.2, press("take rice"))]);
    assert_eq!((engine.session().state, engine.session().presses), (before, [0, 0]));
    assert!(engine.judged().is_empty());
    check(&mut engine, &[(2.0, Event::TrialResumed), (2.1, press("take rice"))]);
    assert_eq!((engine.session().presses, engine.judged().len()), ([1, 0], 1));
}

#[test]
fn a_pause_postpones_the_arm_the_orders_and_the_signal() {
    let inputs = |pause_s: f64| {
        let mut inputs = vec![(0.0, Event::TrialStarted), (0.2, highlight("counter"))];
        if pause_s > 0.0 {
            inputs.extend([(0.3, Event::TrialPaused), (0.3 + pause_s, Event::TrialResumed)]);
        }
        inputs.push((10.0 + pause_s, Event::Marker { note: String::new() }));
        inputs
    };
    let run = |pause_s: f64| check(&mut engine(|_| ()), &inputs(pause_s));
    let (straight, paused) = (run(0.0), run(64.0));
    let after_pause = |(kind, seconds): &(&'static str, f64)| (*kind, *seconds + 64.0);
    let late: Vec<_> = straight.iter().filter(|(_, seconds)| *seconds > 0.3).map(after_pause).collect();
    assert!(late.iter().any(|(kind, _)| *kind == "signal_ended") && late.iter().any(|(kind, _)| *kind == "press"));
    let seen: Vec<_> = paused.iter().filter(|(_, seconds)| *seconds > 64.5).copied().collect();
    assert_eq!(seen.len(), late.len());
    for (seen, expected) in seen.iter().zip(&late) {
        assert!(seen.0 == expected.0 && (seen.1 - expected.1).abs() < 1e-6, "{seen:?} is not {expected:?}");
    }
}

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

#[test]
fn a_served_order_is_shown_as_served_then_cleared_then_there_is_a_new_one() {
    let mut engine = engine(|spec| spec.trial.seconds = 300.0);
    check(&mut engine, &[(0.0, Event::TrialStarted)]);
    let mut served = None;
    let mut after = Vec::new();
    while engine.session().is_running() {
        // The human's part is played by whatever brings the orders nearer.
        let due = engine.next_due().expect("the trial's end is pending");
        engine.fire().iter().filter(|_| served.is_some()).for_each(|s| after.push((s.event.kind(), s.time)));
        served = served.or(engine.session().served.first().map(|served| served.time));
        let kitchen = engine.session().kitchen.clone();
        let mut cost = CostToGo::new(kitchen.clone());
        if let Some(button) = helpful(&kitchen, &mut cost, engine.session().state)
            && engine.session().is_running()
        {
            let name = kitchen.button(Agent::Human, button).name.clone();
            let outcome = engine.input(due, press(&name));
            served = served.or(engine.session().served.first().map(|served| served.time));
            outcome.events.iter().filter(|_| served.is_some()).for_each(|s| after.push((s.event.kind(), s.time)));
        }
    }
    let served = served.expect("an order is served in five minutes");
    let first = |kind| after.iter().find(|(other, _)| *other == kind).map(|(_, time)| time.secs_since(served));
    assert_eq!((first("order_cleared"), first("order_shown")), (Some(2.0), Some(5.0)));
}

/// A press of the human that brings the orders nearer.
fn helpful(kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<tomcom::kitchen::ButtonId> {
    let recipes = kitchen.true_recipes();
    let here = cost.all_orders(state, &recipes);
    let buttons = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| tomcom::kitchen::ButtonId(index as u8));
    buttons.into_iter().find(|&button| {
        let next = kitchen.press(state, &recipes, Agent::Human, button);
        next.is_some_and(|next| cost.all_orders(next, &recipes) < here)
    })
}

#[test]
fn what_cannot_be_is_refused_with_its_reason() {
    let mut unassisted = engine(|spec| spec.trial.condition = Condition::None);
    check(&mut unassisted, &[(0.0, Event::TrialStarted)]);
    assert!(refused(&mut unassisted, 1.0, highlight("counter")).contains("unassisted"));

    let mut engine = engine(|_| ());
    assert!(refused(&mut engine, 0.0, highlight("counter")).contains("while the trial runs"));
    assert!(refused(&mut engine, 0.0, Event::TrialPaused).contains("no trial runs"));
    check(&mut engine, &[(1.0, Event::TrialStarted), (1.5, highlight("counter"))]);
    assert!(refused(&mut engine, 2.0, highlight("human_hand")).contains("own hand"));
    assert!(refused(&mut engine, 2.0, highlight("order_1")).contains("cannot be highlighted"));
    assert!(refused(&mut engine, 2.0, highlight("cellar")).contains("no such location"));
    assert!(refused(&mut engine, 2.0, press("cellar")).contains("a button that the agent has"));
    assert!(refused(&mut engine, 2.0, Event::TrialStarted).contains("started already"));
    assert!(refused(&mut engine, 2.0, Event::RobotResumed).contains("not stopped"));
    check(&mut engine, &[(2.5, Event::SignalEnded { reason: SignalEnd::TakenBack })]);
    assert!(refused(&mut engine, 3.0, Event::SignalEnded { reason: SignalEnd::TakenBack }).contains("no signal"));
    check(&mut engine, &[(4.0, Event::SessionEnded)]);
    assert!(refused(&mut engine, 5.0, press("take rice")).contains("session is over"));
}

/// The verdict on the human's last press of a list by both agents, one second apart but for the last one, that comes
/// `after_s` after the one before it; orders of these dishes are present.
fn verdict(dishes: &[&str], presses: &[(Agent, &str)], after_s: f64) -> PressVerdict {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut judge = PressJudge::new(kitchen.clone());
    let mut state = kitchen.empty_state();
    for (order, dish) in kitchen.orders.iter().zip(dishes) {
        let dish = kitchen.dishes.iter().position(|known| known.name == *dish).expect("a dish of the menu");
        state.set_order(*order, OrderContent::Dish(tomcom::kitchen::DishId(dish as u8)));
    }
    let mut last = None;
    for (index, (agent, name)) in presses.iter().enumerate() {
        let button = kitchen.button_named(*agent, name).expect("a button");
        let is_last = index + 1 == presses.len();
        let now = at(if is_last { index as f64 - 1.0 + after_s } else { index as f64 });
        let press = kitchen.try_press(state, *agent, button);
        match agent {
            Agent::Robot => judge.others_changed(now, press.before, press.after),
            Agent::Human => last = Some(judge.human_pressed(&mut cost, now, &press)),
        }
        state = press.after;
    }
    last.expect("a press of the human")
}

#[test]
fn errors_are_presses_that_lose_more_than_the_best_one() {
    use Agent::{Human, Robot};
    let good = verdict(&["crab maki"], &[(Human, "take crab")], 1.0);
    assert_eq!(good, PressVerdict { regret: 0, excess: 0, race: false, error: false });
    // The wrong shellfish has to be thrown away.
    let wrong = verdict(&["crab maki"], &[(Human, "take shrimp")], 1.0);
    assert_eq!((wrong.excess, wrong.error), (2, true));
    let nothing_to_cut = verdict(&["crab maki"], &[(Human, "cut")], 1.0);
    assert_eq!((nothing_to_cut.regret, nothing_to_cut.error), (1, true));
    // Without an order no press is better than another.
    assert!(!verdict(&[], &[(Human, "cut")], 1.0).error);
    // The robot was faster at the board by a quarter of a second, or by two.
    let both = [(Human, "take nori"), (Robot, "take nori"), (Robot, "assembly_board"), (Human, "assembly_board")];
    let (race, late) = (verdict(&["crab maki"], &both, 0.25), verdict(&["crab maki"], &both, 2.0));
    assert_eq!((race.race, race.error, late.race, late.error), (true, false, false, true));
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
fn run_on(engine: &mut Engine, seconds: f64) -> Vec<(&'static str, f64)> {
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
    let intention = |engine: &Engine| engine.session().robot.intention.map(|(button, ..)| button);
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
    assert!(refused(&mut lonely, 6.5, by_wizard(|by| Event::RobotSkipped { by })).contains("no press"));
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
        ("human_hand", "rice raw", "what the program thinks"),
        ("order_1", "empty", "orders"),
        ("cellar", "nori", "no such location"),
        ("counter", "gold", "no such content"),
        ("rolling_mat", "salmon raw", "cannot be there"),
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

#[test]
fn an_aborted_trial_is_over_says_why_and_can_be_excluded_and_included() {
    let aborted = || Event::TrialAborted { reason: "technical failure".to_string() };
    let excluded = || Event::TrialExcluded { reason: "interrupted".to_string() };
    let mut engine = engine(|_| ());
    assert!(refused(&mut engine, 0.0, aborted()).contains("no trial to abort"));
    assert!(refused(&mut engine, 0.0, excluded()).contains("no trial to exclude"));
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, excluded()), (2.0, Event::TrialIncluded)]);
    let unexplained = Event::TrialEnded { reason: EndReason::Aborted };
    assert!(refused(&mut engine, 2.5, unexplained).contains("needs a reason"));
    check(&mut engine, &[(3.0, Event::TrialPaused), (4.0, aborted())]);
    assert_eq!(engine.session().phase, Phase::Over(EndReason::Aborted));
    assert_eq!(engine.session().aborted.as_deref(), Some("technical failure"));
    assert_eq!(engine.next_due(), None);
    check(&mut engine, &[(5.0, excluded())]);
    assert!(refused(&mut engine, 6.0, excluded()).contains("excluded already"));
    assert_eq!(engine.session().excluded.as_deref(), Some("interrupted"));
    check(&mut engine, &[(7.0, Event::TrialIncluded)]);
    assert!(refused(&mut engine, 8.0, Event::TrialIncluded).contains("not excluded"));
}

#[test]
fn signals_of_the_wizard_keep_apart_and_a_new_one_replaces_the_shown_one() {
    let mut engine = engine(|spec| spec.signals.cool_down_s = 0.8);
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, highlight("counter"))]);
    assert!(refused(&mut engine, 1.5, highlight("plate")).contains("too soon"));
    assert!(refused(&mut engine, 2.0, highlight("counter")).contains("shown already"));
    check(&mut engine, &[(2.1, highlight("plate"))]);
    let shown = engine.session().shown.as_ref().map(|shown| shown.signal.target().to_string());
    assert_eq!(shown.as_deref(), Some("plate"));
    // Taken back, it may be sent again; so may the one that was replaced.
    check(&mut engine, &[(2.2, Event::SignalEnded { reason: SignalEnd::TakenBack })]);
    assert!(refused(&mut engine, 2.3, highlight("plate")).contains("too soon"));
    check(&mut engine, &[(3.0, highlight("plate")), (4.0, highlight("counter"))]);
}

#[test]
fn presets_of_the_session_file_are_checked() {
    let wrong = |change: fn(&mut SessionSpec)| {
        let mut spec = read_session(Path::new("sessions/default.toml")).expect("the default session").spec;
        change(&mut spec);
        spec.check().expect_err("a wrong setting").key().to_string()
    };
    assert_eq!(wrong(|spec| spec.console.notes.clear()), "notes");
    assert_eq!(wrong(|spec| spec.console.notes.push("a sixth".to_string())), "notes");
    assert_eq!(wrong(|spec| spec.console.notes[0] = "two\nlines".to_string()), "notes");
    assert_eq!(wrong(|spec| spec.console.reasons[0] = "x".repeat(41)), "reasons");
    assert_eq!(wrong(|spec| spec.signals.cool_down_s = -1.0), "cool_down_s");
}
