//! The check of the gaze with targets, and the wizard's decision about it.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::gaze_check::AccuracyCheckAction;
use tomcom_core::gaze::calibration::{GazeAccuracy, TargetAccuracy};
use tomcom_session::event::Event;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::settings::ParticipantKind;

use super::{SIZES, Stage, input};
use crate::check_snapshot;

#[test]
fn the_gaze_is_checked_by_targets_and_the_wizard_decides() {
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    let begun = input(stage.control('v')).expect("a check begins");
    assert_eq!(begun, Event::Calibration(GazeCheckEvent::begin()));
    stage.at(1.0, begun);
    stage.at(2.0, Event::Calibration(GazeCheckEvent::TargetShown { target: 1 }));
    for size in SIZES {
        stage.shows(size, &["+ look here: target 2 of 5"]);
    }
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
    for size in SIZES {
        let off = ["2.31 deg, 8.1 cm on the display: usable", "0.42 deg, 1.5 cm without the offset: good"];
        stage.shows(size, &off);
        stage.shows(size, &["2.1, no gaze, 2.6 deg, centre target first"]);
    }
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
    assert!(stage.screen((120, 40)).contains("too few usable gaze samples"));
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
