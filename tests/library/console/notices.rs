//! Notices, alarms, notes and ages on the screen.

use crossterm::event::KeyCode;
use tomcom::console::console_model::{Dialog, LslStatus, RerunStreamStatus};
use tomcom::console::key_action::KeyLayer;
use tomcom::console::preflight::{GazePairing, checks};
use tomcom::console::{ConsoleCommand, ConsoleMessage, KeyBindings, KeyFileBindings, update};
use tomcom_core::robot::{ArmStage, SafetyMode};
use tomcom_session::TimelineEvent;
use tomcom_session::history::event_words;
use tomcom_session::preflight_checks::PreflightVerdict;
use tomcom_session::tracker::TrackerEvent;

use super::{SIZES, Stage, input, type_in};
use crate::support::*;

#[test]
fn ages_stand_still_in_a_pause_and_after_the_end() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.at(1.0, Event::TrialStarted);
    let shown = at(2.0);
    stage.at(2.0, Event::OrderShown { order: "order_1".to_string(), dish: "tuna nigiri".to_string() });
    stage.at(5.0, Event::TrialPaused);
    let age_s = |stage: &Stage, now_s: f64| stage.session.age(shown, at(now_s)).as_secs_f64();
    assert_eq!(age_s(&stage, 100.0), 3.0);
    stage.at(105.0, Event::TrialResumed);
    assert_eq!(age_s(&stage, 106.0), 4.0);
    stage.at(107.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    assert_eq!(age_s(&stage, 200.0), 5.0);
    stage.shows((120, 40), &["^c close the session"]);
    stage.hides((120, 40), &["STOP ROBOT"]);
}

#[test]
fn the_rate_of_the_gaze_begins_anew_after_a_gap() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.at(1.0, Event::TrialStarted);
    for start_s in [2.0, 7.0] {
        for step in 0..24 {
            stage.look(start_s + f64::from(step) / 120.0, 0.5, 0.5);
        }
        let hz = stage.session.gaze_hz(stage.model.now).expect("samples come");
        assert!((hz - 120.0).abs() < 1.0, "{hz} Hz");
        stage.wait(1.5);
        assert_eq!(stage.session.gaze_hz(stage.model.now), None);
        stage.shows((120, 40), &["NO GAZE 2 s", "no gaze for 2 s; last: ", "no samples arrive"]);
    }
}

#[test]
fn a_lost_keyboard_is_an_alarm_and_an_event() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let mut focus = |focused| input(update(&mut stage.model, &stage.session, ConsoleMessage::Focus(focused)));
    assert_eq!(focus(true), None, "it has it already");
    assert_eq!(focus(false), Some(Event::FocusLost));
    assert_eq!(focus(false), None);
    stage.shows_everywhere(&["NO KEYBOARD", "KEYBOARD FOCUS LOST"]);
    assert_eq!(
        input(update(&mut stage.model, &stage.session, ConsoleMessage::Focus(true))),
        Some(Event::FocusRegained)
    );
}

#[test]
fn what_mends_is_told_with_the_keys_that_hold() {
    let mut stage = Stage::new("sushi", ParticipantKind::Display);
    stage.session.spec.participant.gaze = GazeSource::Pupil;
    let remedy = |stage: &Stage| {
        let checks = checks(&stage.session, &stage.model);
        checks.into_iter().find(|check| check.name == "calibration").and_then(|check| check.remedy).unwrap_or_default()
    };
    assert!(remedy(&stage).starts_with("^v checks gaze accuracy"), "{}", remedy(&stage));
    let map: KeyFileBindings = toml::from_str("[console]\ncheck_gaze = \"f9\"\n").expect("a key file");
    stage.model.keys = KeyBindings::live(&stage.session.kitchen, &stage.session.spec, &map).expect("f9 is free");
    assert!(remedy(&stage).starts_with("F9 checks gaze accuracy"), "{}", remedy(&stage));
}

#[test]
fn the_notes_are_those_of_the_session() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session.spec.console.notes = vec!["asked for help".to_string()];
    stage.model.keys =
        KeyBindings::live(&stage.session.kitchen, &stage.session.spec, &KeyFileBindings::default()).expect("free keys");
    assert_eq!(
        input(stage.key(KeyCode::Char('1'))),
        Some(Event::Marker { note: "asked for help".to_string(), observer: None })
    );
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('2')), None);
    stage.key(KeyCode::Char('?'));
    stage.shows((120, 40), &["asked for help"]);
    stage.hides((120, 40), &["wrong recipe"]);
}

#[test]
fn notes_in_words_are_written_while_no_trial_runs_and_only_there_the_space_bar_types() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(23.0, Event::TrialPaused);
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    for letter in "Asks fhr  help".chars() {
        stage.wait(0.05);
        assert_eq!(stage.key(KeyCode::Char(letter)), None, "a space is typed, and stops nothing");
    }
    for _ in 0..7 {
        stage.key(KeyCode::Left);
    }
    stage.key(KeyCode::Backspace);
    stage.key(KeyCode::Char('o'));
    stage.key(KeyCode::End);
    for size in [(80, 24), (200, 60)] {
        stage.shows(size, &["no trial is running: space types a space", " Asks for  help ", "enter save the text"]);
    }
    let note = Event::Marker { note: "Asks for  help".to_string(), observer: None };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(note));
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    assert_eq!(stage.key(KeyCode::Esc), None);
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn a_time_mark_is_set_at_once_and_gets_its_words_when_the_trial_stands() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    for seconds in [23.0, 24.0] {
        let mark = input(stage.key(KeyCode::Char('0'))).expect("a mark");
        assert_eq!(mark, Event::Marker { note: String::new(), observer: None });
        assert_eq!(stage.model.dialog, None, "the space bar goes on to stop the robot");
        stage.at(seconds, mark);
        stage.wait(1.0);
    }
    let marks: Vec<u64> = stage.session.open_marks.iter().map(|(mark, _)| *mark).collect();
    stage.at(26.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.wait(1.0);
    stage.shows((120, 40), &["time marks", "without words at 0:20, 0:21", "0 word the time marks"]);
    stage.key(KeyCode::Char('0'));
    stage.shows((80, 24), &["The time mark at 0:20: its words", "1 further mark after it"]);
    type_in(&mut stage, "looked away");
    let worded = Event::MarkerWorded { marker: marks[0], note: "looked away".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(worded.clone()));
    stage.at(28.0, worded);
    let told = event_words::mark_worded(&stage.session, "looked away");
    assert_eq!(told, "words of the time mark at 0:20: looked away");
    stage.shows((80, 24), &["The time mark at 0:21: its words"]);
    // A mark may stay without words.
    let without = Event::MarkerWorded { marker: marks[1], note: String::new() };
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(without.clone()));
    stage.at(30.0, without);
    let noted: Vec<(f64, &str)> = stage
        .session
        .timeline
        .iter()
        .filter_map(|entry| match &entry.what {
            TimelineEvent::Noted(Event::Marker { note, observer: None }) if entry.time.as_secs_f64() > 22.0 => {
                Some((entry.time.as_secs_f64(), note.as_str()))
            }
            _ => None,
        })
        .collect();
    assert_eq!(noted, [(23.0, "looked away"), (24.0, "")]);
    assert!(stage.session.open_marks.is_empty() && stage.model.dialog.is_none());
}

#[test]
fn notes_in_words_are_written_after_the_trial_too_until_the_session_is_closed() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(23.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.wait(1.0);
    for size in SIZES {
        let screen = stage.screen(size);
        assert_eq!(screen.matches("0 type note").count(), 2, "on the card and in the last line at {size:?}:\n{screen}");
    }
    stage.key(KeyCode::Char('0'));
    type_in(&mut stage, "was tired");
    let note = Event::Marker { note: "was tired".to_string(), observer: None };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(note.clone()));
    stage.at(25.0, note.clone());
    assert!(stage.session.timeline.iter().any(|entry| entry.what == TimelineEvent::Noted(note.clone())));
    stage.at(26.0, Event::SessionEnded);
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn the_space_bar_stops_the_robot_where_a_trial_goes_on_while_a_note_is_typed() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.at(23.0, Event::TrialPaused);
    stage.wait(1.0);
    stage.key(KeyCode::Char('0'));
    type_in(&mut stage, "late");
    stage.at(25.0, Event::TrialResumed);
    stage.shows((80, 24), &["space STOP ROBOT"]);
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(Event::Marker { note: "late".to_string(), observer: None }));
}

#[test]
fn a_press_without_effect_says_why_and_a_switch_says_whose_the_keys_are() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    stage.wait(1.0);
    stage.model.layer = KeyLayer::Participant;
    // The hand holds raw salmon, the assembly board a stack, the pot is empty.
    for (key, words) in [
        ('y', "the press has no effect: the hand is full"),
        ('q', "the press has no effect: raw salmon needs another step first"),
        ('c', "the press has no effect: the cooking pot is empty"),
        ('s', "the press has no effect: the item is not accepted there"),
        ('1', "the press has no effect: the plate is empty"),
        ('t', "the press has no effect: raw salmon cannot be processed there"),
    ] {
        stage.wait(1.0);
        assert!(matches!(input(stage.key(KeyCode::Char(key))), Some(Event::Press { .. })), "the press counts");
        assert_eq!(stage.notice(), words);
        assert!(stage.screen((80, 24)).contains(words), "{}", stage.screen((80, 24)));
    }
    stage.wait(1.0);
    assert!(input(stage.key(KeyCode::Char('w'))).is_some());
    assert_eq!(stage.notice(), "", "a press with an effect needs no words");
    for words in ["keys now send the wizard's signals", "keys now press the participant's buttons"] {
        stage.wait(1.0);
        stage.key(KeyCode::Tab);
        assert_eq!(stage.notice(), words);
    }
}

#[test]
fn an_open_port_for_viewers_is_a_warning_in_whole_sentences() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let of_viewers = |stage: &Stage| {
        let all = checks(&stage.session, &stage.model);
        all.into_iter().find(|check| check.name == "rerun").expect("a check of the stream")
    };
    for (address, verdict) in [("127.0.0.1:9876", PreflightVerdict::Ok), ("0.0.0.0:9876", PreflightVerdict::Warning)] {
        stage.model.viewers = Some(RerunStreamStatus { address: Some(address.to_string()), written: 0, dropped: 0 });
        let check = of_viewers(&stage);
        assert_eq!(check.verdict, verdict, "{address}");
        assert_eq!(check.remedy.is_some(), verdict == PreflightVerdict::Warning);
    }
    let check = of_viewers(&stage);
    assert_eq!(check.found, "Rerun viewers at 0.0.0.0:9876 need no password");
    assert!(check.remedy.is_some_and(|remedy| remedy.contains("--rerun-listen 127.0.0.1:9876")));
}

#[test]
fn streams_that_are_sent_and_the_stream_of_gaze_are_checked() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::Lsl;
    let lsl = "outlets = [\"gaze\"]\n[gaze]\nname = \"glasses\"\nx = \"x\"\ny = \"y\"\n";
    stage.session.spec.lsl = Some(toml::from_str(lsl).expect("settings"));
    let found = |stage: &Stage, name: &str| {
        let check = checks(&stage.session, &stage.model).into_iter().find(|check| check.name == name).expect(name);
        (check.verdict, check.found.clone())
    };
    let told = |text: &str| text.to_string();
    let missing = told("no stream \"glasses\" is in the Lab Streaming Layer");
    assert_eq!(found(&stage, "eye tracker"), (PreflightVerdict::Failed, missing));
    stage.shows((120, 40), &["NO TRACKER"]);
    let reason = "the stream glasses has no channel \"x\"; it has no labels";
    stage.at(1.0, Event::Tracker(TrackerEvent::Lost { reason: told(reason) }));
    assert_eq!(found(&stage, "eye tracker"), (PreflightVerdict::Failed, told(reason)));
    stage.at(2.0, Event::Tracker(TrackerEvent::Connected { device: told("glasses on lab") }));
    assert_eq!(found(&stage, "eye tracker"), (PreflightVerdict::Ok, told("glasses on lab")));
    stage.model.lsl = Some(LslStatus { streams: vec![told("markers"), told("gaze")], sent: 9, lost: 0 });
    let open = "any computer in the network can read the streams markers, gaze";
    assert_eq!(found(&stage, "lsl"), (PreflightVerdict::Ok, told(open)));
    stage.model.lsl = Some(LslStatus { streams: vec![told("gaze")], sent: 9, lost: 3 });
    let (verdict, text) = found(&stage, "lsl");
    assert!(verdict == PreflightVerdict::Warning && text.starts_with("3 samples lost; "), "{text}");
}

#[test]
fn an_arm_that_stopped_itself_is_told_for_as_long_as_it_stands() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.robot.arm = ArmKind::Physics;
    let stopped = Event::RobotSafety { mode: SafetyMode::ProtectiveStop, force_n: Some(126.0), joint: None };
    stage.at(30.0, stopped);
    stage.at(60.0, Event::RobotTouched { force_n: 20.0 });
    stage.shows_everywhere(&["Arm stopped: protective stop: contact with a person, 126 N; ^r resumes the arm"]);
    stage.at(61.0, Event::RobotResumed);
    stage.hides((120, 40), &["Arm stopped"]);
}

/// What a real arm waits for, and the key for it, are told before the trial; why it stands, in the trial.
#[test]
fn a_real_arm_says_what_it_waits_for() {
    let fresh = || {
        let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
        stage.session.spec.robot.arm = ArmKind::Ur(std::net::IpAddr::from([192, 168, 1, 10]));
        let (kitchen, spec) = (stage.session.kitchen.clone(), stage.session.spec.clone());
        stage.model.keys = console_model(&kitchen, &spec, (120, 40)).keys;
        stage
    };
    let mut stage = fresh();
    let robot = |stage: &Stage| {
        let check =
            checks(&stage.session, &stage.model).into_iter().find(|check| check.name == "robot").expect("robot");
        (check.found, check.remedy.unwrap_or_default())
    };
    assert_eq!(robot(&stage).0, "the arm's controller at 192.168.1.10 has not answered yet");
    let told = |stage, found: &str| Event::RobotStage { stage, found: found.to_string() };
    stage.at(1.0, told(ArmStage::Off, ""));
    assert_eq!(robot(&stage).1, "^y switches the arm on and opens its brakes: nobody is near the arm");
    // The key works where the checks are listed, too.
    stage.key(KeyCode::Char('.'));
    assert_eq!(stage.model.dialog, Some(Dialog::Preflight));
    let confirmed = Event::RobotConfirmed { stage: ArmStage::Off };
    assert_eq!(stage.control('y'), Some(ConsoleCommand::Input(confirmed)));
    stage.at(2.0, told(ArmStage::Ready, ""));
    assert_eq!(robot(&stage).0, "the robot is ready");
    let mut stage = fresh();
    stage.shows((120, 40), &["ARM NOT READY"]);
    stage.at(2.0, told(ArmStage::Ready, ""));
    stage.hides((120, 40), &["ARM NOT READY"]);
    stage.at(3.0, Event::TrialStarted);
    stage.at(4.0, told(ArmStage::Lost, "the cable is out"));
    stage.shows_everywhere(&["Arm stopped: no connection: the cable is out; ^r resumes the arm"]);
    stage.shows((120, 40), &["ARM: NO CONNECTION", "^r resume"]);
    stage.at(5.0, Event::RobotResumed);
    stage.hides((120, 40), &["Arm stopped"]);
}

/// Head line, robot panel and manual have one name for each safety mode.
#[test]
fn a_safety_mode_has_one_name_on_the_screen_and_in_the_manual() {
    let manual = include_str!("../../../docs/robot.md");
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.robot.arm = ArmKind::Physics;
    stage.at(30.0, Event::RobotSafety { mode: SafetyMode::Safeguard, force_n: None, joint: None });
    for size in SIZES {
        stage.shows(size, &["SAFEGUARD STOP", "hand in the way"]);
        stage.hides(size, &["WAITS"]);
    }
    stage.at(31.0, Event::RobotSafety { mode: SafetyMode::Normal, force_n: None, joint: None });
    stage.at(31.0, Event::RobotStopped);
    for arm in [ArmKind::Physics, ArmKind::Timed] {
        stage.session.spec.robot.arm = arm;
        for size in SIZES {
            let screen = stage.screen(size);
            assert!(screen.contains(" EMERGENCY STOP  ^r resume"), "{size:?}:\n{screen}");
            assert!(!screen.contains("STOPPED"), "{screen}");
        }
    }
    for mode in ["NORMAL", "REDUCED", "SAFEGUARD STOP", "PROTECTIVE STOP", "EMERGENCY STOP", "FAULT"] {
        assert!(manual.contains(&format!("| `{mode}` |")), "{mode}");
    }
}

#[test]
fn the_summary_counts_the_stops_of_an_arm_that_can_touch() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.session.spec.robot.arm = ArmKind::Physics;
    for (at, mode) in
        [(30.0, SafetyMode::ProtectiveStop), (33.0, SafetyMode::ProtectiveStop), (36.0, SafetyMode::Fault)]
    {
        stage.at(at, Event::RobotSafety { mode, force_n: None, joint: None });
        stage.at(at + 1.0, Event::RobotResumed);
        stage.at(at + 1.0, Event::RobotSafety { mode: SafetyMode::Normal, force_n: None, joint: None });
    }
    stage.at(40.0, Event::RobotStopped);
    stage.at(50.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.shows_everywhere(&["2 protective stops, 1 emergency stop ", " 1 fault "]);
    stage.session.spec.robot.arm = ArmKind::Timed;
    assert!(!stage.screen((80, 24)).contains("protective"), "the timed arm cannot touch anybody");
}

#[test]
fn how_a_tracker_pairs_is_shown_until_its_gaze_arrives() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::Json;
    let check = |stage: &Stage| {
        let checks = checks(&stage.session, &stage.model);
        checks.iter().find(|check| check.name == "gaze pairing").map(|check| check.found.clone())
    };
    let is_shown = |stage: &Stage| SIZES.map(|size| stage.screen(size).contains(" pairing code ABC234"));
    assert_eq!((check(&stage), is_shown(&stage)), (None, [false; 3]), "programs of this computer need not pair");
    let (address, code) = ("192.168.1.5:50021".to_string(), "ABC234".to_string());
    stage.model.gaze_pairing = Some(GazePairing { address, code });
    let found = "pairing code ABC234; send gaze to 192.168.1.5:50021";
    assert_eq!(check(&stage), Some(found.to_string()));
    stage.control('f');
    assert!(SIZES.iter().all(|size| stage.screen(*size).contains(found)), "the list of checks");
    stage.key(KeyCode::Esc);
    stage.at(0.1, Event::TrialStarted);
    assert_eq!(is_shown(&stage), [true; 3], "the gaze panel");
    for step in 0..50 {
        stage.look(1.0 + 0.01 * f64::from(step), 0.5, 0.5);
    }
    assert_eq!((check(&stage), is_shown(&stage)), (None, [false; 3]), "gaze arrives");
    stage.model.now = at(20.0);
    assert_eq!((check(&stage), is_shown(&stage)), (Some(found.to_string()), [true; 3]), "the tracker is gone");
}
