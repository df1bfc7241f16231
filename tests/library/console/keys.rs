//! Keys: what they send, how often, and that none has two meanings.

use crossterm::event::{KeyCode, KeyEventKind};
use tomcom::console::console_model::Dialog;
use tomcom::console::key_action::{KeyErrorSource, KeyLayer};
use tomcom::console::lists::{Picker, PickerKind};
use tomcom::console::{ConsoleCommand, KeyBindings, KeyFileBindings};
use tomcom_core::communication::Sender;
use tomcom_core::kitchen::{Agent, Kitchen, LocationKind};
use tomcom_session::SessionSpec;
use tomcom_session::event::{Event, SignalEndReason, TrialEndReason};
use tomcom_session::settings::ParticipantKind;

use super::{SIZES, Stage, input};
use crate::kitchen;

#[test]
fn each_signal_has_a_key_that_sends_it_once() {
    for name in ["sushi", "burger"] {
        let mut stage = Stage::new(name, ParticipantKind::Simulated);
        let kitchen = stage.session.kitchen.clone();
        stage.at(1.0, Event::TrialStarted);
        for &order in &kitchen.orders {
            let order = kitchen.location(order).name.clone();
            stage.at(1.0, Event::OrderShown { order, dish: kitchen.dishes[0].name.clone() });
        }
        let mut sent = Vec::new();
        for location in &kitchen.locations {
            stage.wait(5.0);
            let key = location.signal_key.expect("every location of the shipped kitchens has a key");
            let Some(Event::SignalShown { signal, .. }) = input(stage.key(KeyCode::Char(key))) else {
                assert_eq!(location.kind, LocationKind::Hand(Agent::Human), "{}: {}", location.name, stage.notice());
                continue;
            };
            assert_eq!(signal.target(), Some(location.name.as_str()));
            sent.push(signal);
            for _ in 0..40 {
                stage.wait(0.03);
                assert_eq!(stage.key(KeyCode::Char(key)), None, "a held key repeats");
            }
        }
        assert_eq!(sent.len(), kitchen.locations.len() - 1);
    }
}

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
    assert!(stage.screen((80, 24)).contains("y or ^c yes"), "{}", stage.screen((80, 24)));
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
fn a_signal_is_not_sent_again_while_it_is_shown() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    let signal = input(stage.key(KeyCode::Char('a'))).expect("sent");
    stage.at(1.1, signal.clone());
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('a')), None);
    assert!(stage.notice().contains("shown already"), "{}", stage.notice());
    stage.at(3.0, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    assert_eq!(input(stage.key(KeyCode::Char('a'))), Some(signal));
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
fn a_layout_cannot_take_a_key_twice() {
    let mut kitchen = Kitchen::clone(&kitchen("sushi"));
    let spec: SessionSpec = toml::from_str("layout = \"\"").expect("the settings have defaults");
    kitchen.locations[0].signal_key = Some('3');
    let clash = KeyBindings::live(&kitchen, &spec, &KeyFileBindings::default()).expect_err("3 is a marker");
    assert_eq!(clash.place, KeyErrorSource::Layout(KeyLayer::Wizard, '3'));
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
