//! The rater's view: codebook and errors at three sizes, keys and clicks, undo, and two raters who settle.

use crossterm::event::KeyCode;
use tomcom::console::coding::{CodingRaters, RaterSession};
use tomcom::console::console_model::{Playback, ReplayAction};
use tomcom::console::key_action::{KeyAction, RaterAction};
use tomcom::console::{ConsoleCommand, ConsoleMessage, KeyBindings, KeyFileBindings, update};
use tomcom_core::measures::raters::{ErrorCauseCode, RaterCodes};
use tomcom_session::TimelineEvent;
use tomcom_session::error_list::ListedError;

use super::{SIZES, Stage};
use crate::support::*;

fn codes(of: &[(u64, ErrorCauseCode)]) -> RaterCodes {
    RaterCodes(of.iter().cloned().collect())
}

/// A recording with twelve errors, of which the third is the present one.
fn rated(party: CodingRaters, given: RaterCodes) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.console.visibility = WizardVisibility::State;
    // As in a blinded replay, from which signals are taken out.
    let is_signal = |what: &TimelineEvent| {
        matches!(what, TimelineEvent::Noted(Event::SignalShown { .. } | Event::SignalEnded { .. }))
    };
    stage.session.timeline.retain(|entry| !is_signal(&entry.what));
    stage.session.shown = None;
    let (kitchen, map) = (stage.session.kitchen.clone(), KeyFileBindings::default());
    stage.model.keys = KeyBindings::replay(&kitchen, &map).expect("the keys are free").with_coding(&kitchen);
    let buttons = ["take salmon", "cutting board", "assembly board", "trash"];
    let error = |index: usize| ListedError {
        error: index as u64 + 1,
        press: 100 * index as u64,
        time_s: 7.0 + 31.0 * index as f64,
        button: buttons[index % buttons.len()].to_string(),
        effective: index % 3 != 1,
        why: "order 1 needs tuna".to_string(),
        shown: "human hand empty".to_string(),
    };
    stage.model.coding = Some(RaterSession::new(party, (0..12).map(error).collect(), given));
    stage.model.playback = Some(Playback { event: 201, events: 1300, ..Playback::new("2026-03-14-P01-1".to_string()) });
    stage
}

fn rater(given: RaterCodes) -> Stage {
    rated(CodingRaters::Rater("R1".to_string()), given)
}

fn belief() -> ErrorCauseCode {
    ErrorCauseCode::Belief("cutting_board".to_string())
}

fn coding(stage: &Stage) -> &RaterSession {
    stage.model.coding.as_ref().expect("errors are coded")
}

#[test]
fn codebook_and_errors_stand_beside_the_kitchen_at_three_sizes() {
    let stage = rater(codes(&[(0, ErrorCauseCode::Slip), (100, belief()), (200, ErrorCauseCode::Buttons)]));
    for size in SIZES {
        let screen = stage.screen(size);
        for name in
            ["slip", "race", "other cause", "mixed up buttons", "wrong about", "h human hand", "3/12 errors coded"]
        {
            assert!(screen.contains(name), "{name} at {size:?}\n{screen}");
        }
        for telling in ["unassisted", "assistant", "wizard", "P01 ", "Beliefs", "recipe of order", "thinks", "signal"] {
            assert!(!screen.contains(telling), "{telling} at {size:?}\n{screen}");
        }
    }
    check_snapshot("console", "rater_120x40", stage.screen((120, 40)));
}

#[test]
fn the_list_has_whole_words_and_says_what_was_needed_and_shown() {
    let mut stage = rater(RaterCodes::default());
    for size in SIZES {
        stage.model.size = size;
        // In a narrow list a sign says that a press had no effect.
        let no_effect = if size.0 == 120 { "cutting board ○" } else { "cutting board (no effect)" };
        stage.shows(size, &["assembly board", no_effect]);
    }
    stage.model.size = (120, 40);
    let screen = stage.screen((120, 40));
    assert!(screen.contains("3 assembly board: order 1 needs") && !screen.contains("needs tu…"), "{screen}");
    stage.model.size = (200, 60);
    stage.shows((200, 60), &["order 1 needs tuna", "before: human hand empty"]);
}

#[test]
fn every_code_has_its_key_in_every_panel_and_no_key_tells_what_is_estimated() {
    let mut stage = rater(RaterCodes::default());
    for _ in 0..5 {
        stage.wait(1.0);
        stage.control('w');
        stage.control('o');
        stage.shows((80, 24), &["1 slip", "2 race", "3 other", "4 mixed up buttons", "q order 1", "m rolling mat"]);
    }
    let tells = |action: &KeyAction| *action == KeyAction::Belief || matches!(action, KeyAction::Differ(_));
    assert!(stage.model.keys.bindings.iter().all(|line| !tells(&line.action)));
    assert!(stage.model.keys.chord_for(&KeyAction::Rate(RaterAction::Undo)).is_some());
}

#[test]
fn leaving_asks_nothing_while_all_codes_are_saved_and_the_hint_says_so() {
    let mut stage = rater(RaterCodes::default());
    // The letters code beliefs here, also those that go to notes, errors and signals in other replays.
    stage.shows_everywhere(&["esc leave (saved)", "letters belief"]);
    if let Some(coding) = &mut stage.model.coding {
        coding.is_saved = false;
    }
    let screen = stage.screen((80, 24));
    assert!(screen.contains("esc leave") && !screen.contains("saved"), "{screen}");
    assert_eq!(stage.control('c'), Some(ConsoleCommand::Quit), "what is not saved is saved on leaving");
}

#[test]
fn arrows_and_clicks_go_to_an_error_of_the_list() {
    let mut stage = rater(RaterCodes::default());
    let go = |press| Some(ConsoleCommand::Move(ReplayAction::ToEvent(press)));
    assert_eq!(stage.key(KeyCode::Enter), go(300));
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Backspace), go(100));
    // The second one comes as from a key that is held.
    for gap_s in [1.0, 0.03] {
        stage.wait(gap_s);
        assert_eq!(stage.key(KeyCode::Down), None);
    }
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('1')), None, "the present error is not the chosen one");
    assert!(stage.notice().contains("error 5 is only selected"), "{}", stage.notice());
    assert_eq!(stage.key(KeyCode::Enter), go(400));
    stage.model.size = (120, 40);
    let screen = stage.screen((120, 40));
    let row = screen.lines().position(|line| line.contains("   2  0:38")).expect("the second error");
    assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Click(90, row as u16)), go(100));
}

#[test]
fn a_click_on_the_codebook_gives_the_code() {
    for size in SIZES {
        for (words, code) in [("2 race", ErrorCauseCode::Race), ("c cutting board", belief())] {
            let mut stage = rater(RaterCodes::default());
            stage.model.size = size;
            let command = stage.click(words);
            assert_eq!(command, Some(ConsoleCommand::Code { press: 200, was: None }), "{words} at {size:?}");
            assert_eq!(coding(&stage).codes.0[&200], code);
        }
    }
}

#[test]
fn the_last_code_says_what_comes_next() {
    let all = RaterCodes((0..12).map(|index| (100 * index, ErrorCauseCode::Slip)).collect());
    let mut stage = rater(all);
    stage.shows_everywhere(&["every error is coded; next:"]);
    if let Some(coding) = &mut stage.model.coding {
        coding.finished.push("R0".to_string());
    }
    stage.shows((120, 40), &["--settle R0 R1"]);
}
