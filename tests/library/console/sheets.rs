//! The sheets around a trial of a study plan: instruction, questionnaire, debriefing.

use std::path::Path;

use crossterm::event::KeyCode;
use tomcom::base::time::SessionTime;
use tomcom::console::ConsoleCommand;
use tomcom::console::form::{SheetContent, sheet};
use tomcom::edge::files::read_session;
use tomcom::session::Session;
use tomcom::session::event::{EndReason, Event};
use tomcom::session::plan::WantedRecording;
use tomcom::session::protocol::{ProtocolEvent, StudyPhase};
use tomcom::session::settings::ParticipantKind;

use super::{SIZES, Stage, kitchen};

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
        self.at(0.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
    }
}

#[test]
fn the_sheets_around_a_trial_fit_every_size() {
    for size in SIZES {
        let mut stage = planned(0, false);
        stage.model.size = size;
        let screen = stage.screen(size);
        for text in ["INSTRUCTION", "P01 familiarisation", "Ask for questions.", "this step is done"] {
            assert!(screen.contains(text), "{text:?} at {size:?} in\n{screen}");
        }
        let mut stage = planned(2, true);
        stage.model.size = size;
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(0.0, Event::TrialStarted);
        assert!(stage.screen(size).contains("P01 trial 2/2 wizard"), "{}", stage.screen(size));
        stage.at(9.0, Event::TrialEnded { reason: EndReason::Wizard });
        assert!(stage.screen(size).contains(". on to the questionnaire"), "{}", stage.screen(size));
        stage.at(9.0, Event::Protocol(ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 }));
        stage.at(9.0, Event::Protocol(ProtocolEvent::ItemAnswered { item: "too_often".to_string(), answer: 6 }));
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
    stage.at(9.0, Event::TrialEnded { reason: EndReason::Wizard });
    let questionnaire = ProtocolEvent::PhaseStarted { phase: StudyPhase::Questionnaire, number: 2 };
    stage.at(9.0, Event::Protocol(questionnaire));
    let Some(SheetContent::Questions(questionnaire)) = sheet(&stage.session) else { panic!("a questionnaire") };
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
