//! The sheets around a trial of a study plan: instruction, questionnaire, debriefing.

use std::path::Path;

use crossterm::event::KeyCode;
use tomcom::console::ConsoleCommand;
use tomcom::console::form::{FormContent, sheet};
use tomcom::edge::files::read_session;
use tomcom_core::base::time::SessionTime;
use tomcom_session::Session;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::files::parse::parse;
use tomcom_session::plan::{QuestionnaireSpec, TutorialStepKind, WantedRecording};
use tomcom_session::protocol::{ProtocolEvent, StudyPhase};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};

use super::{SIZES, Stage};
use crate::{check_snapshot, kitchen};

/// The console of a recording of the study's first participant.
fn planned(slot: usize, instructed: bool) -> Stage {
    let study = read_session(Path::new("sessions/study.toml")).expect("the study").study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot, attempt: 1, instructed });
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session = Session::new(kitchen("sushi"), spec, 0);
    stage.next_phase();
    stage
}

impl Stage {
    fn next_phase(&mut self) {
        let (phase, number) = (self.session.next_phase(), self.session.protocol.as_ref().map(|it| it.number + 1));
        let (phase, number) = phase.zip(number).expect("one more phase");
        let now_s = self.session.time.as_secs_f64();
        self.at(now_s, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
    }
}

#[test]
fn the_sheets_around_a_trial_fit_every_size() {
    for size in SIZES {
        let mut stage = planned(0, false);
        stage.model.size = size;
        let screen = stage.screen(size);
        for text in ["INSTRUCTION", "P01 familiarisation", "Ask for questions.", "tick this step as done"] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        let mut stage = planned(2, true);
        stage.model.size = size;
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(0.0, Event::TrialStarted);
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
        assert!(stage.screen(size).contains(". next phase: questionnaire"), "{}", stage.screen(size));
        stage.at(9.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 }));
        stage.at(
            9.0,
            Event::Protocol(ProtocolEvent::ItemAnswered { item: "too_often".to_string(), answer: 6_u8.into() }),
        );
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemShown { item: "too_often".to_string() }));
        let screen = stage.screen(size);
        for text in [
            "QUESTIONNAIRE",
            "The signals were given too often.",
            "[6]",
            "strongly agree",
            "0 no answer",
            "enter next item",
        ] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        stage.at(9.0, Event::Protocol(ProtocolEvent::AnswersShown));
        let screen = stage.screen(size);
        assert!(screen.contains("6 The signals were given too often."), "{screen}");
        assert!(screen.contains("to the item without an answer"), "{screen}");
    }
}

#[test]
fn the_keys_of_a_sheet_make_events_and_a_held_one_answers_once() {
    let mut stage = planned(0, false);
    let told = |command: Option<ConsoleCommand>| match command {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    let first = told(stage.key(KeyCode::Enter));
    assert_eq!(first, ProtocolEvent::Ticked { step: 1, done: true });
    stage.at(0.0, Event::Protocol(first));
    // The key is still down: nothing more is ticked.
    assert_eq!(stage.key(KeyCode::Enter), None);
    stage.model.clock = SessionTime::from_secs_f64(2.0);
    for arrow in [KeyCode::Right, KeyCode::Left, KeyCode::Down, KeyCode::Up] {
        assert_eq!(stage.key(arrow), None, "arrows tick nothing");
        assert!(stage.notice().contains("enter ticks the step"), "{}", stage.notice());
    }
    assert_eq!(stage.key(KeyCode::Char('.')), None, "the start key leaves only what is complete");
    assert!(!stage.notice().is_empty());
    assert_eq!(told(stage.key(KeyCode::Backspace)), ProtocolEvent::Ticked { step: 1, done: false });
    // Signals, markers and the kitchen wait for the trial; the robot stop does not.
    assert_eq!(stage.key(KeyCode::Char('q')), None);
    assert_eq!(stage.key(KeyCode::Char('1')), None);
    assert_eq!(stage.key(KeyCode::Char(' ')), Some(ConsoleCommand::Input(Event::RobotStopped)));
}

#[test]
fn only_enter_confirms_answers_and_a_reason_to_go_on() {
    let told = |command: Option<ConsoleCommand>| match command {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    let mut stage = planned(2, true);
    stage.at(0.0, Event::TrialStarted);
    stage.at(9.0, Event::TrialEnded { reason: TrialEndReason::Wizard });
    let questionnaire = ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 };
    stage.at(9.0, Event::Protocol(questionnaire));
    let Some(FormContent::Questions(questionnaire)) = sheet(&stage.session) else { panic!("a questionnaire") };
    let items = questionnaire.items.len();
    let tell = |stage: &mut Stage, key: KeyCode| {
        stage.wait(1.0);
        let event = told(stage.key(key));
        let now = stage.model.now.as_secs_f64();
        stage.at(now, Event::Protocol(event.clone()));
        event
    };
    for arrow in [KeyCode::Right, KeyCode::Left] {
        assert!(matches!(tell(&mut stage, arrow), ProtocolEvent::ItemShown { .. }), "arrows go between items");
    }
    // An answer shows the next item.
    for _ in 0..items {
        assert!(matches!(tell(&mut stage, KeyCode::Char('3')), ProtocolEvent::ItemAnswered { .. }));
    }
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Right), None, "{}", stage.notice());
    assert!(stage.notice().contains("enter confirms"), "{}", stage.notice());
    stage.wait(1.0);
    assert_eq!(told(stage.key(KeyCode::Enter)), ProtocolEvent::AnswersConfirmed);
}

/// The sheet of a questionnaire about the person: an item of every kind.
#[test]
fn numbers_and_words_are_typed() {
    let mut stage = asked(&["demographics.toml"]);
    // A number is checked before it is sent.
    write(&mut stage, "7");
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("out of the item's range"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    write(&mut stage, "31");
    assert_eq!(answered(&mut stage, KeyCode::Enter), "age 31");
    // Words may have spaces and full stops, which are keys of the console elsewhere.
    write(&mut stage, "q. x y");
    look_at(&mut stage, &["What is your gender?", " q. x y ", "enter save the text", "letters type answer"]);
    assert_eq!(answered(&mut stage, KeyCode::Enter), r#"gender "q. x y""#);
}

#[test]
fn a_paste_is_typed_into_an_item_that_is_answered_by_typing_and_no_other() {
    let mut stage = asked(&["demographics.toml"]);
    assert_eq!(stage.paste(Some("7,5")), None);
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("whole number"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    stage.key(KeyCode::Backspace);
    assert_eq!(stage.paste(Some("5\n")), None);
    assert_eq!(answered(&mut stage, KeyCode::Enter), "age 75");
    assert_eq!(stage.paste(Some("please call me")), None);
    assert_eq!(answered(&mut stage, KeyCode::Enter), r#"gender "please call me""#);
    assert_eq!(stage.paste(Some("2")), None);
    assert!(stage.notice().contains("paste only into a text field"), "{}", stage.notice());
}

#[test]
fn options_are_chosen_with_digits() {
    let mut stage = asked(&["demographics.toml"]);
    write(&mut stage, "31");
    give(&mut stage, KeyCode::Enter);
    write(&mut stage, "q. x y");
    give(&mut stage, KeyCode::Enter);
    stage.wait(1.0);
    assert_eq!(stage.key(KeyCode::Char('4')), None, "the item has three options");
    assert_eq!(answered(&mut stage, KeyCode::Char('2')), r#"handedness "left""#);
    // Of several, each key chooses one or takes it back; the item stays until enter.
    assert_eq!(answered(&mut stage, KeyCode::Char('3')), r#"vision_aids ["lenses"]"#);
    assert_eq!(answered(&mut stage, KeyCode::Char('2')), r#"vision_aids ["glasses","lenses"]"#);
    assert_eq!(answered(&mut stage, KeyCode::Char('3')), r#"vision_aids ["glasses"]"#);
    look_at(
        &mut stage,
        &["What do you wear today to see well?", "[2] glasses", " 3  contact lenses", "1-4 choose several"],
    );
    stage.model.size = (80, 24);
    check_snapshot("console", "item_choice_80x24", stage.screen((80, 24)));
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::ItemShown { item: "colour_vision".to_string() });
    assert_eq!(give(&mut stage, KeyCode::Delete), ProtocolEvent::ItemSkipped { item: "colour_vision".to_string() });
    for _ in 0..3 {
        give(&mut stage, KeyCode::Char('5'));
    }
    let screen = stage.screen((120, 40));
    assert!(screen.contains("31 years") && screen.contains("q. x y") && screen.contains("glasses"), "{screen}");
    assert_eq!(give(&mut stage, KeyCode::Enter), ProtocolEvent::AnswersConfirmed);
}

#[test]
fn the_position_of_a_slider_is_typed_in_its_steps() {
    let mut stage = asked(&["nasa-tlx.toml"]);
    write(&mut stage, "42");
    assert_eq!(stage.key(KeyCode::Enter), None);
    assert!(stage.notice().contains("steps"), "{}", stage.notice());
    stage.key(KeyCode::Backspace);
    write(&mut stage, "5");
    assert_eq!(answered(&mut stage, KeyCode::Enter), "mental 45");
    let steps = "from 0 (very low) to 100 (very high), in steps of 5";
    look_at(&mut stage, &["Mental demand: How mentally demanding was the task?", steps, " 45 ", "0-9 type position"]);
}

/// The event that a key sends, which then happens.
fn give(stage: &mut Stage, key: KeyCode) -> ProtocolEvent {
    stage.wait(1.0);
    let event = match stage.key(key) {
        Some(ConsoleCommand::Input(Event::Protocol(event))) => event,
        other => panic!("{other:?}"),
    };
    stage.at(stage.model.now.as_secs_f64(), Event::Protocol(event.clone()));
    event
}

/// The item and the answer that a key gives.
fn answered(stage: &mut Stage, key: KeyCode) -> String {
    match give(stage, key) {
        ProtocolEvent::ItemAnswered { item, answer } => format!("{item} {}", serde_json::json!(answer)),
        other => panic!("{other:?}"),
    }
}

fn write(stage: &mut Stage, words: &str) {
    for letter in words.chars() {
        assert_eq!(stage.key(KeyCode::Char(letter)), None, "{letter}: {}", stage.notice());
    }
}

/// The sheet at every size has to say all of this.
fn look_at(stage: &mut Stage, words: &[&str]) {
    for size in SIZES {
        stage.model.size = size;
        stage.shows(size, words);
    }
}

#[test]
fn the_sheet_of_the_tutorial_tells_where_the_participant_is() {
    for size in SIZES {
        let study = read_session(Path::new("sessions/study.toml")).expect("the study").study().expect("a plan");
        let mut stage = Stage::new("sushi", ParticipantKind::Display);
        let spec = study.tutorial_alone("P07").expect("a tutorial");
        stage.session = Session::new(kitchen("sushi"), spec, 0);
        stage.next_phase();
        let mut now_s = 0.0;
        let mut give = |stage: &mut Stage, event| {
            now_s += 1.0;
            stage.at(now_s, Event::Protocol(ProtocolEvent::Tutorial(event)));
        };
        while let Some((step, state)) = stage.session.tutorial_step() {
            let (step, index) = (step.clone(), state.step);
            if step.kind == TutorialStepKind::Question {
                // Wrong at first.
                let right = step.right.expect("a right choice");
                let wrong = right % step.choices.len() as u8 + 1;
                for choice in [wrong, right] {
                    give(&mut stage, TutorialEvent::Answered { step: step.id.clone(), choice });
                }
                break;
            }
            for button in &step.presses {
                give(&mut stage, TutorialEvent::Pressed { button: button.clone() });
            }
            let (tutorial, _) = stage.session.tutorial().expect("a tutorial");
            let next = tutorial.steps[index + 1].id.clone();
            give(&mut stage, TutorialEvent::Shown { step: next, by: TutorialPageTurner::Wizard });
        }
        stage.model.size = size;
        let screen = stage.screen(size);
        for text in ["Tutorial of the participant", "wrong answers: 1", "0 ends the tutorial"] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        if size == SIZES[0] {
            check_snapshot("console", "tutorial_80x24", screen);
        }
    }
}

/// The console of a recording that begins with these questionnaires.
fn asked(names: &[&str]) -> Stage {
    let mut files = read_session(Path::new("sessions/study.toml")).expect("the study");
    let plan = files.spec.plan.as_mut().expect("a plan");
    (plan.questionnaire, files.questionnaires) = (Vec::new(), Vec::new());
    for name in names {
        let path = Path::new("sessions/questionnaires").join(name);
        let text = std::fs::read_to_string(&path).expect("a questionnaire");
        let file = path.display().to_string();
        plan.questionnaire.push(QuestionnaireSpec { file, after: None, before: true });
        files.questionnaires.push(parse(&path, &text).expect("a questionnaire"));
    }
    let study = files.study().expect("a plan");
    let (spec, _) = study.settings(WantedRecording { participant: 0, slot: 1, attempt: 1, instructed: true });
    let mut stage = Stage::new("sushi", ParticipantKind::Simulated);
    stage.session = Session::new(kitchen("sushi"), spec, 0);
    stage.next_phase();
    stage
}
