//! Advice: when the assistant is asked, what becomes of its signals as offers, and of the proposals of DEV.

use tomcom_core::communication::offer::OfferCloseReason;
use tomcom_core::communication::recommendation::{HumanPressProposal, Recommendation, SignalOption};
use tomcom_devices::sight::sight;
use tomcom_session::event::WizardScreenContent;
use tomcom_session::offers;

use super::{at, check, corrected, engine, mark, press, refused};
use crate::support::*;

/// A running trial with an assistant whose advice the test gives.
fn advised(change: impl Fn(&mut SessionSpec)) -> SessionEngine {
    let mut engine = engine(|spec| {
        (spec.trial.condition, spec.assistant.shadow) = (Condition::Wizard, ShadowMode::On);
        spec.console.visibility = WizardVisibility::Recommendation;
        change(spec);
    });
    check(&mut engine, &[(0.0, Event::TrialStarted)]);
    engine
}

fn highlight(place: &str) -> Signal {
    Signal::Highlight(place.to_string())
}

fn recipe(order: &str) -> Signal {
    Signal::ShowRecipe(order.to_string())
}

/// Advice with these net benefits.
fn nets(seconds: f64, nets: &[(Signal, f64)]) -> (f64, Event) {
    let mut options: Vec<SignalOption> = nets
        .iter()
        .map(|(signal, net)| SignalOption {
            signal: signal.clone(),
            benefit: net + 1.5,
            standard_error: 0.1,
            net: *net,
            rollouts: 64,
        })
        .collect();
    options.sort_by(|a, b| b.net.total_cmp(&a.net));
    let best = options.first().filter(|option| option.net > 0.0).map(|option| option.signal.clone());
    (seconds, Event::Advised(Recommendation { options, best, ..Recommendation::silent(0, at(seconds)) }))
}

fn pot(seconds: f64, net: f64) -> (f64, Event) {
    nets(seconds, &[(highlight("cooking_pot"), net)])
}

fn marker(seconds: f64) -> (f64, Event) {
    (seconds, mark())
}

fn sent(seconds: f64, signal: Signal) -> (f64, Event) {
    (seconds, Event::SignalShown { by: Sender::Wizard, signal, offer: None })
}

/// Gives the inputs; the changes of offers with their seconds.
fn changes(engine: &mut SessionEngine, inputs: &[(f64, Event)]) -> Vec<(String, f64)> {
    let mut changes = Vec::new();
    for (seconds, event) in inputs {
        let outcome = engine.input(at(*seconds), event.clone());
        assert_eq!(outcome.refused, None, "{event:?} at {seconds}");
        for stamped in outcome.events {
            let what = match &stamped.event {
                Event::OfferOpened(_) => engine.session().offers.find(stamped.seq).and_then(|offer| {
                    let signal = offer.signal()?;
                    Some(format!("opens {}", signal.target().expect("a location")))
                }),
                Event::OfferClosed { reason, .. } => Some(reason.name().to_string()),
                _ => None,
            };
            changes.extend(what.map(|what| (what, stamped.time.as_secs_f64())));
        }
    }
    changes
}

fn expected(changes: &[(&str, f64)]) -> Vec<(String, f64)> {
    changes.iter().map(|(what, seconds)| (what.to_string(), *seconds)).collect()
}

#[test]
fn an_offer_stands_for_one_and_a_half_seconds_and_then_one_second_passes_before_the_next() {
    let mut engine = advised(|_| ());
    let inputs = [pot(1.0, 1.0), pot(1.2, -2.0), nets(2.6, &[(highlight("counter"), 3.0)]), marker(9.0)];
    let found = changes(&mut engine, &inputs);
    assert_eq!(found, expected(&[("opens cooking_pot", 1.0), ("fell", 2.5), ("opens counter", 3.5)]));
}

#[test]
fn an_offer_closes_only_well_below_zero_or_when_another_is_clearly_better() {
    let other = |seconds, own: f64, other: f64| {
        nets(seconds, &[(highlight("cooking_pot"), own), (highlight("counter"), other)])
    };
    let mut engine = advised(|_| ());
    let held = [pot(1.0, 1.0), pot(3.0, -0.5), other(4.0, 1.0, 1.49), marker(5.0)];
    assert_eq!(changes(&mut engine, &held), expected(&[("opens cooking_pot", 1.0)]));
    let replaced = [other(6.0, 1.0, 1.5), marker(7.5)];
    assert_eq!(changes(&mut engine, &replaced), expected(&[("replaced", 6.0), ("opens counter", 7.0)]));
    assert_eq!(changes(&mut engine, &[other(9.0, -2.0, -0.51)]), expected(&[("fell", 9.0)]));
    assert_eq!(changes(&mut engine, &[pot(11.0, 0.0), marker(12.0)]), [], "0 is not above 0");
}

#[test]
fn the_thresholds_of_tom_are_probabilities() {
    let mut engine = advised(|spec| spec.assistant.concept = ConceptName::Tom.into());
    let inputs = [pot(1.0, 0.3), pot(3.0, -0.1), pot(4.0, -0.11)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens cooking_pot", 1.0), ("fell", 4.0)]));
}

#[test]
fn dev_offers_presses_that_cannot_be_sent() {
    let proposes = |seconds, presses: &[&str]| {
        let presses: Vec<String> = presses.iter().map(|press| press.to_string()).collect();
        let proposal = (!presses.is_empty()).then_some(HumanPressProposal { error: 0, presses });
        (seconds, Event::Advised(Recommendation { proposal, ..Recommendation::silent(0, at(seconds)) }))
    };
    let mut engine = advised(|spec| spec.assistant.concept = ConceptName::Dev.into());
    changes(&mut engine, &[proposes(1.0, &["cook"]), proposes(1.1, &[])]);
    assert!(offers::enter(engine.session(), at(2.0)).expect_err("no signal").contains("cannot be sent"));
    assert_eq!(changes(&mut engine, &[marker(4.0)]), expected(&[("fell", 2.5)]));
    changes(&mut engine, &[proposes(5.0, &["cook"])]);
    assert_eq!(changes(&mut engine, &[proposes(7.0, &["cut"])]), expected(&[("replaced", 7.0)]));
}

#[test]
fn nothing_opens_during_the_cool_down_between_signals() {
    let mut engine = advised(|_| ());
    let inputs = [sent(1.0, highlight("counter")), pot(1.1, 1.0), marker(2.0)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens cooking_pot", 1.5)]));
}

#[test]
fn a_pause_stops_the_clock_of_an_offer() {
    let mut engine = advised(|_| ());
    let inputs = [pot(1.0, 1.0), pot(1.2, -2.0), (2.0, Event::TrialPaused), (12.0, Event::TrialResumed), marker(20.0)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens cooking_pot", 1.0), ("fell", 12.5)]));
}

#[test]
fn an_offer_that_became_impossible_closes_at_once_and_so_does_one_at_the_end_of_the_trial() {
    let mut engine = advised(|_| ());
    let cleared = Event::OrderCleared { order: "order_1".to_string() };
    let inputs = [nets(1.0, &[(recipe("order_1"), 2.0)]), (1.3, cleared)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens order_1", 1.0), ("impossible", 1.3)]));
    let ended = Event::TrialEnded { reason: tomcom_session::event::TrialEndReason::Wizard };
    let inputs = [pot(2.0, 1.0), marker(2.4), (2.6, ended)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens cooking_pot", 2.3), ("trial_ended", 2.6)]));
}

#[test]
fn of_two_orders_of_one_dish_the_older_one_is_offered() {
    let order = |engine: &SessionEngine, name: &str| {
        let session = engine.session();
        session.state.order(session.kitchen.location_named(name).expect("an order"))
    };
    let both =
        |seconds, first: f64, second: f64| nets(seconds, &[(recipe("order_1"), first), (recipe("order_2"), second)]);
    let started = |seed| advised(|spec| spec.seed = seed);
    let is_same = |engine: &SessionEngine| order(engine, "order_1") == order(engine, "order_2");
    let mut engine = (1..200).map(started).find(is_same).expect("a seed with two orders of one dish");
    assert!(matches!(order(&engine, "order_1"), OrderContent::Dish(_)));
    let inputs = [both(1.0, 0.5, 2.0), both(4.0, 0.5, 2.0), both(5.0, 2.0, 0.5)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens order_1", 1.0)]), "they do not swap");
    // Where only the younger one is worth its cost, it is offered.
    let inputs = [both(6.0, -0.1, 2.0), marker(7.5)];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("replaced", 6.0), ("opens order_2", 7.0)]));
    let mut engine = (1..200).map(started).find(|engine| !is_same(engine)).expect("a seed with two dishes");
    assert_eq!(changes(&mut engine, &[both(1.0, 0.5, 2.0)]), expected(&[("opens order_2", 1.0)]));
}

#[test]
fn enter_means_what_was_read() {
    let target = |engine: &SessionEngine, seconds: f64| {
        let meant = offers::enter(engine.session(), at(seconds)).map(|(offer, event)| {
            assert!(matches!(&event, Event::SignalShown { offer: Some(seq), .. } if *seq == offer.seq));
            offer.signal().and_then(Signal::target).expect("a location").to_string()
        });
        meant.unwrap_or_else(|reason| reason)
    };
    let mut engine = advised(|_| ());
    assert_eq!(target(&engine, 0.5), "no signal is on offer");
    changes(&mut engine, &[pot(1.0, 1.0)]);
    assert!(target(&engine, 1.2).contains("just appeared"), "nobody has read it");
    assert_eq!(target(&engine, 1.3), "cooking_pot");
    let other = nets(4.0, &[(highlight("counter"), 2.0), (highlight("cooking_pot"), 1.0)]);
    changes(&mut engine, &[other]);
    assert_eq!(target(&engine, 4.9), "cooking_pot", "it closed a moment ago");
    changes(&mut engine, &[marker(5.1)]);
    assert_eq!(engine.session().offers.open().and_then(|offer| offer.signal()), Some(&highlight("counter")));
    assert_eq!(target(&engine, 5.25), "cooking_pot", "the new one cannot have been read");
    assert_eq!(target(&engine, 5.3), "counter");
    changes(&mut engine, &[pot(7.0, -3.0), nets(7.1, &[(highlight("counter"), -3.0)])]);
    assert_eq!(target(&engine, 8.4), "counter");
    assert_eq!(target(&engine, 8.5), "no signal is on offer", "too long ago");
}

#[test]
fn a_taken_offer_is_named_by_its_signal_and_is_not_sent_twice() {
    let mut engine = advised(|_| ());
    changes(&mut engine, &[pot(1.0, 1.0)]);
    let (seq, event) = offers::enter(engine.session(), at(1.8)).map(|(offer, event)| (offer.seq, event)).expect("one");
    assert_eq!(changes(&mut engine, &[(1.8, event.clone())]), expected(&[("taken", 1.8)]));
    let refused = offers::enter(engine.session(), at(2.5)).expect_err("it was sent");
    assert_eq!(refused, "the signal on offer was sent already");
    let last = engine.session().offers.last().expect("it closed");
    assert_eq!((last.offer.seq, last.reason), (seq, OfferCloseReason::Taken));
    let again = engine.input(at(8.0), event);
    assert_eq!(again.refused, None, "it is the last offer still");
    let mut unknown = advised(|_| ());
    let (signal, by) = (highlight("counter"), Sender::Wizard);
    let refused = unknown.input(at(1.0), Event::SignalShown { by, signal, offer: Some(3) }).refused;
    assert_eq!(refused.as_deref(), Some("the event names an offer that was not the last one"));
}

#[test]
fn other_keys_mean_themselves_and_the_signals_own_key_closes_the_offer_as_such() {
    let mut engine = advised(|_| ());
    let inputs = [pot(1.0, 1.0), sent(1.5, highlight("counter")), sent(2.5, highlight("cooking_pot"))];
    assert_eq!(changes(&mut engine, &inputs), expected(&[("opens cooking_pot", 1.0), ("own_key", 2.5)]));
}

#[test]
fn during_the_cool_down_enter_says_why_it_sends_nothing() {
    let mut engine = advised(|_| ());
    changes(&mut engine, &[pot(1.0, 1.0), sent(1.5, highlight("counter"))]);
    let reason = offers::enter(engine.session(), at(1.7)).expect_err("too soon");
    assert!(reason.starts_with("too soon"), "{reason}");
    assert!(offers::enter(engine.session(), at(2.1)).is_ok());
}

#[test]
fn whether_a_wizard_could_see_an_offer_is_recorded() {
    let visible = |visibility, has_console: bool| {
        let mut engine = advised(|spec| spec.console.visibility = visibility);
        if has_console {
            let (room, panels, dialog) = ("medium".to_string(), Vec::new(), None);
            check(&mut engine, &[(0.5, Event::Screen(WizardScreenContent { visibility, room, panels, dialog }))]);
        }
        changes(&mut engine, &[pot(1.0, 1.0)]);
        engine.session().offers.open().expect("it opens all the same").advice.visible
    };
    assert!(visible(WizardVisibility::Recommendation, true));
    assert!(!visible(WizardVisibility::Recommendation, false), "nothing draws it");
    assert!(!visible(WizardVisibility::State, true), "it is not shown in this session");
}

#[test]
fn an_assistant_that_acts_makes_no_offers() {
    let mut acting = advised(|spec| spec.trial.condition = Condition::Assistant);
    assert_eq!(changes(&mut acting, &[pot(1.0, 1.0), marker(9.0)]), []);
}

fn dev(spec: &mut SessionSpec) {
    spec.trial.condition = Condition::Assistant;
    spec.assistant.concept = ConceptName::Dev.into();
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
    let again = with_advice(&mut engine, 1.5, corrected("counter", "tuna raw"));
    let proposes = |event: &Event| matches!(event, Event::Advised(advice) if advice.proposal.is_some());
    assert!(again.iter().any(proposes), "{again:?}");
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
    let full = corrected("human_hand", "tuna raw");
    let presses = proposed(&engine).expect("a proposal");
    assert!(presses[0].starts_with("take "), "{presses:?}");
    assert_eq!(ends(&with_advice(&mut engine, 2.0, full)), [SignalEndReason::Outdated]);

    let (mut engine, _) = after_an_error(|_| ());
    assert_eq!(ends(&with_advice(&mut engine, 6.0, mark())), [SignalEndReason::Elapsed]);
}

#[test]
fn only_the_assistant_of_dev_proposes() {
    let propose =
        |by, press: &str| Event::SignalShown { by, signal: Signal::Propose(vec![press.to_string()]), offer: None };
    let (mut engine, _) = after_an_error(dev);
    assert!(refused(&mut engine, 2.0, propose(Sender::Wizard, "take rice")).contains("assistant"));
    assert!(refused(&mut engine, 2.0, propose(Sender::Assistant, "trash")).contains("do nothing"));
    assert!(refused(&mut engine, 2.0, propose(Sender::Assistant, "dance")).contains("no such button"));
    let (mut other, _) = after_an_error(|spec| spec.assistant.concept = ConceptName::Tom.into());
    assert!(refused(&mut other, 2.0, propose(Sender::Assistant, "take rice")).contains("only DEV"));
}

/// An estimate of a session with proposals is that of the same session without them, until a proposed press is made.
#[test]
fn a_proposal_on_the_display_teaches_the_estimate_nothing() {
    let [(with, _), (without, _)] = [ConceptName::Dev, ConceptName::None]
        .map(|concept| after_an_error(|spec| spec.assistant.concept = concept.into()));
    assert!(proposed(&with).is_some() && without.session().shown.is_none());
    assert_eq!(with.belief(), without.belief());
}

/// A trial with presses in these intervals; the time of the last.
fn pressed(engine: &mut SessionEngine, intervals_s: &[f64]) -> (Vec<(&'static str, f64)>, f64) {
    let mut inputs = vec![(0.0, Event::TrialStarted)];
    let mut now_s = 0.0;
    for interval_s in [2.0].iter().chain(intervals_s) {
        now_s += interval_s;
        inputs.push((now_s, press("take rice")));
    }
    (check(engine, &inputs), now_s)
}

fn waits(kinds: &[(&str, f64)]) -> Vec<f64> {
    kinds.iter().filter(|(kind, _)| *kind == "human_waits").map(|(_, seconds)| *seconds).collect()
}

/// The silences after the last press are noted at these seconds since then, and the assistant is asked at each.
fn check_silences(engine: &mut SessionEngine, last_s: f64, until_s: f64, expected_s: &[f64]) {
    engine.take_questions();
    let found = waits(&check(engine, &[marker(last_s + until_s)]));
    assert_eq!(found.len(), expected_s.len(), "{found:?} after {last_s}");
    let asked = engine.take_questions();
    for (found, expected) in found.iter().zip(expected_s) {
        assert!((found - last_s - expected).abs() < 1e-6, "{found} after {last_s}, {expected}");
        assert!(asked.iter().any(|request| request.time == at(*found)), "the assistant is asked then");
    }
}

#[test]
fn a_silence_is_unusual_after_three_usual_intervals_and_again_after_each_three() {
    let mut slow = engine(|_| ());
    let (kinds, last_s) = pressed(&mut slow, &[4.0, 5.0, 3.0, 9.0, 4.5]);
    assert!(waits(&kinds).is_empty(), "{kinds:?}");
    check_silences(&mut slow, last_s, 41.0, &[13.5, 27.0, 40.5]);
}

#[test]
fn a_silence_of_six_seconds_is_unusual_whoever_presses_faster_or_not_at_all() {
    let mut fast = engine(|_| ());
    let (_, last_s) = pressed(&mut fast, &[1.0, 1.2, 0.9]);
    check_silences(&mut fast, last_s, 13.0, &[6.0, 12.0]);
    let mut passive = engine(|_| ());
    check(&mut passive, &[(0.0, Event::TrialStarted)]);
    check_silences(&mut passive, 0.0, 13.0, &[6.0, 12.0]);
}

#[test]
fn a_press_ends_the_silence_and_a_pause_is_none() {
    let mut engine = engine(|_| ());
    let (_, last_s) = pressed(&mut engine, &[1.0, 1.0, 1.0]);
    let kinds = check(&mut engine, &[marker(last_s + 5.0), (last_s + 5.5, press("trash")), marker(last_s + 11.0)]);
    assert!(waits(&kinds).is_empty(), "{kinds:?}");
    let now_s = last_s + 11.0;
    let kinds =
        check(&mut engine, &[(now_s, Event::TrialPaused), (now_s + 10.0, Event::TrialResumed), marker(now_s + 12.0)]);
    let found = waits(&kinds);
    assert!(found.len() == 1 && (found[0] - last_s - 5.5 - 16.0).abs() < 1e-6, "{found:?} after {last_s}");
}

#[test]
fn the_silence_that_is_recorded_is_the_time_since_the_last_press() {
    let mut engine = engine(|_| ());
    let (_, last_s) = pressed(&mut engine, &[1.0]);
    let events = engine.input(at(last_s + 13.0), mark()).events;
    let silences = events.iter().filter_map(|stamped| match stamped.event {
        Event::HumanWaits { silent_ns } => Some(silent_ns),
        _ => None,
    });
    assert_eq!(silences.collect::<Vec<_>>(), [at(6.0), at(12.0)]);
}
