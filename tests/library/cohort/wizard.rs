//! Scripted wizards: what they send, what they say, and that both come out the same again.

use std::path::Path;
use std::sync::Arc;

use tomcom::base::time::SessionTime;
use tomcom::communication::Sender;
use tomcom::kitchen::cost_to_go::CostToGo;
use tomcom::kitchen::{DishId, LocationId};
use tomcom::run::simulate::Shard;
use tomcom::run::verify::verify;
use tomcom::session::admit::hygiene;
use tomcom::session::settings::Condition;
use tomcom::session::{Event, Session, Stamped};
use tomcom::wizard::ScriptedWizard;
use tomcom::wizard::settings::{WizardKind, WizardSpec};

use super::{events, folder, paper, run};

#[test]
fn a_scripted_wizard_signals_in_its_trials_and_comes_out_the_same_again() {
    let (files, out) = (paper(120), folder("wizard"));
    let figures = run(&files, 4, Shard::WHOLE, &out);
    let mut signals = 0;
    for recording in &figures.recordings {
        let (header, events) = events(Path::new(recording));
        let shown = events.iter().filter(|stamped| matches!(stamped.event, Event::SignalShown { .. }));
        let times: Vec<SessionTime> = shown.clone().map(|stamped| stamped.time).collect();
        let by_wizard = |stamped: &Stamped| matches!(stamped.event, Event::SignalShown { by: Sender::Wizard, .. });
        assert!(shown.clone().all(by_wizard), "{recording}");
        match header.session.trial.condition {
            Condition::Wizard => signals += times.len(),
            _ => assert!(times.is_empty(), "{recording} is unassisted"),
        }
        let rest_s = header.session.wizard.rest_s;
        assert!(times.windows(2).all(|pair| pair[1].secs_since(pair[0]) >= rest_s), "{recording}: {times:?}");
        let found = verify(Path::new(recording)).expect("readable");
        assert!(found.verified, "{recording}: {:?}", found.difference);
    }
    assert!(signals > 0 && signals == figures.signals as usize, "{signals} signals");
    let conditions: Vec<Condition> = figures.conditions.iter().map(|one| one.condition).collect();
    assert_eq!(conditions, [Condition::None, Condition::Wizard]);
}

#[test]
fn a_wizard_who_sees_nothing_says_nothing_and_no_hand_signals_in_its_place() {
    let mut files = paper(120);
    (files.spec.wizard.sees_errors, files.spec.wizard.sees_overlooked) = (0.0, 0.0);
    assert_eq!(run(&files, 2, Shard::WHOLE, &folder("blind")).signals, 0);
    // A wizard who is a person is not there in a simulation.
    files.spec.wizard = WizardSpec { kind: WizardKind::Person, sees_errors: 1.0, ..files.spec.wizard };
    let figures = run(&files, 2, Shard::WHOLE, &folder("person"));
    assert!(figures.conditions.iter().all(|one| one.condition == Condition::None));

    let mut spec = paper(120).spec;
    (spec.trial.condition, spec.plan) = (Condition::Wizard, None);
    let session = Session::new(Arc::new(files.kitchen.kitchen.clone()), spec, 0);
    let (_, signal) = tomcom::communication::signals(&session.kitchen, false).swap_remove(3);
    let event = Event::SignalShown { by: Sender::Wizard, signal, accepted: None, offer: None };
    let refused = hygiene(&session, SessionTime::ZERO, &event).expect_err("nobody signals beside the script");
    assert!(refused.contains("scripted"), "{refused}");
}

/// What the wizard says about a change that is not looked at, and that is about to mislead.
#[test]
fn a_wizard_tells_what_was_not_looked_at_and_nothing_that_was() {
    let kitchen = Arc::new(paper(1).kitchen.kitchen);
    let spec = WizardSpec {
        kind: WizardKind::Scripted,
        sees_overlooked: 1.0,
        guesses_wrong: 0.0,
        reaction_spread: 0.0,
        ..WizardSpec::default()
    };
    let mut cost = CostToGo::new(kitchen.clone());
    let second = |s: f64| SessionTime::from_secs_f64(s);
    let empty = kitchen.empty_state();
    // The robot puts the rice of an order into the pot: who does not see that fetches rice, too.
    let place = |name: &str| kitchen.location_named(name).expect("a place of the kitchen");
    let (pot, order) = (place("cooking_pot"), kitchen.orders[0]);
    let mut wanted = empty;
    wanted.set_order(order, tomcom::kitchen::OrderContent::Dish(DishId(0)));
    let mut filled = wanted;
    filled.set_content(pot, kitchen.content_named("rice raw").expect("an item"));
    let mut said = |looks: bool| {
        let mut wizard = ScriptedWizard::new(kitchen.clone(), spec.clone(), false, 1, 0);
        wizard.on_trial_start(wanted);
        wizard.on_change(second(1.0), wanted, filled);
        if looks {
            wizard.on_gaze(second(2.0), Some(pot), filled);
            wizard.on_gaze(second(2.0 + spec.look_s), Some(pot), filled);
        } else {
            // A look that is too short, and one elsewhere.
            wizard.on_gaze(second(2.0), Some(pot), filled);
            wizard.on_gaze(second(2.05), Some(LocationId(0)), filled);
        }
        let mut signals = Vec::new();
        while let Some(due) = wizard.next_due() {
            signals.extend(wizard.act(due, filled, &mut cost).map(|signal| (due, signal)));
        }
        signals
    };
    assert_eq!(said(true), []);
    let signals = said(false);
    let [(at, signal)] = &signals[..] else { panic!("one signal: {signals:?}") };
    assert_eq!(signal.target(), "cooking_pot");
    let after_s = at.secs_since(second(1.0));
    assert!((after_s - spec.overlooked_after_s - spec.reaction_s).abs() < 1e-6, "after {after_s} s");
}
