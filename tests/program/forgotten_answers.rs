//! Answers to questionnaires from the recording to the tables, and what is left of them when the participant is forgotten.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tomcom::run::files::read_session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_session::engine::SessionEngine;
use tomcom_session::files::parse::parse;
use tomcom_session::log::LogWriter;
use tomcom_session::plan::{AnswerFormat, PhaseSpec, Questionnaire, QuestionnaireSpec, WantedRecording};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::settings::{GazeSource, ParticipantKind};
use tomcom_session::wall_display::AnswerDevice;
use tomcom_session::{Event, LogHeader, TrialPhase};

use crate::forgetting::{RecordingsFolder, ended};
use crate::program::files_below;

/// Words that stand in no other file.
const WORDS: &str = "zweiundvierzig violette Teekannen";
const CONSENT: &str = "I have read the information sheet.";

/// Records the first trial of the participant at this index, with questionnaires before and after it.
fn record(root: &Path, participant: usize, words: &str) {
    let mut files = read_session(Path::new("sessions/study.toml")).expect("the study");
    files.spec.trial.presses = 10;
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Simulated, GazeSource::Simulated);
    let plan = files.spec.plan.as_mut().expect("a plan");
    plan.consent = CONSENT.to_string();
    (plan.questionnaire, files.questionnaires) = (Vec::new(), Vec::new());
    for (name, before) in [("demographics.toml", true), ("nasa-tlx.toml", false), ("sus.toml", false)] {
        let path = Path::new("sessions/questionnaires").join(name);
        let text = fs::read_to_string(&path).expect("a questionnaire");
        plan.questionnaire.push(QuestionnaireSpec { file: name.to_string(), after: None, before });
        files.questionnaires.push(parse::<Questionnaire>(&path, &text).expect("a questionnaire"));
    }
    let study = files.study().expect("a plan");
    let (spec, trial) = study.settings(WantedRecording { participant, slot: 1, attempt: 1, instructed: true });
    let mut header = LogHeader::new(spec.clone(), trial, files.kitchen.layout, files.kitchen.recipes);
    header.started = Some("2026-03-14T09:00:00.000Z".to_string());
    let mut log = LogWriter::create_live(root, "2026-03-14", &header).expect("the folder can be written");
    let kitchen = Arc::new(files.kitchen.kitchen);
    let mut engine = SessionEngine::new(kitchen.clone(), spec, trial, CostToGo::new(kitchen));
    let mut tell = |engine: &mut SessionEngine, event: Event| {
        let time = engine.session().time + SessionTime::from_secs_f64(0.5);
        let outcome = engine.input(time, event.clone());
        assert_eq!(outcome.refused, None, "{event:?}");
        outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
        while engine.session().phase == TrialPhase::Running {
            engine.fire().iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
        }
    };
    tell(&mut engine, Event::Protocol(study.consent_given(AnswerDevice::Display)));
    let mut number = 0;
    while let Some(phase) = engine.session().next_phase() {
        number += 1;
        tell(&mut engine, Event::Protocol(ProtocolEvent::PhaseStarted { phase, number }));
        match engine.session().study_phase().cloned().expect("a phase") {
            PhaseSpec::Trial => tell(&mut engine, Event::TrialStarted),
            PhaseSpec::Questionnaire { questionnaire } => {
                for (index, item) in questionnaire.items.iter().enumerate() {
                    let answer = answer(&questionnaire, index, words);
                    let shown = ProtocolEvent::ItemShown { item: item.id.clone() };
                    tell(&mut engine, Event::Protocol(shown));
                    tell(&mut engine, Event::Protocol(ProtocolEvent::ItemAnswered { item: item.id.clone(), answer }));
                }
                tell(&mut engine, Event::Protocol(ProtocolEvent::AnswersConfirmed));
            }
            other => panic!("{other:?}"),
        }
    }
    tell(&mut engine, Event::SessionEnded);
}

/// Raw answers of worked examples: six sliders, and the completed form that Brooke (1996) prints.
fn answer(questionnaire: &Questionnaire, index: usize, words: &str) -> AnswerValue {
    let (tlx, sus) = ([55, 20, 70, 35, 60, 25], [5, 4, 2, 1, 2, 3, 2, 4, 5, 2]);
    match (questionnaire.name.as_str(), questionnaire.form(index).expect("a form")) {
        ("nasa-tlx", _) => AnswerValue::Number(tlx[index]),
        ("sus", _) => AnswerValue::Number(sus[index]),
        (_, AnswerFormat::Scale(_)) => AnswerValue::Number(3),
        (_, AnswerFormat::Number { .. }) => AnswerValue::Number(31),
        (_, AnswerFormat::Text { .. }) => AnswerValue::Text(words.to_string()),
        (_, form) => form.choose(1, None).expect("an option"),
    }
}

/// The files below a folder that have these bytes.
fn with_words(folder: &Path, words: &str) -> Vec<PathBuf> {
    let has = |path: &PathBuf| {
        let bytes = fs::read(path).expect("readable");
        bytes.windows(words.len()).any(|part| part == words.as_bytes())
    };
    files_below(folder).into_iter().filter(has).collect()
}

#[test]
fn answers_reach_the_tables_with_their_scores_and_are_forgotten_with_the_participant() {
    let folder = RecordingsFolder::empty("answers");
    record(&folder.root, 0, WORDS);
    record(&folder.root, 1, "somebody else");
    folder.study();
    let table = folder.text("study/questionnaires.csv");
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let heads = rows.headers().expect("a head").clone();
    let at =
        |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("no {name} in {heads:?}"));
    let found: Vec<csv::StringRecord> = rows.records().map(|row| row.expect("a row")).collect();
    let cell = |item: &str, column: &str| {
        let row = found.iter().find(|row| &row[at("participant")] == "P01" && &row[at("item")] == item);
        row.unwrap_or_else(|| panic!("no {item}"))[at(column)].to_string()
    };
    for (item, answer, kind, asked) in [
        ("age", "31", "number", "before"),
        ("gender", WORDS, "text", "before"),
        ("handedness", "left", "choice", "before"),
        ("vision_aids", "glasses", "choice", "before"),
        ("robots", "3", "scale", "before"),
        ("temporal", "70", "slider", "after"),
        ("complex", "4", "scale", "after"),
    ] {
        let row = (cell(item, "answer"), cell(item, "kind"), cell(item, "asked"));
        assert_eq!(row, (answer.to_string(), kind.to_string(), asked.to_string()), "{item}");
    }
    let score = |item: &str| cell(item, "score").parse::<f64>().expect("a score");
    assert!((score("mental") - 265.0 / 6.0).abs() < 1e-9, "the mean of the six sliders: {}", score("mental"));
    assert_eq!(score("easy"), 55.0, "the score of the form that Brooke prints");
    assert_eq!(cell("age", "score"), "", "a questionnaire without a rule has no score");
    let report = folder.text("study/report.html");
    assert!(report.contains("Scores by questionnaire and condition.") && report.contains("contact lenses: 0"));
    assert!(!report.contains(WORDS), "words stand in the table only");
    assert!(with_words(&folder.root, WORDS).len() >= 2, "in the log and in the table");

    ended(folder.forget(&["P01", "--yes"]), 0, &[]);
    for folder in [&folder.root, &folder.temporary] {
        assert_eq!(with_words(folder, WORDS), Vec::<PathBuf>::new());
    }
    let left = folder.text("study/questionnaires.csv");
    assert!(!left.contains("P01") && left.contains("somebody else"), "{left}");
}
