//! Answers to the questions of tutorials: the rows of their table, and their summary.

use std::path::Path;

use tomcom::edge::files::read_session;
use tomcom_core::base::time::SessionTime;
use tomcom_session::plan::WantedRecording;
use tomcom_session::protocol::{ProtocolEvent, StudyPhase};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};
use tomcom_session::{Event, SessionSpec, TimestampedEvent};
use tomcom_study::column::{CsvCell, CsvRow};
use tomcom_study::tables::participants::{TutorialAnswerCollector, TutorialQuestionRow, TutorialSummary};

/// The settings of the first recording of a participant of the study, in which the tutorial is.
fn settings(kind: ParticipantKind) -> SessionSpec {
    let mut files = read_session(Path::new("sessions/study.toml")).expect("a session file");
    files.spec.participant.kind = kind;
    let study = files.study().expect("a plan");
    study.settings(WantedRecording { participant: 0, slot: 0, attempt: 1, instructed: false }).0
}

/// The rows of these events, each with its time in seconds.
fn answers(spec: &SessionSpec, events: Vec<(f64, ProtocolEvent)>) -> Vec<TutorialQuestionRow> {
    let mut answers = TutorialAnswerCollector::new("first", spec).expect("a tutorial");
    for (seq, (time_s, event)) in events.into_iter().enumerate() {
        let time = SessionTime::from_secs_f64(time_s);
        answers.note(&TimestampedEvent { seq: seq as u64, time, event: Event::Protocol(event) });
    }
    answers.finish()
}

fn begun() -> ProtocolEvent {
    ProtocolEvent::PhaseStarted { phase: StudyPhase::Tutorial, number: 2 }
}

fn shown(step: &str) -> ProtocolEvent {
    ProtocolEvent::Tutorial(TutorialEvent::Shown { step: step.to_string(), by: TutorialPageTurner::Participant })
}

fn answered(step: &str, choice: u8) -> ProtocolEvent {
    ProtocolEvent::Tutorial(TutorialEvent::Answered { step: step.to_string(), choice })
}

#[test]
fn a_row_tells_the_first_answer_the_tries_and_the_time_to_the_right_one() {
    let spec = settings(ParticipantKind::Display);
    let events = vec![
        (1.0, begun()),
        (10.0, shown("ask_shape")),
        (14.0, answered("ask_shape", 1)),
        // The time counts from the first appearance, also after a look back.
        (16.0, shown("order")),
        (17.0, shown("ask_shape")),
        (20.0, answered("ask_shape", 3)),
        (21.0, shown("ask_crab")),
        (24.0, answered("ask_crab", 2)),
        (25.0, shown("ask_highlight")),
    ];
    let rows = answers(&spec, events);
    let found: Vec<_> = rows
        .iter()
        .map(|row| (row.step.as_str(), row.first_answer.as_deref(), row.tries, row.right, row.seconds))
        .collect();
    assert_eq!(
        found,
        [
            ("ask_shape", Some("Raw rice"), 2, Some(true), Some(10.0)),
            ("ask_crab", Some("It is cooked, then cut"), 1, Some(true), Some(3.0)),
            ("ask_highlight", None, 0, None, None),
        ]
    );
    let unanswered = rows[2].cells();
    assert_eq!(unanswered[5..7], [CsvCell::Unknown, CsvCell::Unknown], "a question that was left out is not wrong");
    let summary = TutorialSummary::from_answers(&rows);
    assert_eq!(summary, Some(TutorialSummary { participants: 1, questions: 2, right_at_once: 1 }));
}

#[test]
fn a_recording_in_which_no_tutorial_began_has_no_rows() {
    let spec = settings(ParticipantKind::Display);
    let instruction = ProtocolEvent::PhaseStarted { phase: StudyPhase::Instruction, number: 1 };
    assert!(answers(&spec, vec![(1.0, instruction)]).is_empty());
    assert_eq!(TutorialSummary::from_answers(&answers(&spec, vec![(1.0, begun())])), None);
    // At the keyboard there is no tutorial.
    assert!(TutorialAnswerCollector::new("first", &settings(ParticipantKind::Keyboard)).is_none());
}
