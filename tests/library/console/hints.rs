//! The hint line shows what is possible now, and nothing else.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::console_model::Playback;
use tomcom::console::lists::{Picker, PickerKind};
use tomcom::console::{KeyBindings, KeyFileBindings};
use tomcom_session::event::{Event, SignalEndReason};
use tomcom_session::settings::ParticipantKind;

use super::Stage;

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
    assert!(!stage.screen((80, 24)).contains("0 type note"));
    stage.at(23.0, Event::SignalEnded { reason: SignalEndReason::TakenBack });
    stage.at(23.2, Event::TrialPaused);
    for size in super::SIZES {
        let screen = stage.screen(size);
        for hint in ["1-5 note", "0 type note", "? help", "^c quit"] {
            assert!(screen.contains(hint), "{hint} at {size:?}:\n{screen}");
        }
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
    stage.model.keys =
        KeyBindings::replay(&stage.session.kitchen, &KeyFileBindings::default()).expect("the keys are free");
    let replay = |event, speed| Playback { event, events: 90, speed, ..Playback::new("S001".to_string()) };
    stage.model.playback = Some(replay(10, 2));
    check(&stage, &[". play", "left/right step", "pgup/pgdn 10 s", "+/- speed"], &["pause", "STOP ROBOT"]);
    stage.model.playback = Some(Playback { playing: true, ..replay(0, 0) });
    check(&stage, &[". pause", "  right step", "  pgdn 10 s", "  + speed"], &["left", "pgup"]);
    stage.model.playback = Some(replay(90, 7));
    check(&stage, &["  left step", "  - speed"], &["right", "pgdn", "e error"]);
}
