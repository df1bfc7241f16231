//! A trial at the console: the checks before it, started, paused, aborted, excluded; and the check of the gaze.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use tomcom::console::ConsoleCommand;
use tomcom::console::console_model::{Dialog, LslStatus};
use tomcom::console::gaze_check::AccuracyCheckAction;
use tomcom::console::lists::{ListChoice, StartPrompt};
use tomcom::console::preflight::{ParticipantDisplayHealth, checks};
use tomcom_core::gaze::calibration::{GazeAccuracy, TargetAccuracy};
use tomcom_core::gaze::recorded::RecordedGazeSummary;
use tomcom_session::gaze_check::{AcceptedGazeCheck, GazeCheckEvent};
use tomcom_session::preflight_checks::PreflightVerdict;

use super::{SIZES, Stage, input, type_in};
use crate::support::*;

#[test]
fn recorded_gaze_is_told_before_the_trial_with_what_is_odd_in_it() {
    let mut stage = Stage::sushi(ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::File;
    stage.session.spec.tracker.file = Some("gaze/of/gaze.csv".to_string());
    let samples: Vec<(f64, GazeSample)> =
        (0..100).map(|nth| (f64::from(nth) / 50.0, GazeSample::new(0.5, 0.5, 0.9))).collect();
    let whole = RecordedGazeSummary::from_samples(&samples);
    let beside: Vec<(f64, GazeSample)> =
        samples.iter().map(|(at_s, sample)| (*at_s, GazeSample { confidence: 0.1, ..*sample })).collect();
    let odd = RecordedGazeSummary { remarks: vec!["line 7: the clock was set".to_string()], ..whole.clone() };
    for (found, name, verdict, words) in [
        (whole, "gaze", PreflightVerdict::Ok, "gaze.csv: 100 samples in 2.0 s; no gap of more than 1 s"),
        (odd, "gaze file", PreflightVerdict::Warning, "line 7: the clock was set"),
        (
            RecordedGazeSummary::from_samples(&beside),
            "gaze",
            PreflightVerdict::Failed,
            "100 samples in 2.0 s, 0 of them on the display with enough confidence",
        ),
    ] {
        stage.model.recorded_gaze = Some(found);
        let checks = checks(&stage.session, &stage.model);
        let told: Vec<_> = checks.iter().filter(|check| check.name == name).collect();
        assert!(told.len() == 1 && told[0].verdict == verdict && told[0].found.contains(words), "{told:?}");
        assert!(!told[0].found.contains("of/"), "the list has room for the name of the file only");
    }
}

#[test]
fn a_trial_is_aborted_with_a_reason_and_done_again() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    assert_eq!(stage.control('n'), None);
    assert!(stage.notice().contains("abort the trial before you repeat it"), "{}", stage.notice());
    assert_eq!(input(stage.control('x')), Some(Event::TrialPaused), "the trial stands while the reason is chosen");
    stage.at(23.0, Event::TrialPaused);
    let reasons =
        ["Abort the trial: why?", "6 of 6", "» 1 participant stopped", "2 technical failure", "6 other reason"];
    stage.shows((80, 24), &reasons);
    stage.shows((80, 24), &["or a reason in words", "enter choose; words can follow"]);
    stage.key(KeyCode::Char('2'));
    stage.shows((80, 24), &["» 2 technical failure"]);
    stage.key(KeyCode::Char('9'));
    stage.shows((80, 24), &["» 2 technical failure", "6 of 6"]);
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.shows((80, 24), &["technical failure: in words"]);
    for letter in "no power".chars() {
        stage.wait(0.2);
        assert_eq!(stage.key(KeyCode::Char(letter)), None, "the space bar types a space");
    }
    let aborted = Event::TrialAborted { reason: "technical failure: no power".to_string() };
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(aborted.clone()));
    stage.at(40.0, aborted);
    for size in SIZES {
        let screen = stage.screen(size);
        assert!(screen.contains("ABORTED") && screen.contains("^n repeat the trial"), "{screen}");
        assert!(screen.contains("aborted by the wizard") && screen.contains("technical failure"), "{screen}");
    }
    assert_eq!(stage.control('n'), Some(ConsoleCommand::Redo));
}

#[test]
fn words_that_are_no_preset_reason_are_those_of_another_one() {
    let paused = || {
        let mut stage = Stage::sushi(ParticipantKind::Simulated);
        stage.at(23.0, Event::TrialPaused);
        stage.wait(1.0);
        stage.control('x');
        stage
    };
    let aborted = |mut stage: Stage| {
        stage.wait(1.0);
        match input(stage.key(KeyCode::Enter)) {
            Some(Event::TrialAborted { reason }) => reason,
            other => panic!("{other:?}"),
        }
    };
    // "participant" begins a preset reason; from "felt" on the words are typed in a field of their own.
    for words in ["Lights went out", "participant felt sick", "interfering noise"] {
        let mut stage = paused();
        for letter in words.chars() {
            stage.wait(0.2);
            assert_eq!(stage.key(KeyCode::Char(letter)), None, "{words}: the space bar types a space");
        }
        stage.shows((80, 24), &["other reason: in words", words]);
        assert_eq!(aborted(stage), format!("other reason: {words}"));
    }
    let mut stage = paused();
    assert_eq!(stage.paste(Some("the fire alarm rang")), None);
    assert_eq!(aborted(stage), "other reason: the fire alarm rang");
    // The entry itself needs words.
    let mut stage = paused();
    stage.key(KeyCode::Char('6'));
    stage.key(KeyCode::Enter);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("another reason needs words"), "{}", stage.notice());
    // Before a letter is typed, the space bar stops the robot; in a running trial it always does.
    let mut stage = paused();
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('l');
    type_in(&mut stage, "inter");
    assert_eq!(input(stage.key(KeyCode::Char(' '))), Some(Event::RobotStopped));
    stage.hides((80, 24), &["other reason"]);
}

#[test]
fn a_question_before_a_recording_is_answered_by_a_digit_and_enter() {
    let key = |code| KeyEvent::new(code, KeyModifiers::NONE);
    let answers = ["yes", "no"].map(str::to_string).to_vec();
    let mut question = StartPrompt::new("P01: trial 1/2".to_string(), Vec::new(), answers);
    assert_eq!(question.reply(&key(KeyCode::Enter)), None, "nothing is chosen");
    assert_eq!(question.reply(&key(KeyCode::Char('2'))), None, "a digit chooses");
    assert_eq!(question.reply(&key(KeyCode::Char('7'))), None, "no answer has this digit");
    assert_eq!(question.chosen, Some(1));
    assert_eq!(question.reply(&key(KeyCode::Char('1'))), None);
    assert_eq!(question.reply(&key(KeyCode::Enter)), Some(ListChoice::Chosen(0)));
    question.reply(&key(KeyCode::Backspace));
    assert_eq!(question.reply(&key(KeyCode::Enter)), None);
    assert_eq!(question.reply(&key(KeyCode::Esc)), Some(ListChoice::Leave));
}

#[test]
fn what_is_wrong_with_the_coordinates_of_gaze_is_told_by_the_last_sample() {
    let told = |x: f64, y: f64, confidence: f64| {
        let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
        stage.session.spec.participant.gaze = GazeSource::Json;
        for step in 0..60 {
            stage.at(1.0 + f64::from(step) / 60.0, Event::Gaze(GazeSample::new(x, y, confidence)));
        }
        let checks = checks(&stage.session, &stage.model);
        let quality = checks.into_iter().find(|check| check.name == "gaze quality").expect("a check");
        (quality.found, quality.remedy.unwrap_or_default())
    };
    let (found, remedy) = told(960.0, 500.25, 1.0);
    assert_eq!(found, "the last sample is not usable: x, y are 960, 500.25; on the display they are 0 to 1");
    assert!(remedy.contains("pixels by its width and height") && remedy.contains("percent by 100"), "{remedy}");
    let (found, remedy) = told(960.0, 500.0, 0.0);
    assert!(found.contains("x, y are 960, 500") && found.contains("the confidence is 0.00"), "{found}");
    assert!(remedy.contains("missing_confidence"), "{remedy}");
    let (found, remedy) = told(-0.12, 0.5, 1.0);
    assert!(found.contains("-0.12, 0.5: beside the display"), "{found}");
    assert!(!remedy.contains("pixels"), "{remedy}");
    let (found, _) = told(0.5, 0.5, 0.42);
    assert_eq!(found, "the last sample is not usable: the confidence is 0.42, and must be 0.6 or more");
    assert!(told(0.5, 0.5, 0.9).0.contains("gaze is usable"));
}

#[test]
fn a_long_finding_of_the_checks_is_not_cut() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::Json;
    for step in 0..60 {
        stage.at(1.0 + f64::from(step) / 60.0, Event::Gaze(GazeSample::new(960.0, 500.0, 0.1)));
    }
    stage.key(KeyCode::Char('.'));
    for size in [(120, 40), (200, 60)] {
        stage.shows(size, &["0 to 1; the confidence is 0.10, and must be 0.6 or more"]);
    }
}

#[test]
fn a_trial_is_excluded_and_included_by_one_key() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('l');
    type_in(&mut stage, "inter");
    let excluded = Event::TrialExcluded { reason: "interrupted".to_string() };
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(excluded.clone()));
    stage.at(23.0, excluded);
    stage.shows((120, 40), &["EXCLUDED"]);
    stage.wait(1.0);
    assert_eq!(input(stage.control('l')), Some(Event::TrialIncluded));
    stage.at(30.0, Event::TrialIncluded);
    stage.at(31.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    stage.wait(1.0);
    stage.shows((120, 40), &["^l exclude the trial"]);
    stage.control('l');
    stage.wait(1.0);
    stage.key(KeyCode::Enter);
    let words = "the participant had to leave after a telephone call from the kindergarten";
    stage.paste(Some(words));
    let reason = format!("participant stopped: {words}");
    let excluded = Event::TrialExcluded { reason: reason.clone() };
    stage.wait(1.0);
    assert_eq!(input(stage.key(KeyCode::Enter)), Some(excluded.clone()));
    stage.at(40.0, excluded);
    // The card has the whole reason, and says which key takes it back.
    let lines = ["participant stopped: the participant had to leave after", "a telephone call from the kindergarten"];
    stage.shows((120, 40), &[&lines[..], &["^l include it again"]].concat());
}

#[test]
fn a_trial_starts_at_once_if_all_is_ok_and_what_was_found_is_recorded() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let Some(ConsoleCommand::Start(Event::Preflight { checks, overridden })) = stage.key(KeyCode::Char('.')) else {
        panic!("{}", stage.notice());
    };
    let names: Vec<&str> = checks.iter().map(|check| check.name.as_str()).collect();
    assert_eq!(names, ["participant", "gaze", "robot", "recording", "free space", "keyboard"]);
    assert!(!overridden && checks.iter().all(|check| check.verdict == PreflightVerdict::Ok), "{checks:?}");
    stage.at(0.0, Event::Preflight { checks, overridden });
    stage.at(0.0, Event::TrialStarted);
    stage.wait(1.0);
    stage.control('f');
    assert!(stage.notice().contains("only before the trial starts"), "{}", stage.notice());
}

#[test]
fn a_long_finding_of_a_check_is_whole_on_a_narrow_screen() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    let streams = ["tomcom-markers-P01", "tomcom-gaze-P01", "tomcom-beliefs-P01"];
    stage.model.lsl = Some(LslStatus { streams: streams.map(str::to_string).to_vec(), sent: 0, lost: 0 });
    stage.control('f');
    for stream in streams {
        stage.shows((80, 24), &[stream]);
    }
}

#[test]
fn what_is_not_ok_before_a_trial_is_listed_mended_or_overridden() {
    let mut stage = Stage::new("sushi", ParticipantKind::Keyboard);
    stage.session.spec.participant.gaze = GazeSource::Json;
    stage.at(0.1, Event::RobotStopped);
    stage.model.free_bytes = Some(100 << 20);
    assert_eq!(stage.key(KeyCode::Char('.')), None);
    assert_eq!(stage.model.dialog, Some(Dialog::Preflight));
    stage.shows_everywhere(&[
        "FAILED   gaze ",
        "start the program that sends gaze to port 50021",
        "FAILED   robot ",
        "warning  free space   104 MB free on the disk",
        "o start the trial anyway",
    ]);
    check_snapshot("console", "preflight_80x24", stage.screen((80, 24)));
    // The key that opened the list does not start the trial, held or pressed again.
    for gap_s in [0.5, 0.03, 1.0] {
        stage.wait(gap_s);
        assert_eq!(stage.key(KeyCode::Char('.')), None);
    }
    assert_eq!(input(stage.control('r')), Some(Event::RobotResumed));
    stage.at(3.0, Event::RobotResumed);
    let started = stage.key(KeyCode::Char('o'));
    let Some(ConsoleCommand::Start(Event::Preflight { checks, overridden: true })) = started else {
        panic!("{started:?}")
    };
    let verdict = |name: &str| checks.iter().find(|check| check.name == name).map(|check| check.verdict);
    assert_eq!(verdict("gaze"), Some(PreflightVerdict::Failed));
    assert_eq!(verdict("free space"), Some(PreflightVerdict::Warning));
    assert_eq!(verdict("robot"), Some(PreflightVerdict::Ok));
    // As soon as all is mended, the key that starts a trial starts it.
    stage.key(KeyCode::Char('.'));
    stage.model.free_bytes = Some(1 << 40);
    let found =
        GazeAccuracy { accuracy_deg: 0.5, corrected_deg: 0.4, precision_deg: 0.1, offset: [0.0; 2], targets: vec![] };
    stage.session.calibrated = Some(AcceptedGazeCheck { at: at(3.0), found, corrected: false });
    for step in 0..120 {
        stage.look(4.0 + f64::from(step) / 120.0, 0.5, 0.5);
    }
    stage.wait(0.01);
    stage.model.dialog = Some(Dialog::Preflight);
    stage.shows((80, 24), &["usable, confidence 0.97"]);
    assert!(matches!(
        stage.key(KeyCode::Char('.')),
        Some(ConsoleCommand::Start(Event::Preflight { overridden: false, .. }))
    ));
}

#[test]
fn an_upright_page_has_no_gaze_and_the_checks_say_so() {
    let check = |upright, gaze| {
        let page = Some(if upright { [1170, 2532] } else { [2532, 1170] });
        ParticipantDisplayHealth { page, upright, ..ParticipantDisplayHealth::default() }.check(gaze)
    };
    let mouse = check(true, GazeSource::Mouse);
    assert_eq!((mouse.verdict, mouse.found.as_str()), (PreflightVerdict::Warning, "1170x2532 upright"));
    assert!(mouse.remedy.is_some_and(|remedy| remedy.contains("turn the screen")), "on an upright page");
    assert_eq!(check(true, GazeSource::None).verdict, PreflightVerdict::Ok);
    assert_eq!(check(false, GazeSource::Mouse).verdict, PreflightVerdict::Ok);
}

#[test]
fn the_gaze_is_checked_by_targets_and_the_wizard_decides() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let begun = input(stage.control('v')).expect("a check begins");
    assert_eq!(begun, Event::Calibration(GazeCheckEvent::begin()));
    stage.at(1.0, begun);
    stage.at(2.0, Event::Calibration(GazeCheckEvent::TargetShown { target: 1 }));
    stage.shows_everywhere(&["+ look here: target 2 of 5"]);
    let target = |samples, accuracy_deg| TargetAccuracy { samples, accuracy_deg };
    let found = GazeAccuracy {
        accuracy_deg: 2.31,
        corrected_deg: 0.42,
        precision_deg: 0.19,
        offset: [0.02, -0.01],
        targets: vec![target(130, Some(2.1)), target(2, None), target(131, Some(2.6))],
    };
    stage.at(3.0, Event::Calibration(GazeCheckEvent::TargetsHidden));
    stage.at(3.0, Event::Calibration(GazeCheckEvent::Measured { found: Some(found) }));
    stage.shows_everywhere(&[
        "2.31 deg, 8.1 cm on the display: usable",
        "0.42 deg, 1.5 cm without the offset: good",
        "2.1, no gaze, 2.6 deg, centre target first",
    ]);
    check_snapshot("console", "calibration_80x24", stage.screen((80, 24)));
    stage.wait(1.0);
    // Letters choose, and only enter takes the gaze.
    for (letter, marked) in
        [('u', "enter    u  accept the gaze without"), ('o', "enter    o  accept the gaze with its")]
    {
        assert_eq!(stage.key(KeyCode::Char(letter)), None);
        assert!(stage.screen((80, 24)).contains(marked), "{}", stage.screen((80, 24)));
    }
    let accepted = input(stage.key(KeyCode::Enter));
    assert_eq!(accepted, Some(Event::Calibration(GazeCheckEvent::Accepted { corrected: true })));
    assert_eq!(stage.model.dialog, None);
}

#[test]
fn enter_takes_the_better_gaze_and_none_that_is_too_far_off() {
    let best = |accuracy_deg, corrected_deg| {
        let found =
            GazeAccuracy { accuracy_deg, corrected_deg, precision_deg: 0.2, offset: [0.0, 0.0], targets: Vec::new() };
        AccuracyCheckAction::for_result(Some(&found))
    };
    assert_eq!(best(2.0, 0.5), AccuracyCheckAction::Corrected);
    assert_eq!(best(1.0, 1.4), AccuracyCheckAction::AsItIs);
    assert_eq!(best(8.5, 9.7), AccuracyCheckAction::Repeat);
    assert_eq!(AccuracyCheckAction::for_result(None), AccuracyCheckAction::Repeat);
}

#[test]
fn a_check_without_enough_samples_can_be_repeated_or_left_and_not_accepted() {
    let mut stage = Stage::new("burger", ParticipantKind::Simulated);
    let begun = input(stage.control('v')).expect("a check begins");
    stage.at(1.0, begun);
    stage.at(2.0, Event::Calibration(GazeCheckEvent::TargetShown { target: 4 }));
    stage.at(3.0, Event::Calibration(GazeCheckEvent::TargetsHidden));
    stage.at(3.0, Event::Calibration(GazeCheckEvent::Measured { found: None }));
    stage.shows((120, 40), &["too few usable gaze samples"]);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('o')), None);
    for key in [KeyCode::Char('r'), KeyCode::Enter] {
        assert_eq!(input(stage.key(key)), Some(Event::Calibration(GazeCheckEvent::begin())));
        assert_eq!(stage.model.dialog, Some(Dialog::Calibration));
    }
    let left = input(stage.key(KeyCode::Esc));
    assert_eq!(left, Some(Event::Calibration(GazeCheckEvent::Dismissed)));
    assert_eq!(stage.model.dialog, None);
}
