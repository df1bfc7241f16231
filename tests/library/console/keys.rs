//! Keys: what they send, how often, which are hinted at, whose they are, and what they do to kitchen and robot.

use crossterm::event::{KeyCode, KeyEventKind};
use tomcom::console::ConsoleCommand;
use tomcom::console::console_model::{Dialog, Playback};
use tomcom::console::key_action::KeyLayer;
use tomcom::console::lists::{Picker, PickerKind};
use tomcom_core::measures::wizard_performance::{FalseBeliefPeriod, WizardMeasures, WizardSignal};
use tomcom_session::event::WizardScreenContent;

use super::{SIZES, Stage, input, type_in};
use crate::support::*;

#[test]
fn a_terminal_that_reports_repeats_lets_the_same_key_be_pressed_twice() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    stage.kind(KeyCode::Tab, KeyEventKind::Press);
    stage.kind(KeyCode::Tab, KeyEventKind::Release);
    let key = KeyCode::Char('a');
    for _ in 0..3 {
        assert!(input(stage.kind(key, KeyEventKind::Press)).is_some());
        assert_eq!(stage.kind(key, KeyEventKind::Repeat), None);
        assert_eq!(stage.kind(key, KeyEventKind::Release), None);
        stage.wait(0.05);
    }
}

#[test]
fn without_key_releases_two_presses_count_twice_and_a_held_key_once() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    stage.key(KeyCode::Tab);
    let key = KeyCode::Char('a');
    for _ in 0..3 {
        stage.wait(0.2);
        assert!(input(stage.key(key)).is_some(), "a second press: {}", stage.notice());
    }
    for _ in 0..20 {
        stage.wait(0.03);
        assert_eq!(stage.key(key), None);
        assert!(stage.notice().contains("held down"), "{}", stage.notice());
    }
    stage.wait(0.5);
    stage.key(KeyCode::Char('?'));
    stage.wait(0.2);
    stage.key(KeyCode::Char('?'));
    assert_eq!(stage.model.dialog, None, "help opens and closes");
    stage.control('c');
    for (gap_s, says) in [(0.5, "\"^c\" may still be held down: press it again"), (0.03, "\"^c\" is held down")] {
        stage.wait(gap_s);
        assert_eq!(stage.control('c'), None, "a held key does not answer its own question");
        assert_eq!(stage.model.dialog, Some(Dialog::Quit));
        assert!(stage.notice().contains(says), "{}", stage.notice());
        for size in SIZES {
            assert!(stage.screen(size).contains(says), "the dialog leaves the line free: {}", stage.screen(size));
        }
    }
    stage.shows((80, 24), &["y or ^c yes"]);
    assert_eq!(stage.key(KeyCode::Enter), None, "any other key is no");
    assert_eq!(stage.model.dialog, None);
    for (key, title, done) in [
        ('c', "Quit tomcom?", Some(ConsoleCommand::Quit)),
        ('e', "End the trial?", Some(ConsoleCommand::Input(Event::TrialEnded { reason: TrialEndReason::Wizard }))),
    ] {
        assert_eq!(stage.control(key), None);
        let screen = stage.screen((80, 24));
        assert!(screen.contains(title) && screen.contains(&format!("y or ^{key} yes")), "{screen}");
        stage.wait(0.5);
        assert_eq!(stage.control(key), None, "too soon");
        assert!(stage.notice().contains(&format!("\"^{key}\" may still be held down")), "{}", stage.notice());
        stage.wait(1.0);
        assert_eq!(stage.control(key), done, "a second press that is no held key is yes, as the question says");
        assert_eq!(stage.model.dialog, None);
        stage.wait(1.0);
    }
    stage.at(stage.model.now.as_secs_f64(), Event::TrialEnded { reason: TrialEndReason::Time });
    stage.control('c');
    stage.wait(1.0);
    assert_eq!(stage.control('c'), Some(ConsoleCommand::Quit), "after the trial it does");
}

#[test]
fn the_space_bar_stops_the_robot_in_every_view() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    let list = Some(Dialog::Pick(Picker::new(PickerKind::Place)));
    for dialog in [None, Some(Dialog::Help(Vec::new())), Some(Dialog::Quit), Some(Dialog::EndTrial), list] {
        for layer in [KeyLayer::Wizard, KeyLayer::Participant] {
            stage.model.dialog = dialog.clone();
            stage.model.layer = layer;
            assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
        }
    }
    stage.at(23.0, Event::RobotStopped);
    assert_eq!(stage.key(KeyCode::Char(' ')), None, "it is stopped already");
    stage.model.dialog = None;
    assert_eq!(input(stage.control('r')), Some(Event::RobotResumed));
}

#[test]
fn whoever_wants_to_quit_is_asked_in_whatever_list_they_are() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    for dialog in [Dialog::Help(Vec::new()), Dialog::Preflight, Dialog::Pick(Picker::new(PickerKind::Place))] {
        stage.model.dialog = Some(dialog);
        stage.wait(1.0);
        assert_eq!(stage.control('c'), None);
        assert_eq!(stage.model.dialog, Some(Dialog::Quit));
    }
}

#[test]
fn a_held_key_that_toggles_counts_once_also_where_no_release_is_reported() {
    for (key, control, event) in
        [('.', false, Event::TrialStarted), ('p', true, Event::RobotHeld { by: Sender::Wizard })]
    {
        let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
        let press = |stage: &mut Stage| input(if control { stage.control(key) } else { stage.key(KeyCode::Char(key)) });
        assert_eq!(press(&mut stage), Some(event.clone()));
        stage.at(0.01, event);
        // The delay of key repeat, then the repeats themselves.
        for gap_s in [0.5, 0.03, 0.03, 0.03] {
            stage.wait(gap_s);
            assert_eq!(press(&mut stage), None);
            assert!(stage.notice().contains("held down"), "{}", stage.notice());
        }
        stage.wait(0.8);
        assert!(press(&mut stage).is_some(), "{}", stage.notice());
    }
}

/// The last line of the screen.
fn hints(stage: &Stage) -> String {
    stage.screen((200, 60)).lines().last().unwrap_or_default().trim_matches('"').trim_end().to_string()
}

fn check(stage: &Stage, shown: &[&str], hidden: &[&str]) {
    let line = hints(stage);
    for text in shown {
        assert!(line.contains(text), "{text:?} is possible: {line}");
    }
    for text in hidden {
        assert!(!line.contains(text), "{text:?} is not possible: {line}");
    }
}

#[test]
fn a_live_session_shows_the_keys_that_do_something_now() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (200, 60);
    check(&stage, &["STOP ROBOT", ". pause", "take back", "^e end", "^k find", "1-5 note"], &["resume", "send offer"]);
    stage.at(23.0, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    check(&stage, &[], &["take back"]);
    stage.at(23.1, Event::RobotStopped);
    check(&stage, &["^r resume robot"], &["STOP ROBOT"]);
    stage.at(23.2, Event::TrialPaused);
    check(&stage, &[". resume"], &["pause", "send offer"]);
}

#[test]
fn a_typed_note_is_hinted_in_a_pause_where_it_is_possible() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.hides((80, 24), &["0 type note"]);
    stage.at(23.0, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    stage.at(23.2, Event::TrialPaused);
    for size in super::SIZES {
        stage.shows(size, &["1-5 note", "0 type note", "? help", "^c quit"]);
    }
}

#[test]
fn over_a_dialog_only_what_passes_it_is_shown() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (200, 60);
    stage.model.dialog = Some(Dialog::Pick(Picker::new(PickerKind::Place)));
    assert_eq!(hints(&stage), "  space STOP ROBOT  ^c quit");
    stage.model.dialog = Some(Dialog::EndTrial);
    assert_eq!(hints(&stage), "  space STOP ROBOT");
    stage.at(23.0, Event::RobotStopped);
    assert_eq!(hints(&stage), "");
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.model.size = (200, 60);
    stage.at(0.1, Event::RobotStopped);
    stage.key(KeyCode::Char('.'));
    assert_eq!(stage.model.dialog, Some(Dialog::Preflight));
    check(&stage, &["^r resume robot"], &["STOP ROBOT", "start"]);
}

#[test]
fn a_replay_shows_no_way_beyond_its_ends() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.size = (200, 60);
    let replay = |event, speed| Playback { event, events: 90, speed, ..Playback::new("S001".to_string()) };
    stage.replays(replay(10, 2));
    check(&stage, &[". play", "left/right step", "pgup/pgdn 10 s", "+/- speed"], &["pause", "STOP ROBOT"]);
    stage.model.playback = Some(Playback { playing: true, ..replay(0, 0) });
    check(&stage, &[". pause", "  right step", "  pgdn 10 s", "  + speed"], &["left", "pgup"]);
    stage.model.playback = Some(replay(90, 7));
    check(&stage, &["  left step", "  - speed"], &["right", "pgdn", "e error"]);
}

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
        for words in ["thinks", "Beliefs", "beliefs", "Signals by benefit", "probably false"] {
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
    assert!(stage.screen((120, 40)).contains("thinks cut salmon"), "the wizard's keys bring it back");
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
fn the_card_counts_signals_in_the_words_of_the_study() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(30.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    let unknown = stage.screen((80, 24));
    assert!(unknown.contains("2 by the wizard, 1 taken back") && !unknown.contains("needless"), "{unknown}");
    let sent = |seconds: f64, aspect: u8| WizardSignal {
        clock: at(seconds),
        press: 0,
        aspects: vec![AspectId(aspect)],
        to_display_ms: None,
        taken_back: false,
    };
    let period = FalseBeliefPeriod { aspect: AspectId(0), began: at(5.0), corrected: None, errors: 2 };
    stage.model.wizard = WizardMeasures::from_signals(&[sent(6.0, 0), sent(7.0, 1)], Some(&[period]));
    for words in stage.model.wizard.words().expect("known beliefs") {
        for size in SIZES {
            stage.shows(size, &[&words]);
        }
    }
}

#[test]
fn the_card_says_what_an_exclusion_has_done_and_how_to_take_it_back() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(30.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.shows_everywhere(&["^l exclude the trial"]);
    let reason = "the participant talked to somebody in the corridor for a long time and read the recipes from a phone";
    stage.at(31.0, Event::TrialExcluded { reason: reason.to_string() });
    stage.shows_everywhere(&["read the recipes", "from a phone", "left out of the analysis; ^l includes it again"]);
    stage.at(32.0, Event::TrialIncluded);
    assert!(!stage.screen((120, 40)).contains("left out"), "{}", stage.screen((120, 40)));
}

#[test]
fn the_kitchen_is_corrected_from_two_lists() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('u');
    stage.shows_everywhere(&[
        "Correct the kitchen: which place?",
        "8 of 8",
        "» 1 human hand",
        "2 robot hand",
        "raw salmon",
    ]);
    check_snapshot("console", "correct_80x24", stage.screen((80, 24)));
    type_in(&mut stage, "pot");
    stage.wait(0.05);
    assert_eq!(stage.key(KeyCode::Enter), None);
    let contents = ["What is really at cooking pot?", "14 of 14", "» 1 raw rice", "cut crab", "enter choose"];
    stage.shows((80, 24), &contents);
    for _ in 0..20 {
        stage.wait(0.03);
        assert_eq!(stage.key(KeyCode::Enter), None, "a held enter answers one question");
    }
    type_in(&mut stage, "cookedri");
    stage.wait(0.05);
    let corrected = Event::KitchenCorrected { location: "cooking_pot".to_string(), content: "rice cooked".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(corrected.clone()), "{}", stage.notice());
    assert_eq!(stage.model.dialog, None);
    stage.at(23.0, corrected);
    stage.shows((120, 40), &["cooked rice"]);
    // Esc goes back a step, then leaves; what nothing is called leads nowhere.
    stage.wait(1.0);
    stage.control('u');
    type_in(&mut stage, "zzz");
    assert_eq!(stage.key(KeyCode::Enter), None);
    for left in [3, 2, 1] {
        assert!(matches!(&stage.model.dialog, Some(Dialog::Pick(list)) if list.cursor.filter.len() == left));
        stage.key(KeyCode::Backspace);
    }
    stage.key(KeyCode::Down);
    stage.wait(1.0);
    stage.key(KeyCode::Enter);
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, Some(Dialog::Pick(Picker::new(PickerKind::Place))));
    stage.key(KeyCode::Esc);
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn the_robot_is_held_skipped_and_driven_by_keys() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let by = Sender::Wizard;
    assert_eq!(input(stage.control('p')), Some(Event::RobotHeld { by }));
    stage.at(22.7, Event::RobotHeld { by });
    stage.shows((80, 24), &["ROBOT HELD"]);
    let screen = stage.shows((120, 40), &["‖"]);
    assert!(screen.contains("HELD") && screen.contains("^p releases the robot"), "{screen}");
    stage.wait(1.0);
    assert_eq!(input(stage.control('s')), Some(Event::RobotSkipped { by }));
    assert_eq!(stage.control('d'), None);
    let list = stage.shows((120, 40), &["The robot's next press", "15 of 15", "» 1 assembly board"]);
    for (button, is_idle) in [("take tuna", true), ("plate  ", false), ("serve 2", true)] {
        let is_row = |line: &&str| (1..=9).any(|digit| line.contains(&format!("│   {digit} {button}")));
        let is_later = |line: &&str| line.contains(&format!("│     {button}"));
        let row = list.lines().find(|line| is_row(line) || is_later(line)).expect(button);
        assert_eq!(row.contains("press has no effect now"), is_idle, "{row}");
    }
    type_in(&mut stage, "counter");
    let driven = Event::RobotDriven { by, button: "counter".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(driven));
    stage.wait(1.0);
    assert_eq!(input(stage.control('p')), Some(Event::RobotReleased { by }));
    stage.at(30.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    assert_eq!(stage.control('d'), None);
    assert!(stage.notice().contains("while the trial runs"), "{}", stage.notice());
}
