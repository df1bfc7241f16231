//! The wizard's hands in the kitchen: corrections, and the robot held, skipped and driven.

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::lists::{Picker, PickerKind};
use tomcom_core::communication::Sender;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::settings::ParticipantKind;

use super::{SIZES, Stage, input, type_in};
use crate::check_snapshot;

#[test]
fn the_kitchen_is_corrected_from_two_lists() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.control('u');
    for size in SIZES {
        let places = ["Correct the kitchen: which place?", "8 of 8", "» human hand", "robot hand", "raw salmon"];
        stage.shows(size, &places);
    }
    check_snapshot("console", "correct_80x24", stage.screen((80, 24)));
    type_in(&mut stage, "pot");
    stage.wait(0.05);
    assert_eq!(stage.key(KeyCode::Enter), None);
    let contents = ["What is really at cooking pot?", "14 of 14", "» raw rice", "cut crab", "enter choose"];
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
    assert!(stage.screen((120, 40)).contains("cooked rice"));
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
    stage.shows((80, 24), &["ROBOT HELD", "‖"]);
    let screen = stage.screen((120, 40));
    assert!(screen.contains("HELD") && screen.contains("^p releases the robot"), "{screen}");
    stage.wait(1.0);
    assert_eq!(input(stage.control('s')), Some(Event::RobotSkipped { by }));
    assert_eq!(stage.control('d'), None);
    let list = stage.shows((120, 40), &["The robot's next press", "15 of 15", "» assembly board"]);
    for (button, is_idle) in [("take tuna", true), ("plate  ", false), ("serve 2", true)] {
        let row = list.lines().find(|line| line.contains(&format!("│   {button}"))).expect(button);
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
