//! The trial's clock, pauses and orders, and its end.

use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen, State};
use tomcom_session::event::{SignalEndReason, TrialEndReason};
use tomcom_session::settings::Condition;
use tomcom_session::{Event, TrialPhase};

use super::{at, check, engine, press, refused};

fn highlight(location: &str) -> Event {
    Event::SignalShown { by: Sender::Wizard, signal: Signal::Highlight(location.to_string()), offer: None }
}

#[test]
fn a_trial_ends_after_its_time_and_pauses_do_not_count() {
    let mut engine = engine(|spec| spec.trial.seconds = 10.0);
    check(&mut engine, &[(1.0, Event::TrialStarted), (4.0, Event::TrialPaused), (9.0, Event::TrialResumed)]);
    assert_eq!(engine.session().trial_clock(at(10.0)), at(4.0));
    let kinds = check(&mut engine, &[(30.0, Event::Marker { note: "later".to_string() })]);
    assert!(kinds.contains(&("trial_ended", 16.0)), "{kinds:?}");
    assert_eq!(engine.session().phase, TrialPhase::Over(TrialEndReason::Time));
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
fn helpful(kitchen: &Kitchen, cost: &mut CostToGo, state: State) -> Option<tomcom_core::kitchen::ButtonId> {
    let recipes = kitchen.true_recipes();
    let here = cost.all_orders(state, &recipes);
    let buttons =
        (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| tomcom_core::kitchen::ButtonId(index as u8));
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
    assert!(refused(&mut engine, 2.0, highlight("human_hand")).contains("does not highlight"));
    assert!(refused(&mut engine, 2.0, highlight("order_1")).contains("cannot be highlighted"));
    assert!(refused(&mut engine, 2.0, highlight("cellar")).contains("no such location"));
    assert!(refused(&mut engine, 2.0, press("cellar")).contains("a button that the agent has"));
    assert!(refused(&mut engine, 2.0, Event::TrialStarted).contains("started already"));
    assert!(refused(&mut engine, 2.0, Event::RobotResumed).contains("not stopped"));
    check(&mut engine, &[(2.5, Event::SignalEnded { reason: SignalEndReason::TakenBack })]);
    assert!(refused(&mut engine, 3.0, Event::SignalEnded { reason: SignalEndReason::TakenBack }).contains("no signal"));
    check(&mut engine, &[(4.0, Event::SessionEnded)]);
    assert!(refused(&mut engine, 5.0, press("take rice")).contains("session is over"));
}

#[test]
fn an_aborted_trial_is_over_says_why_and_can_be_excluded_and_included() {
    let aborted = || Event::TrialAborted { reason: "technical failure".to_string() };
    let excluded = || Event::TrialExcluded { reason: "interrupted".to_string() };
    let mut engine = engine(|_| ());
    assert!(refused(&mut engine, 0.0, aborted()).contains("no trial runs that could be aborted"));
    assert!(refused(&mut engine, 0.0, excluded()).contains("no trial has begun that could be excluded"));
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, excluded()), (2.0, Event::TrialIncluded)]);
    let unexplained = Event::TrialEnded { reason: TrialEndReason::Aborted };
    assert!(refused(&mut engine, 2.5, unexplained).contains("needs a reason"));
    check(&mut engine, &[(3.0, Event::TrialPaused), (4.0, aborted())]);
    assert_eq!(engine.session().phase, TrialPhase::Over(TrialEndReason::Aborted));
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
    let shown = engine.session().shown.as_ref().and_then(|shown| shown.signal.target().map(str::to_string));
    assert_eq!(shown.as_deref(), Some("plate"));
    // Taken back, it may be sent again; so may the one that was replaced.
    check(&mut engine, &[(2.2, Event::SignalEnded { reason: SignalEndReason::TakenBack })]);
    assert!(refused(&mut engine, 2.3, highlight("plate")).contains("too soon"));
    check(&mut engine, &[(3.0, highlight("plate")), (4.0, highlight("counter"))]);
}

#[test]
fn presses_faster_than_the_sessions_pace_are_recorded_and_do_not_count() {
    let mut engine = engine(|spec| spec.trial.pace_s = Some(8.0));
    check(&mut engine, &[(0.0, Event::TrialStarted), (1.0, press("take rice")), (8.9, press("counter"))]);
    assert_eq!(engine.session().presses[Agent::Human.index()], 1, "7.9 s after the first");
    // A pause is no time to get ready in.
    check(&mut engine, &[(8.95, Event::TrialPaused), (20.0, Event::TrialResumed), (20.01, press("counter"))]);
    assert_eq!(engine.session().presses[Agent::Human.index()], 1, "7.96 s on the trial's clock");
    let kinds = check(&mut engine, &[(20.1, press("counter")), (20.2, press("take rice"))]);
    assert_eq!(engine.session().presses[Agent::Human.index()], 2, "{kinds:?}");
}
