//! Whose keys are live: who presses the participant's buttons at the keyboard sees neither the estimate nor offers.

use crossterm::event::KeyCode;
use tomcom::console::ConsoleCommand;
use tomcom_session::event::WizardScreenContent;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::settings::{ParticipantKind, WizardVisibility};

use super::{SIZES, Stage};
use crate::check_snapshot;

fn seen(stage: &Stage) -> WizardScreenContent {
    tomcom::console::panels::screen(&stage.session, &stage.model)
}

#[test]
fn the_participant_at_the_keyboard_sees_no_estimate() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    assert_eq!(seen(&stage).visibility, WizardVisibility::Recommendation);
    assert_eq!(stage.control('b'), None);
    assert!(stage.screen((120, 40)).contains("probability of"), "the wizard looks at one belief");
    assert_eq!(stage.key(KeyCode::Tab), None);
    for size in SIZES {
        stage.model.size = size;
        let screen = stage.screen(size);
        assert!(screen.contains("KEYS: PARTICIPANT"), "{screen}");
        for words in ["thinks", "Beliefs", "beliefs", "Signals by benefit", "No false beliefs"] {
            assert!(!screen.contains(words), "{words} is shown at {size:?}:\n{screen}");
        }
        let seen = seen(&stage);
        assert_eq!(seen.visibility, WizardVisibility::State, "and the record says so");
        assert!(seen.panels.iter().all(|panel| panel != "belief" && panel != "recommendation"), "{seen:?}");
    }
    stage.wait(1.0);
    assert_eq!(stage.control('b'), None);
    assert_eq!(stage.notice(), "beliefs are not shown in this session");
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Tab), None);
    assert!(stage.screen((120, 40)).contains("thinks salmon nigiri"), "the wizard's keys bring it back");
}

#[test]
fn a_pause_shows_the_recipes_to_who_plays_the_participant() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    assert_eq!(stage.key(KeyCode::Tab), None);
    for size in SIZES {
        assert!(!stage.screen(size).contains("tuna maki"), "they have to be remembered while it runs");
    }
    stage.at(23.0, Event::TrialPaused);
    for size in SIZES {
        let screen = stage.screen(size);
        for dish in &stage.session.kitchen.dishes {
            assert!(screen.contains(&dish.name), "{}:\n{screen}", dish.name);
        }
        assert!(screen.contains("shaped rice + nori + cut tuna") && screen.contains(". resume"), "{screen}");
    }
    check_snapshot("console", "recipes_120x40", stage.screen((120, 40)));
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('.')), Some(ConsoleCommand::Input(Event::TrialResumed)));
    assert_eq!(stage.key(KeyCode::Tab), None);
    assert!(!stage.screen((120, 40)).contains("the recipes"), "the wizard sees the kitchen in a pause");
}

#[test]
fn signals_are_judged_at_the_end_where_the_wizard_may_know() {
    let end = |participant, visibility| {
        let mut stage = Stage::sushi(participant);
        stage.session.spec.console.visibility = visibility;
        stage.at(30.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
        stage.screen((80, 24))
    };
    let judged = "2 about a false belief, 0 late, 0 needless";
    let known = end(ParticipantKind::Simulated, WizardVisibility::State);
    assert!(known.contains("2 by the wizard, 1 taken back") && known.contains(judged), "{known}");
    assert!(!known.contains("estimated"), "{known}");
    let estimated = end(ParticipantKind::Display, WizardVisibility::Belief);
    assert!(estimated.contains(&format!("estimated    {judged}")), "{estimated}");
    let blind = end(ParticipantKind::Display, WizardVisibility::State);
    assert!(blind.contains("2 by the wizard") && !blind.contains("needless"), "{blind}");
}
