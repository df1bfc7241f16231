//! Scripted wizards: what they send, what they say, and that both come out the same again.

use tomcom_core::communication::HighlightSet;
use tomcom_people::wizard::{OfferReading, WizardKind, WizardSpec};
use tomcom_people::wizard::{ScriptedWizard, WizardAction};
use tomcom_session::admit::hygiene;

use super::{events, folder, paper, run};
use crate::support::*;

#[test]
fn a_scripted_wizard_signals_in_its_trials_and_comes_out_the_same_again() {
    let (files, out) = (paper(120), folder("wizard"));
    let figures = run(&files, 4, SimulationShard::WHOLE, &out);
    let mut signals = 0;
    for recording in &figures.recordings {
        let (header, events) = events(Path::new(recording));
        let shown = events.iter().filter(|stamped| matches!(stamped.event, Event::SignalShown { .. }));
        let times: Vec<SessionTime> = shown.clone().map(|stamped| stamped.time).collect();
        let by_wizard =
            |stamped: &TimestampedEvent| matches!(stamped.event, Event::SignalShown { by: Sender::Wizard, .. });
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
    let arms: Vec<StudyArm> = figures.arms.iter().map(|one| one.arm).collect();
    assert_eq!(arms, [StudyArm::None, StudyArm::Wizard]);
}

#[test]
fn a_wizard_who_sees_nothing_says_nothing_and_no_hand_signals_in_its_place() {
    let mut files = paper(120);
    (files.spec.wizard.sees_errors, files.spec.wizard.sees_overlooked) = (0.0, 0.0);
    assert_eq!(run(&files, 2, SimulationShard::WHOLE, &folder("blind")).signals, 0);
    // A wizard who is a person is not there in a simulation.
    files.spec.wizard = WizardSpec { kind: WizardKind::Person, sees_errors: 1.0, ..files.spec.wizard };
    let figures = run(&files, 2, SimulationShard::WHOLE, &folder("person"));
    assert!(figures.arms.iter().all(|one| one.arm == StudyArm::None));

    let mut spec = paper(120).spec;
    (spec.trial.condition, spec.plan) = (Condition::Wizard, None);
    let session = Session::new(Arc::new(files.kitchen.kitchen.clone()), spec, 0);
    let (_, signal) = tomcom_core::communication::signals(&session.kitchen, session.highlights()).swap_remove(3);
    let event = Event::SignalShown { by: Sender::Wizard, signal, offer: None };
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
    let second = |s: f64| at(s);
    let empty = kitchen.empty_state();
    // The robot puts the rice of an order into the pot: who does not see that fetches rice, too.
    let place = |name: &str| kitchen.location_named(name).expect("a place of the kitchen");
    let (pot, order) = (place("cooking_pot"), kitchen.orders[0]);
    let mut wanted = empty;
    wanted.set_order(order, tomcom_core::kitchen::OrderContent::Dish(DishId(0)));
    let mut filled = wanted;
    filled.set_content(pot, kitchen.content_named("rice raw").expect("an item"));
    let mut said = |looks: bool| {
        let mut wizard = ScriptedWizard::new(kitchen.clone(), spec.clone(), HighlightSet::usual(&kitchen), 1, 0);
        wizard.on_trial_start(wanted);
        wizard.on_change(second(1.0), wanted, filled);
        if looks {
            wizard.on_gaze(second(2.0), Some(pot), Some(filled));
            wizard.on_gaze(second(2.0 + spec.look_s), Some(pot), Some(filled));
        } else {
            // A look that is too short, and one elsewhere.
            wizard.on_gaze(second(2.0), Some(pot), Some(filled));
            wizard.on_gaze(second(2.05), Some(LocationId(0)), Some(filled));
        }
        let mut signals = Vec::new();
        while let Some(due) = wizard.next_due() {
            match wizard.act(due, filled, &mut cost) {
                Some(WizardAction::Send(signal)) => signals.push((due, signal)),
                Some(other) => panic!("nothing is offered: {other:?}"),
                None => {}
            }
        }
        signals
    };
    assert_eq!(said(true), []);
    let signals = said(false);
    let [(at, signal)] = &signals[..] else { panic!("one signal: {signals:?}") };
    assert_eq!(signal.target(), Some("cooking_pot"));
    let after_s = at.secs_since(second(1.0));
    assert!((after_s - spec.overlooked_after_s - spec.reaction_s).abs() < 1e-6, "after {after_s} s");
}

/// A scripted wizard who judges nothing by itself.
fn reader(offers: OfferReading, rest_s: f64) -> ScriptedWizard {
    let kitchen = Arc::new(paper(1).kitchen.kitchen);
    let spec = WizardSpec {
        kind: WizardKind::Scripted,
        reaction_spread: 0.0,
        rest_s,
        offers: Some(offers),
        ..WizardSpec::default()
    };
    let mut wizard =
        ScriptedWizard::new(kitchen.clone(), spec, HighlightSet::usual(&kitchen), 1, 0).reading_offers(1, 0);
    wizard.on_trial_start(kitchen.empty_state());
    wizard
}

/// What a wizard does until it has nothing to do.
fn actions(wizard: &mut ScriptedWizard) -> Vec<(f64, WizardAction)> {
    let kitchen = Arc::new(paper(1).kitchen.kitchen);
    let (state, mut cost) = (kitchen.empty_state(), CostToGo::new(kitchen));
    let mut actions = Vec::new();
    while let Some(due) = wizard.next_due() {
        actions.extend(wizard.act(due, state, &mut cost).map(|action| (due.as_secs_f64(), action)));
    }
    actions
}

#[test]
fn an_offer_is_taken_after_the_time_of_reading_or_left() {
    let second = at;
    let takes = |takes, reads_s| OfferReading { takes, reads_s };
    let mut wizard = reader(takes(1.0, 2.0), 5.0);
    wizard.on_offer(second(10.0), 7);
    wizard.postpone(second(30.0));
    assert_eq!(actions(&mut wizard), [(42.0, WizardAction::TakeOffer(7))]);
    // The next offer takes the place of the one before.
    wizard.on_offer(second(50.0), 8);
    wizard.on_offer(second(51.0), 9);
    assert_eq!(actions(&mut wizard), [(53.0, WizardAction::TakeOffer(9))]);
    // Nobody reads within the time in which a key means the offer before.
    wizard.on_offer(second(60.0), 10);
    let mut quick = reader(takes(1.0, 0.0), 5.0);
    quick.on_offer(second(60.0), 10);
    assert_eq!(actions(&mut quick), [(60.3, WizardAction::TakeOffer(10))]);
    let mut stubborn = reader(takes(0.0, 2.0), 5.0);
    stubborn.on_offer(second(10.0), 7);
    assert_eq!(actions(&mut stubborn), []);
    // After a signal it rests.
    let mut tired = reader(takes(1.0, 2.0), 5.0);
    tired.on_signal(second(9.0), LocationId(0), paper(1).kitchen.kitchen.empty_state());
    tired.on_offer(second(10.0), 7);
    assert_eq!(actions(&mut tired), [(14.0, WizardAction::TakeOffer(7))]);
}

/// The plan of arms with a scripted wizard: the same script with and without advice.
#[test]
fn a_scripted_wizard_takes_offers_in_the_arm_with_advice_alone() {
    let mut files = session_file("arms");
    files.spec.wizard.kind = WizardKind::Scripted;
    (files.spec.seed, files.spec.trial.presses) = (9701, 160);
    (files.spec.assistant.rollout.rollouts, files.spec.human.inference.beliefs) = (64, 128);
    let figures = run(&files, 5, SimulationShard::WHOLE, &folder("arms"));
    let arms: Vec<StudyArm> = figures.arms.iter().map(|one| one.arm).collect();
    let wanted = [StudyArm::None, StudyArm::Wizard, StudyArm::WizardWithAdvice, StudyArm::TomCom, StudyArm::Tom];
    assert_eq!(arms, wanted);
    for recording in &figures.recordings {
        let (header, events) = events(Path::new(recording));
        let arm = header.session.step.as_ref().and_then(|step| step.arm).expect("an arm");
        let visible: Vec<u64> = events
            .iter()
            .filter(|stamped| matches!(&stamped.event, Event::OfferOpened(advice) if advice.visible))
            .map(|stamped| stamped.seq)
            .collect();
        let taken: Vec<u64> = events
            .iter()
            .filter_map(|stamped| match stamped.event {
                Event::SignalShown { offer, .. } => offer,
                _ => None,
            })
            .collect();
        match arm {
            StudyArm::WizardWithAdvice => {
                assert!(!taken.is_empty() && taken.iter().all(|offer| visible.contains(offer)), "{recording}");
            }
            _ => assert!(visible.is_empty() && taken.is_empty(), "{recording}: {arm:?}"),
        }
        let found = verify(Path::new(recording)).expect("readable");
        assert!(found.verified, "{recording}: {:?}", found.difference);
    }
}
