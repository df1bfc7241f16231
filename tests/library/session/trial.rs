//! The trial's clock, pauses, orders and end; which presses are errors, and what orders took.

use tomcom::run::recording_list::{RecordingListDetail, list};
use tomcom_core::measures::JudgedPress;
use tomcom_core::measures::attribution::ErrorCause;
use tomcom_core::measures::errors::{PressJudge, PressVerdict};
use tomcom_session::apply;
use tomcom_session::engine::InputResult;
use tomcom_session::follower::SessionFollower;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::order_needs::{ItemProgress, LastStep, OrderWork};
use tomcom_session::{TimelineEntry, TimelineEvent};
use tomcom_study::analysis::trial_summary::{RegretSum, order_times};

use super::probes::on_request;
use super::{at, check, corrected, engine, kitchen, mark, press, refused};
use crate::support::*;

fn highlight(location: &str) -> Event {
    Event::SignalShown { by: Sender::Wizard, signal: Signal::Highlight(location.to_string()), offer: None }
}

#[test]
fn a_trial_ends_after_its_time_and_pauses_do_not_count() {
    let mut engine = engine(|spec| spec.trial.seconds = 10.0);
    check(&mut engine, &[(1.0, Event::TrialStarted), (4.0, Event::TrialPaused), (9.0, Event::TrialResumed)]);
    assert_eq!(engine.session().trial_clock(at(10.0)), at(4.0));
    let kinds = check(&mut engine, &[(30.0, mark())]);
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
        inputs.push((10.0 + pause_s, mark()));
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
        if let Some((_, name)) = helpful(&kitchen, &mut cost, engine.session().state, &[Agent::Human])
            && engine.session().is_running()
        {
            let outcome = engine.input(due, press(&name));
            served = served.or(engine.session().served.first().map(|served| served.time));
            outcome.events.iter().filter(|_| served.is_some()).for_each(|s| after.push((s.event.kind(), s.time)));
        }
    }
    let served = served.expect("an order is served in five minutes");
    let first = |kind| after.iter().find(|(other, _)| *other == kind).map(|(_, time)| time.secs_since(served));
    assert_eq!((first("order_cleared"), first("order_shown")), (Some(2.0), Some(5.0)));
}

/// A press of one of these agents that brings the orders nearer.
fn helpful(kitchen: &Kitchen, cost: &mut CostToGo, state: State, agents: &[Agent]) -> Option<(Agent, String)> {
    let recipes = kitchen.true_recipes();
    let here = cost.all_orders(state, &recipes);
    let buttons = |&agent: &Agent| (0..kitchen.buttons[agent.index()].len()).map(move |index| (agent, index));
    let mut presses = agents.iter().flat_map(buttons).map(|(agent, index)| (agent, ButtonId(index as u8)));
    let (agent, button) = presses.find(|&(agent, button)| {
        let after = kitchen.press(state, &recipes, agent, button);
        after.is_some_and(|after| cost.all_orders(after, &recipes) < here)
    })?;
    Some((agent, kitchen.button(agent, button).name.clone()))
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

/// The verdict on the human's last press of a list by both agents, one second apart but for the last one, that comes
/// `after_s` after the one before it; orders of these dishes are present. With the session in which it was made.
fn judged(dishes: &[&str], presses: &[(Agent, &str)], after_s: f64) -> (JudgedPress, Session) {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let mut judge = PressJudge::new(kitchen.clone());
    let mut state = kitchen.empty_state();
    for (order, dish) in kitchen.orders.iter().zip(dishes) {
        state.set_order(*order, OrderContent::Dish(kitchen.dish_named(dish).expect("a dish of the menu")));
    }
    let mut session = Session::new(kitchen.clone(), default_settings(), 0);
    let mut last = None;
    for (index, (agent, name)) in presses.iter().enumerate() {
        let button = kitchen.button_named(*agent, name).expect("a button");
        let is_last = index + 1 == presses.len();
        let time = at(if is_last { index as f64 - 1.0 + after_s } else { index as f64 });
        let press = kitchen.try_press(state, *agent, button);
        match agent {
            Agent::Robot => judge.others_changed(time, press.before, press.after),
            Agent::Human => {
                let (seq, before, verdict) = (index as u64, state, judge.human_pressed(&mut cost, time, &press));
                last = Some(JudgedPress { seq, time, button, before, verdict, belief_known: false, cause: None });
            }
        }
        let (before, after) = (press.before, press.after);
        let no_effect = kitchen.no_effect(before, *agent, button);
        let what = TimelineEvent::Press { agent: *agent, button, before, after, no_effect };
        session.timeline.push(TimelineEntry { time, what });
        state = after;
    }
    (last.expect("a press of the human"), session)
}

fn verdict(dishes: &[&str], presses: &[(Agent, &str)], after_s: f64) -> PressVerdict {
    judged(dishes, presses, after_s).0.verdict
}

#[test]
fn an_error_is_explained_by_what_the_orders_need() {
    use Agent::{Human, Robot};
    let check = |dishes: &[&str], presses: &[(Agent, &str)], why: &str| {
        let (press, session) = judged(dishes, presses, 5.0);
        assert!(press.verdict.error, "{presses:?} is no error: {:?}", press.verdict);
        let explained = ExplainedError::among(&session, &[press]);
        assert_eq!(explained[0].why, why, "{presses:?}");
        let cost = format!("; costs {} press", press.verdict.excess);
        let told = explained[0].told_without_press(None);
        assert!(told.starts_with(&format!("{why}{cost}")), "{told}");
        let press = JudgedPress { cause: Some(ErrorCause::Slip), ..press };
        let told = ExplainedError::among(&session, &[press])[0].told_without_press(Some("thinks nori".to_string()));
        let caused = format!("{why}; cause (simulated participant): slip{cost}");
        assert!(told.starts_with(&caused) && told.ends_with("; thinks nori"), "{told}");
    };
    check(&["crab maki"], &[(Human, "take shrimp")], "order 1 needs crab");
    // With two orders nobody knows for which of them it was.
    check(&["tuna nigiri", "crab maki"], &[(Human, "take shrimp")], "no order needs shrimp");
    check(&["crab maki"], &[(Human, "cut")], "the cutting board is empty");
    let nori = [(Robot, "take nori"), (Robot, "assembly_board"), (Human, "take nori")];
    check(&["crab maki"], &nori, "order 1 has nori already");
    let rice = [(Human, "take rice"), (Human, "cooking_pot"), (Human, "cook"), (Human, "cooking_pot")];
    let shaped = [rice.as_slice(), &[(Human, "shape")]].concat();
    check(&["crab maki"], &shaped, "no order needs shaped rice");
    let stacked = [rice.as_slice(), &[(Human, "assembly_board")]].concat();
    check(&["tuna nigiri"], &stacked, "order 1 needs shaped rice, not cooked rice");
    let trash = [rice.as_slice(), &[(Human, "trash")]].concat();
    check(&["crab maki"], &trash, "order 1 needs cooked rice");
    // What no order needs is not to be carried about either.
    let carried = [(Human, "take shrimp"), (Human, "counter"), (Human, "counter")];
    check(&["crab maki"], &carried, "no order needs raw shrimp");
    // Who did it already, and when; and nothing is said of what cannot be known.
    let cut = [(Human, "take salmon"), (Human, "cutting_board"), (Robot, "cut"), (Human, "cut")];
    check(&["salmon nigiri"], &cut, "it is cut salmon already, by the robot 5 s ago");
    let raw = [(Human, "take shrimp"), (Human, "cutting_board"), (Human, "cut")];
    check(&["shrimp nigiri"], &raw, "raw shrimp needs another step first");
    let dish = [
        rice.as_slice(),
        &[(Human, "shape"), (Human, "assembly_board"), (Human, "take nori"), (Human, "assembly_board")],
        &[(Human, "take salmon"), (Human, "cutting_board"), (Human, "cut"), (Human, "cutting_board")],
        &[(Human, "assembly_board"), (Human, "assembly_board"), (Human, "plate"), (Human, "serve 1")],
    ]
    .concat();
    check(&["crab maki", "salmon nigiri"], &dish, "the plate holds order 2's dish");
}

#[test]
fn what_is_there_counts_for_one_order_and_as_far_as_it_is() {
    let kitchen = kitchen();
    let mut state = kitchen.empty_state();
    for (order, dish) in kitchen.orders.iter().zip(["tuna nigiri", "tuna maki"]) {
        state.set_order(*order, OrderContent::Dish(kitchen.dish_named(dish).expect("a dish")));
    }
    for (place, content) in [("plate", "nori"), ("counter", "tuna raw"), ("cooking_pot", "rice cooked")] {
        let place = kitchen.location_named(place).expect("a place");
        state.set_code(place, kitchen.content_named(content).expect("a content").0);
    }
    let found = OrderWork::default().needs(&kitchen, state);
    let progress = |index: usize| found[index].items.iter().map(|needed| needed.progress).collect::<Vec<_>>();
    let at = |name| kitchen.location_named(name).expect("a place");
    use ItemProgress::{InWork, Missing, Ready, Stacked};
    // In the order of the recipe file: rice, nori, tuna. Cooked rice is ready for the maki before it is in work for the nigiri.
    assert_eq!(progress(0), [Missing, Stacked, InWork(at("counter"))]);
    assert_eq!(progress(1), [Ready(at("cooking_pot")), Missing, Missing]);
}

#[test]
fn a_time_between_two_past_moments_is_not_the_time_until_the_trials_end() {
    let mut session = Session::new(kitchen(), default_settings(), 0);
    (session.trial_start, session.paused_at) = (at(10.0), at(60.0));
    session.pauses = vec![(at(22.0), at(25.0))];
    for phase in [TrialPhase::Running, TrialPhase::Paused, TrialPhase::Over(TrialEndReason::Wizard)] {
        session.phase = phase;
        assert_eq!(session.age(at(20.0), at(30.0)), at(7.0), "{phase:?}");
    }
    assert_eq!(session.age(at(20.0), at(90.0)), at(37.0), "the clock stands after the end");
}

#[test]
fn once_all_items_are_there_the_steps_to_the_served_dish_are_left() {
    let kitchen = kitchen();
    let dish = kitchen.dish_named("tuna maki").expect("a dish");
    let left = |places: &[(&str, &str)]| {
        let mut state = kitchen.empty_state();
        state.set_order(kitchen.orders[0], OrderContent::Dish(dish));
        for (place, content) in places {
            let place = kitchen.location_named(place).expect("a place");
            state.set_code(place, kitchen.content_named(content).expect("a content").0);
        }
        OrderWork::default().needs(&kitchen, state)[0].last_step
    };
    let at = |name| kitchen.location_named(name).expect("a place");
    let (rice, tuna) = (("cooking_pot", "rice cooked"), ("cutting_board", "tuna cut"));
    assert_eq!(left(&[rice, tuna]), None, "the nori is missing");
    assert_eq!(left(&[rice, ("cutting_board", "tuna raw"), ("assembly_board", "nori")]), None, "the tuna is in work");
    assert_eq!(left(&[rice, tuna, ("assembly_board", "nori")]), Some(LastStep::Stack));
    let whole = &kitchen.content(kitchen.dish(dish).stack()).name;
    for place in ["assembly_board", "human_hand"] {
        assert_eq!(left(&[(place, whole)]), Some(LastStep::Plate(at(place))));
    }
    assert_eq!(left(&[("plate", whole)]), Some(LastStep::Serve));
}

/// What each order needs after these presses of the robot, where the second order was there before all of them, and the
/// first one appears after `before` of them: the progress of its items in the order of the recipe file, and whether it
/// was begun.
fn needs_of(dishes: [&str; 2], presses: &[&str], before: usize) -> [(Vec<ItemProgress>, bool); 2] {
    let kitchen = kitchen();
    let dish = |name: &str| OrderContent::Dish(kitchen.dish_named(name).expect("a dish"));
    let (mut state, mut timeline) = (kitchen.empty_state(), Vec::new());
    for step in 0..=presses.len() {
        for (index, appears) in [(1, 0), (0, before)] {
            if step == appears {
                let order = kitchen.orders[index];
                state.set_order(order, dish(dishes[index]));
                timeline.push(TimelineEntry { time: at(step as f64), what: TimelineEvent::OrderShown { order } });
            }
        }
        let Some(name) = presses.get(step) else { continue };
        let button = kitchen.button_named(Agent::Robot, name).expect("a button");
        let press = kitchen.try_press(state, Agent::Robot, button);
        let (agent, no_effect, after) = (Agent::Robot, None, press.after);
        let what = TimelineEvent::Press { agent, button, before: state, after, no_effect };
        timeline.push(TimelineEntry { time: at(step as f64), what });
        state = after;
    }
    let mut work = OrderWork::default();
    work.follow(&kitchen, &timeline);
    let found = work.needs(&kitchen, state);
    [0, 1].map(|index| {
        let progress = found[index].items.iter().map(|needed| needed.progress).collect();
        (progress, found[index].is_begun)
    })
}

#[test]
fn a_stack_is_that_of_the_order_it_was_begun_for_and_new_orders_move_no_tick() {
    use ItemProgress::{Missing, Ready, Stacked};
    let hand = kitchen().hands[Agent::Robot.index()];
    let nori = ["take nori", "assembly_board"];
    let [newer, older] = needs_of(["tuna maki", "salmon maki"], &nori, 2);
    assert_eq!((newer.0, newer.1), (vec![Missing; 3], false), "the upper order is the newer one");
    assert_eq!((older.0, older.1), (vec![Missing, Stacked, Missing], true));
    // So it is with two orders of one dish, and with what is not stacked yet.
    for (presses, there) in [(&nori[..], Stacked), (&nori[..1], Ready(hand))] {
        for before in [1, presses.len()] {
            let [without, with] = needs_of(["tuna maki", "tuna maki"], presses, before);
            assert_eq!(with.0, [Missing, there, Missing], "{presses:?}, {before}");
            assert_eq!((without.0, without.1), (vec![Missing; 3], false));
        }
    }
    // A second sheet is for the order that has none; what the begun order needs comes first to it.
    let [upper, lower] = needs_of(["tuna maki", "salmon maki"], &["take nori", "assembly_board", "take nori"], 2);
    assert_eq!((upper.0, lower.0), (vec![Missing, Ready(hand), Missing], vec![Missing, Stacked, Missing]));
}

#[test]
fn errors_are_presses_that_lose_more_than_the_best_one() {
    use Agent::{Human, Robot};
    let good = verdict(&["crab maki"], &[(Human, "take crab")], 1.0);
    let best = kitchen().button_named(Human, "take rice");
    assert_eq!(good, PressVerdict { regret: 0, excess: 0, race: false, error: false, is_proven: true, best });
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

/// The events of a session in which a freeze probe stands between a correction of the wizard and a press at its place.
fn press_after_a_probe() -> (SessionEngine, Vec<TimestampedEvent>) {
    let mut engine = on_request(|_| ());
    let skipped = ProbeEvent::Skipped { probe: 1, reason: "phone".to_string() };
    let inputs = [
        (0.0, Event::TrialStarted),
        (0.4, corrected("human_hand", "nori")),
        (0.5, Event::Probe(ProbeEvent::Requested)),
        (1.0, Event::Probe(skipped)),
        // The probe ends at 4 s, after its count down.
        (4.1, press("cut")),
    ];
    let events = inputs.into_iter().flat_map(|(seconds, event)| {
        let InputResult { events, refused } = engine.input(at(seconds), event);
        assert_eq!(refused, None);
        events
    });
    let events = events.collect();
    (engine, events)
}

#[test]
fn a_freeze_probe_is_no_time_for_the_next_press_wherever_presses_are_judged() {
    let (engine, events) = press_after_a_probe();
    let spec = &engine.session().spec;
    let mut follower = SessionFollower::new(Session::new(kitchen(), spec.clone(), 0), CostToGo::new(kitchen()));
    events.iter().for_each(|stamped| drop(follower.apply(stamped).expect("its own events")));
    let verdict = follower.judged.last().expect("a press").verdict;
    assert!(verdict.excess >= 1 && verdict.race && !verdict.error, "{verdict:?}");
    // The list of recordings judges by itself.
    let (files, out) = (session_file("default"), empty_folder("judged-after-a-probe"));
    let (mut log, _) = live_recording(SessionSetup { spec: spec.clone(), ..files }, 0, &out);
    events.iter().for_each(|stamped| log.append(stamped).expect("written"));
    drop(log);
    let (listed, _) = list(&out, RecordingListDetail::WithErrors, |_| (), || ()).expect("a recording");
    assert_eq!(listed.recordings[0].errors, Some(0));
}

/// Applies events a given time apart and sums the regret of presses.
struct Recorded {
    session: Session,
    regret: RegretSum,
    cost: CostToGo,
    seq: u64,
    now_s: f64,
}

impl Recorded {
    fn add(&mut self, after_s: f64, event: Event) {
        self.now_s += after_s;
        let stamped = TimestampedEvent { seq: self.seq, time: at(self.now_s), event };
        self.seq += 1;
        let applied = apply(&mut self.session, &stamped).expect("an event that fits");
        self.regret.note(&self.session.kitchen.clone(), &mut self.cost, &applied.change);
    }

    fn press(&mut self, agent: Agent, button: &str) {
        self.add(2.0, Event::Press { agent, button: button.to_string(), at_ns: None, button_box: false });
    }
}

#[test]
fn an_order_takes_the_time_from_its_appearance_and_every_lost_press() {
    let kitchen = kitchen();
    let mut cost = CostToGo::new(kitchen.clone());
    let spec = session_file("default").spec;
    let session = Session::new(kitchen.clone(), spec, 0);
    let mut recorded = Recorded { session, regret: RegretSum::default(), cost: cost.clone(), seq: 0, now_s: 0.0 };
    recorded.add(0.0, Event::TrialStarted);
    let dish = kitchen.dishes[0].name.clone();
    recorded.add(5.0, Event::OrderShown { order: "order_1".to_string(), dish: dish.clone() });
    recorded.add(7.0, Event::OrderShown { order: "order_2".to_string(), dish });
    assert_eq!(recorded.regret.per_order(0), None);
    // Three lost presses: rice that is taken and thrown away again, and a serving without a dish.
    recorded.press(Agent::Human, "take rice");
    recorded.press(Agent::Human, "trash");
    recorded.press(Agent::Human, "serve 1");
    let mut served_s = Vec::new();
    while served_s.len() < 2 {
        let press = helpful(&kitchen, &mut cost, recorded.session.state, &Agent::BOTH);
        let (agent, button) = press.expect("a press that brings the orders nearer");
        recorded.press(agent, &button);
        if recorded.session.served.len() > served_s.len() {
            served_s.push((recorded.now_s, button));
        }
    }
    let appeared_s = |button: &str| if button == "serve 1" { 5.0 } else { 12.0 };
    let wanted: Vec<f64> = served_s.iter().map(|(served_s, button)| served_s - appeared_s(button)).collect();
    assert_eq!(order_times(&recorded.session), wanted);
    // Taking rice brings the orders nearer, throwing it away loses that press and itself.
    assert_eq!(recorded.regret.per_order(2), Some(1.5));
}
