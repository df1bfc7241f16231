//! The participant's button box: lines of text as presses, and what is none.

use std::time::{Duration, Instant};

use tomcom_core::kitchen::Agent;
use tomcom_devices::button_box::ButtonBoxMessage::{self, Press, Refused};
use tomcom_devices::button_box::PressLines;
use tomcom_session::button_box::ButtonBoxEvent;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict, participant};
use tomcom_session::settings::{GazeSource, ParticipantKind};
use tomcom_session::{Event, Session};

use crate::display::{engine, files};
use crate::support::at;

const SKETCH: &str = include_str!("../../examples/button_box/button_box.ino");

fn lines() -> PressLines {
    PressLines::new(&files("sessions/default.toml").kitchen.kitchen)
}

fn pressed(messages: &[ButtonBoxMessage]) -> Vec<&str> {
    let mut names = Vec::new();
    for message in messages {
        let Press(button, _) = message else { panic!("{message:?}") };
        names.push(button.as_str());
    }
    names
}

#[test]
fn a_line_is_a_press_by_name_or_by_number_however_its_bytes_arrive() {
    let (mut lines, now) = (lines(), Instant::now());
    // 12 is rice's gamepad button in the layout.
    let told = lines.take(b"take rice\r\n\r\n 12 \ncutting_board\rcooking", now);
    assert_eq!(pressed(&told), ["take rice", "take rice", "cutting_board"]);
    assert_eq!(lines.take(b"", now), []);
    assert_eq!(lines.take(b"_pot\n", now), [Press("cooking_pot".to_string(), now)]);
}

#[test]
fn what_is_no_press_is_told_once_a_second_with_its_number() {
    let (mut lines, now) = (lines(), Instant::now());
    let told = lines.take(b"take rise\n", now);
    assert_eq!(told, [Refused(1, "\"take rise\", which is no button of the layout".to_string())]);
    // Of the robot alone, no number of the layout, no text; none of them reaches the kitchen.
    assert_eq!(lines.take(b"take tuna\n99\n-1\n\xff\xfe\x1b[2J\n", now), []);
    let later = now + Duration::from_secs(1);
    let told = lines.take(b"take nori\n", later);
    assert_eq!(
        told,
        [
            Press("take nori".to_string(), later),
            Refused(4, "\"take tuna\", which is no button of the layout".to_string())
        ]
    );
    let told = lines.take(b"\x1b[2J\n", later + Duration::from_secs(1));
    assert_eq!(told, [Refused(1, "\"\\u001b[2J\", which is no button of the layout".to_string())]);
}

#[test]
fn a_line_without_end_takes_no_memory_and_the_next_one_counts() {
    let (mut lines, now) = (lines(), Instant::now());
    for _ in 0..1000 {
        assert_eq!(lines.take(&[b'x'; 1000], now), []);
    }
    let told = lines.take(b"\ntake rice\n", now);
    assert_eq!(
        told,
        [Press("take rice".to_string(), now), Refused(1, "a line of more than 64 bytes".to_string())],
        "{lines:?}"
    );
    assert!(format!("{lines:?}").len() < 2000);
}

#[test]
fn a_flood_is_cut_to_what_hands_can_do() {
    let (mut lines, now) = (lines(), Instant::now());
    let told = lines.take(&b"take rice\n".repeat(1000), now);
    let (presses, refused) = told.split_at(told.len() - 1);
    assert_eq!(pressed(presses).len(), 20);
    assert_eq!(refused, [Refused(980, "more than 20 presses within a second".to_string())]);
    let told = lines.take(b"take rice\n", now + Duration::from_secs(1));
    assert_eq!(pressed(&told), ["take rice"], "afterwards it works as before");
}

#[test]
fn the_sketch_has_every_button_of_the_sushi_kitchen() {
    let kitchen = files("sessions/default.toml").kitchen.kitchen;
    let table = SKETCH.split("Button buttons[]").nth(1).and_then(|text| text.split("};").next()).expect("a table");
    let mut named: Vec<&str> = table.split('"').skip(1).step_by(2).collect();
    let mut wanted: Vec<&str> = kitchen.buttons[Agent::Human.index()].iter().map(|button| &*button.name).collect();
    named.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(named, wanted);
}

/// A session with a button box, and its check before the trial.
#[test]
fn the_check_says_whether_the_box_is_there_and_when_its_last_press_came() {
    let mut files = files("sessions/default.toml");
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Keyboard, GazeSource::None);
    files.spec.participant.button_box = Some("/dev/ttyACM0".to_string());
    files.spec.check().expect("a session");
    let mut engine = engine(files);
    let found = |session: &Session, seconds| -> PreflightCheck {
        let checks = participant(session, at(seconds), "^t", None);
        checks.into_iter().find(|check| check.name == "button box").expect("a check")
    };
    assert_eq!(found(engine.session(), 0.0).verdict, PreflightVerdict::Failed);
    let mut does = |seconds, event| assert_eq!(engine.input(at(seconds), event).refused, None);
    does(1.0, Event::ButtonBox(ButtonBoxEvent::Connected { device: "/dev/ttyACM0".to_string() }));
    does(2.0, Event::ButtonBox(ButtonBoxEvent::Refused { lines: 3, found: "\"x\", which is none".to_string() }));
    let check = found(engine.session(), 2.0);
    assert_eq!(
        (check.verdict, &*check.found),
        (PreflightVerdict::Warning, "/dev/ttyACM0, no press yet; \"x\", which is none")
    );
    let press =
        |button_box| Event::Press { agent: Agent::Human, button: "take rice".to_string(), at_ns: None, button_box };
    let mut does = |seconds, event| assert_eq!(engine.input(at(seconds), event).refused, None);
    does(3.0, press(true));
    does(7.0, press(false));
    let check = found(engine.session(), 8.0);
    assert_eq!((check.verdict, &*check.found), (PreflightVerdict::Ok, "/dev/ttyACM0, last press take rice, 5 s ago"));
    let lost = Event::ButtonBox(ButtonBoxEvent::Lost { reason: "gone".to_string() });
    assert_eq!(engine.input(at(9.0), lost).refused, None);
    let check = found(engine.session(), 10.0);
    assert_eq!((check.verdict, &*check.found), (PreflightVerdict::Failed, "/dev/ttyACM0: gone"));
}
