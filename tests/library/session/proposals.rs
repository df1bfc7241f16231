//! DEV as a live arm: an error gets one proposal on the display, until it is out of date.

use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::Agent;
use tomcom_devices::sight::sight;
use tomcom_session::Event;
use tomcom_session::engine::SessionEngine;
use tomcom_session::event::SignalEndReason;
use tomcom_session::settings::{Condition, SessionSpec};

use super::{at, engine, press, refused};

fn dev(spec: &mut SessionSpec) {
    spec.trial.condition = Condition::Assistant;
    spec.assistant.concept = ConceptName::Dev;
}

/// Gives an input, and lets the assistant answer whatever is asked because of it; the events, in order.
fn with_advice(engine: &mut SessionEngine, seconds: f64, event: Event) -> Vec<Event> {
    let mut advisor = engine.advisor();
    let mut events = engine.input(at(seconds), event).events;
    for question in engine.take_questions() {
        let advice = advisor.answer(&question);
        events.extend(engine.input(at(seconds), Event::Advised(advice)).events);
    }
    events.into_iter().map(|stamped| stamped.event).collect()
}

/// A session in which the human has thrown away what an order needs.
fn after_an_error(change: impl Fn(&mut SessionSpec)) -> (SessionEngine, Vec<Event>) {
    let mut engine = engine(|spec| {
        dev(spec);
        change(spec);
    });
    // A robot that stands still changes nothing in between.
    with_advice(&mut engine, 0.0, Event::TrialStarted);
    with_advice(&mut engine, 0.1, Event::RobotStopped);
    with_advice(&mut engine, 0.5, press("take rice"));
    let events = with_advice(&mut engine, 1.0, press("trash"));
    assert!(engine.judged().last().expect("a press").verdict.error, "rice is needed for every dish");
    (engine, events)
}

fn proposed(engine: &SessionEngine) -> Option<Vec<String>> {
    match &engine.session().shown.as_ref()?.signal {
        Signal::Propose(presses) => Some(presses.clone()),
        other => panic!("DEV shows {other:?}"),
    }
}

fn ends(events: &[Event]) -> Vec<SignalEndReason> {
    let reason = |event: &Event| match event {
        Event::SignalEnded { reason } => Some(*reason),
        _ => None,
    };
    events.iter().filter_map(reason).collect()
}

/// What the page is told of the signal.
fn told(engine: &SessionEngine) -> serde_json::Value {
    serde_json::to_value(sight(engine.session())).expect("a sight is JSON")["signal"].clone()
}

#[test]
fn an_error_gets_one_proposal_until_it_is_made() {
    let (mut engine, events) = after_an_error(|_| ());
    let shown: Vec<&Event> = events.iter().filter(|event| matches!(event, Event::SignalShown { .. })).collect();
    let [Event::SignalShown { by: Sender::Assistant, signal: Signal::Propose(presses), offer: None, .. }] = &shown[..]
    else {
        panic!("one proposal of the assistant: {shown:?}");
    };
    assert_eq!(presses.len(), 1);
    let kitchen = engine.session().kitchen.clone();
    let button = kitchen.button_named(Agent::Human, &presses[0]).expect("a button of the human");
    assert_eq!(told(&engine), serde_json::json!({ "next": [button.index()] }));
    // The task changes without a press of the human: the error has had its proposal.
    let corrected = Event::KitchenCorrected { location: "counter".to_string(), content: "tuna raw".to_string() };
    let again = with_advice(&mut engine, 1.5, corrected);
    assert!(
        again.iter().any(|event| matches!(event, Event::Advised(advice) if advice.proposal.is_some())),
        "{again:?}"
    );
    assert!(!again.iter().any(|event| matches!(event, Event::SignalShown { .. })), "{again:?}");
    let followed = with_advice(&mut engine, 2.0, press(&presses[0]));
    assert_eq!((ends(&followed), proposed(&engine)), (vec![SignalEndReason::Outdated], None));
    assert_eq!(told(&engine), serde_json::Value::Null);
    assert!(!engine.judged().last().expect("a press").verdict.error, "a proposed press is a good one");
}

#[test]
fn a_proposal_of_several_presses_is_crossed_off_press_by_press() {
    let (mut engine, _) = after_an_error(|spec| spec.assistant.proposed_presses = 3);
    let presses = proposed(&engine).expect("a proposal");
    assert_eq!(presses.len(), 3);
    for (made, name) in presses.iter().enumerate() {
        let left = told(&engine)["next"].as_array().map(Vec::len);
        assert_eq!(left, Some(3 - made), "{presses:?}");
        let events = with_advice(&mut engine, 2.0 + made as f64 / 2.0, press(name));
        let wanted = if made == 2 { vec![SignalEndReason::Outdated] } else { Vec::new() };
        assert_eq!(ends(&events), wanted, "after {name} of {presses:?}");
    }
}

#[test]
fn a_proposal_ends_by_another_press_by_a_change_that_spoils_it_and_after_its_time() {
    let (mut engine, _) = after_an_error(|spec| spec.assistant.proposed_presses = 2);
    assert_eq!(ends(&with_advice(&mut engine, 2.0, press("counter"))), [SignalEndReason::Outdated]);

    let (mut engine, _) = after_an_error(|_| ());
    // With a full hand nothing can be taken.
    let full = Event::KitchenCorrected { location: "human_hand".to_string(), content: "tuna raw".to_string() };
    let presses = proposed(&engine).expect("a proposal");
    assert!(presses[0].starts_with("take "), "{presses:?}");
    assert_eq!(ends(&with_advice(&mut engine, 2.0, full)), [SignalEndReason::Outdated]);

    let (mut engine, _) = after_an_error(|_| ());
    let marker = Event::Marker { note: "later".to_string() };
    assert_eq!(ends(&with_advice(&mut engine, 6.0, marker)), [SignalEndReason::Elapsed]);
}

#[test]
fn only_the_assistant_of_dev_proposes() {
    let propose =
        |by, press: &str| Event::SignalShown { by, signal: Signal::Propose(vec![press.to_string()]), offer: None };
    let (mut engine, _) = after_an_error(dev);
    assert!(refused(&mut engine, 2.0, propose(Sender::Wizard, "take rice")).contains("assistant"));
    assert!(refused(&mut engine, 2.0, propose(Sender::Assistant, "trash")).contains("do nothing"));
    assert!(refused(&mut engine, 2.0, propose(Sender::Assistant, "dance")).contains("no such button"));
    let (mut other, _) = after_an_error(|spec| spec.assistant.concept = ConceptName::Tom);
    assert!(refused(&mut other, 2.0, propose(Sender::Assistant, "take rice")).contains("only DEV"));
}

/// An estimate of a session with proposals is that of the same session without them, until a proposed press is made.
#[test]
fn a_proposal_on_the_display_teaches_the_estimate_nothing() {
    let [(with, _), (without, _)] =
        [ConceptName::Dev, ConceptName::None].map(|concept| after_an_error(|spec| spec.assistant.concept = concept));
    assert!(proposed(&with).is_some() && without.session().shown.is_none());
    assert_eq!(with.belief(), without.belief());
}
