//! The study's tables: columns that are declared once, the rows and the dictionary that follow, and the files they go to.

use tomcom_core::communication::SignalKind;
use tomcom_core::measures::matching::{CommunicationEvent, ComparedContent};
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::protocol::StudyPhase;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};
use tomcom_session::wall_display::DisplayEvent;
use tomcom_study::column::{CsvRow, CsvTable, DataDictionaryRow, TableCell, TableColumn, described, dictionary};
use tomcom_study::files::export::AnalysisFolder;
use tomcom_study::frozen_plan::RecordedPlan;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope, RecordingAnalysis, WaivedPractice};
use tomcom_study::prevention::PreventionCounts;
use tomcom_study::roc::ConceptPreventionCounts;
use tomcom_study::study_part::AnalysedRecording;
use tomcom_study::tables::participants::{
    AnswerRow, ParticipantRow, TutorialAnswerCollector, TutorialQuestionRow, TutorialSummary, answers as answers_of,
    participants,
};
use tomcom_study::tables::trials::{HEADLINE, MEASURES};
use tomcom_study::trial_statistics::{TrialDetails, TrialStatistics};

use super::probes::one_right_answer;
use super::{answer, cell, read, record_person};
use crate::support::*;

/// The columns that other people's scripts may name. Columns are appended; none is renamed, moved or taken away.
const PUBLISHED: [(CsvTable, &str); 10] = [
    (
        CsvTable::Participants,
        "participant kind group trials trials_counted assisted_second error_rate_human_1 error_rate_human_2 \
         error_rate_1 error_rate_2 sequence_length_1 sequence_length_2 recovery_s_1 recovery_s_2 order_s_1 order_s_2 \
         presses_per_order_1 presses_per_order_2 press_s_1 press_s_2 additional_presses_per_order_1 \
         additional_presses_per_order_2 errors_1 errors_2 probes_wrong_1 probes_wrong_2 consent_on consent_at \
         consent_digest",
    ),
    (
        CsvTable::Trials,
        "recording participant kind seed group period condition assisted counts left_out ended arm human_presses \
         robot_presses errors races error_rate_human error_rate beliefs_from belief_related_errors sequences \
         sequence_length sequences_by_aspect sequence_length_by_aspect recovery_s orders order_s presses_per_order \
         press_s signals duration_s protective_stops faults contacts peak_force_n reduced_s safeguard_s \
         emergency_stops given_up_no_longer_useful given_up_stopped given_up_skipped given_up_driven \
         given_up_out_of_reach given_up_singular given_up_obstructed given_up_hand_in_the_way given_up_no_click \
         given_up_contact given_up_fault wizard_held wizard_skipped wizard_driven wizard_corrected useful_signals \
         useless_signals sequences_any_aspect sequence_length_any_aspect additional_presses_per_order \
         errors_about_orders errors_about_recipes errors_about_order_or_recipe errors_about_places offers \
         offers_taken offers_by_own_key offer_stood_s offer_reaction_s display_arm false_belief_episodes \
         raters_same_belief raters_other_belief one_rater_belief wizard_hits wizard_omissions probe_questions \
         probes_wrong study_arm planned_arm wizard_sees signal_contents unproven raters human_model \
         initiative_presses display_lost display_lost_s",
    ),
    (
        CsvTable::Questionnaires,
        "recording participant condition questionnaire item about reversed answer points kind asked score",
    ),
    (CsvTable::Tutorial, "recording participant tutorial step question first_answer right tries seconds"),
    (
        CsvTable::Concepts,
        "recording participant concept parameter presses signals related prevented outside false_presses false_inside \
         harmless contents useless beliefs_from lead_s",
    ),
    (
        CsvTable::Actions,
        "recording seq time_s agent press button effective since_s regret excess race error cause aspect \
         second_aspect gain_nats sequence cause_estimated rater_1 rater_2 log_p consensus false_since_s false_until_s",
    ),
    (CsvTable::Communications, "recording lane time_s press kind target matched offer"),
    (
        CsvTable::Beliefs,
        "recording seq aspect truth estimate estimate_p_truth estimate_precision believed believed_p_truth",
    ),
    (CsvTable::Gaze, "recording time_s duration_s location x y confidence samples"),
    (CsvTable::Dictionary, "table column unit meaning"),
];

fn folder(name: &str) -> PathBuf {
    empty_folder(format!("study-tables/{name}"))
}

/// What a recording of a person gives, with errors, signals and gaze.
fn analysis(name: &str) -> RecordingAnalysis {
    let folder = folder(name);
    record_person(&folder);
    read(&folder, "hand")
}

/// One press that is another one changes what follows from it.
#[test]
fn a_changed_log_is_refused_with_its_line() {
    let folder = folder("changed");
    let text = fs::read_to_string("tests/golden/format-3-simulated.jsonl").expect("a recording");
    let press =
        text.lines().position(|line| line.contains(r#""agent":"human","button":"take nori""#)).expect("a press");
    let changed =
        text.replacen(r#""agent":"human","button":"take nori""#, r#""agent":"human","button":"take rice""#, 1);
    fs::write(folder.join("events.jsonl"), changed).expect("a recording");
    let scope = AnalysisScope { concepts: false, events: true, raters: None };
    let error =
        reading::read(&folder, "changed", &scope, &mut KeptCost::default()).expect_err("another press").to_string();
    // The estimate stands below the press, and lines count from 1.
    assert!(error.contains(&format!("events.jsonl:{}: found an estimate", press + 2)), "{error}");
    assert!(error.contains("does not follow from the events before it"), "{error}");
}

/// A loss counts for as long as the trial's clock goes: neither before the trial nor in a pause.
#[test]
fn losses_of_the_display_are_counted_on_the_trials_clock() {
    let mut files = read_session(Path::new("sessions/default.toml")).expect("a session file of the project");
    (files.spec.participant.kind, files.spec.participant.gaze) = (ParticipantKind::Display, GazeSource::None);
    let header = LogHeader::new(files.spec.clone(), 0, files.kitchen.layout.clone(), files.kitchen.recipes.clone());
    let mut log = LogWriter::create_live(&folder("display-lost"), "2026-03-14", &header).expect("a folder");
    let (lost, back) = (
        || Event::Display(DisplayEvent::Lost),
        || Event::Display(DisplayEvent::Connected { width_px: 1920, height_px: 1080 }),
    );
    let events = [
        (0.5, back()),
        (1.0, lost()),
        (3.0, back()),
        (4.0, Event::TrialStarted),
        (5.0, lost()),
        (6.5, back()),
        (8.0, lost()),
        (9.0, Event::TrialPaused),
        (15.0, back()),
        (16.0, Event::TrialResumed),
        (20.0, Event::TrialEnded { reason: TrialEndReason::Wizard }),
        (21.0, Event::SessionEnded),
    ];
    let mut engine = engine_of(files, 0);
    for (time, event) in events {
        let outcome = engine.input(at(time), event);
        assert_eq!(outcome.refused, None);
        outcome.events.iter().for_each(|stamped| log.append(stamped).expect("the log can be written"));
    }
    drop(log.flush());
    let trial = read(log.folder(), "lost").trial;
    assert_eq!(cell(&trial, "display_lost"), TableCell::from(2_u64));
    assert_eq!(cell(&trial, "display_lost_s"), TableCell::from(2.5_f64));
    assert_eq!(cell(&analysis("no-display").trial, "display_lost"), TableCell::Unknown, "no display");
}

/// The first trial without signals, the second with them; the second has half the errors.
fn pair() -> [TrialStatistics; 2] {
    let second = TrialStatistics {
        participant: "P01".to_string(),
        period: Some(2),
        condition: Condition::Wizard,
        study_arm: StudyArm::Wizard,
        planned_arm: StudyArm::Wizard,
        left_out: None,
        order_s: Some(20.0),
        presses_per_order: Some(16.5),
        additional_presses_per_order: Some(1.5),
        ..analysis("pair").trial
    };
    let first = TrialStatistics {
        recording: "before".to_string(),
        period: Some(1),
        condition: Condition::None,
        study_arm: StudyArm::None,
        planned_arm: StudyArm::None,
        errors: second.errors * 2,
        order_s: Some(31.25),
        ..second.clone()
    };
    [first, second]
}

#[test]
fn published_columns_keep_their_names_and_places() {
    for (table, published) in PUBLISHED {
        let published: Vec<&str> = published.split(' ').collect();
        let columns = described(table);
        let names: Vec<&str> = columns.iter().map(|column| column.column.as_ref()).collect();
        assert!(names.len() >= published.len(), "{}: {names:?}", table.name());
        assert_eq!(names[..published.len()], published, "{}", table.name());
    }
}

#[test]
fn columns_have_names_of_their_own_that_need_no_quotes() {
    for &table in CsvTable::ALL {
        let columns = described(table);
        let names: BTreeSet<&str> = columns.iter().map(|column| column.column.as_ref()).collect();
        assert_eq!(names.len(), columns.len(), "{}", table.name());
        let is_plain = |name: &&str| name.chars().all(|sign| matches!(sign, 'a'..='z' | '0'..='9' | '_'));
        assert_eq!(names.iter().find(|name| !is_plain(name)), None, "{}", table.name());
    }
    let described: BTreeSet<CsvTable> = dictionary(&[]).map(|row| row.table).collect();
    assert_eq!(described, CsvTable::ALL.iter().copied().collect());
}

/// A statistic that is compared is declared once, and is then a column of trials and two of participants.
#[test]
fn statistics_stand_in_both_tables_with_the_same_values() {
    let trials =
        pair().map(|trial| TrialStatistics { probes: Some(one_right_answer(trial.condition).statistics()), ..trial });
    let rows: Vec<_> = participants(&trials, &[]).collect();
    let [participant] = &rows[..] else { panic!("one participant") };
    assert_eq!(cell(participant, "assisted_second"), TableCell::Flag(true));
    assert_eq!(MEASURES[0], HEADLINE);
    let names: BTreeSet<&str> = MEASURES.iter().map(|measure| measure.name).collect();
    assert_eq!(names.len(), MEASURES.len());
    for measure in MEASURES {
        let values = trials.each_ref().map(|trial| cell(trial, measure.name));
        assert_eq!(values.clone(), trials.each_ref().map(|trial| (measure.value)(trial).into()), "{}", measure.name);
        for (value, period) in values.into_iter().zip(1..) {
            assert_ne!(value, TableCell::Unknown, "{}", measure.name);
            assert_eq!(cell(participant, &format!("{}_{period}", measure.name)), value, "{}", measure.name);
        }
        let meanings = described(CsvTable::Participants).into_iter().filter(|row| row.column.starts_with(measure.name));
        let said: Vec<String> = meanings.map(|row| row.meaning.into_owned()).collect();
        assert!(said.iter().any(|text| text.contains("first")), "{said:?}");
        assert!(said.iter().all(|text| !text.contains("{}")), "{said:?}");
    }
}

/// A study of three trials each has columns for the third, and none that stays empty.
#[test]
fn participants_have_columns_for_all_of_their_trials() {
    let [first, second] = pair();
    let third = TrialStatistics { period: Some(3), errors: 7, ..first.clone() };
    let trials = [first, second, third];
    let columns = ParticipantRow::columns_of(&trials);
    let rows: Vec<_> = participants(&trials, &[]).collect();
    let value = |name: &str| columns.iter().find(|column| column.name == name).map(|column| column.cell(&rows[0]));
    for (trial, period) in trials.iter().zip(1..) {
        assert_eq!(value(&format!("errors_{period}")), Some((trial.errors as f64).into()));
    }
    assert_eq!((value("errors_4"), value("assisted_second")), (None, None));
    let listed: Vec<_> = dictionary(&trials).filter(|row| row.table == CsvTable::Participants).collect();
    assert!(listed.iter().map(|row| &row.column).eq(columns.iter().map(|column| &column.name)));
    assert!(listed.iter().any(|row| row.column == "errors_3" && row.meaning.contains("third")), "{listed:?}");
}

/// The fields of a column of a table in a folder.
fn fields(folder: &Path, table: CsvTable, column: &str) -> Vec<String> {
    let mut file = csv::Reader::from_path(folder.join(format!("{}.csv", table.name()))).expect("a table");
    let heads = file.headers().expect("a first line").clone();
    let index = heads.iter().position(|name| name == column).unwrap_or_else(|| panic!("no column {column}"));
    file.records().map(|row| row.expect("as many fields as the first line")[index].to_string()).collect()
}

/// No spreadsheet computes what a participant typed, and numbers stay numbers.
fn check_guarded_texts(folder: &Path, export: &AnalysisFolder) {
    let answer = |words| answer(QuestionnaireItemKind::Text, words);
    let typed = ["=HYPERLINK(\"http://lab\")", "+1 point", "-", "@all", "\tx", "= is fine inside =", "-0.5"];
    let mut answers: Vec<_> = typed.iter().map(|text| answer(AnswerValue::Text((*text).to_string()))).collect();
    answers.push(answer(AnswerValue::Number(-5)));
    let [first, _] = pair();
    let trial = TrialStatistics { answers, ..first };
    export.table::<AnswerRow>(answers_of(&trial)).expect("a table");
    let written = fields(folder, CsvTable::Questionnaires, "answer");
    let guarded =
        ["'=HYPERLINK(\"http://lab\")", "'+1 point", "'-", "'@all", "'\tx", "'= is fine inside =", "-0.5", "-5"];
    assert_eq!(written, guarded);
    let meanings = fields(folder, CsvTable::Dictionary, "meaning");
    assert!(meanings.iter().filter(|meaning| meaning.contains("a ' stands before words")).count() >= 3);
}

#[test]
fn tables_are_written_as_they_are_declared() {
    let folder = folder("written");
    let export = AnalysisFolder::create(&folder).expect("a folder");
    let [mut first, second] = pair();
    first.left_out = Some("excluded: \"slipped\", and\nleft".to_string());
    let trials = [first, second];
    assert_eq!(export.table::<TrialStatistics>(&trials).expect("a table"), Some(CsvTable::Trials));
    assert_eq!(export.table::<DataDictionaryRow>(dictionary(&trials)).expect("a table"), Some(CsvTable::Dictionary));
    assert_eq!(export.table::<TrialStatistics>(&[]).expect("a table"), None, "a table without rows");
    assert_eq!(fields(&folder, CsvTable::Trials, "recording"), Vec::<String>::new());
    export.table::<TrialStatistics>(&trials).expect("a table");
    let trial = |column: &str| fields(&folder, CsvTable::Trials, column);
    assert_eq!(trial("left_out"), ["excluded: \"slipped\", and\nleft", ""]);
    assert_eq!(trial("counts"), ["false", "true"]);
    assert_eq!(trial("period"), ["1", "2"]);
    assert_eq!(trial("order_s"), ["31.25", "20.0"]);
    // What a timed arm would have felt is unknown, and not nought.
    assert_eq!([trial("contacts"), trial("given_up_fault")], [["", ""], ["", ""]]);
    assert!(trial("given_up_stopped").iter().all(|count| count.parse::<u64>().is_ok()));
    check_guarded_texts(&folder, &export);
    // What is empty has its reason in the dictionary.
    for column in TrialStatistics::columns() {
        let is_empty = trials.iter().any(|trial| column.cell(trial) == TableCell::Unknown);
        assert!(!is_empty || column.meaning.contains("empty"), "{}: {}", column.name, column.meaning);
    }
    for column in ParticipantRow::columns() {
        let is_empty = participants(&trials, &[]).any(|one| column.cell(&one) == TableCell::Unknown);
        assert!(!is_empty || column.meaning.contains("empty"), "{}: {}", column.name, column.meaning);
    }
    let described = fields(&folder, CsvTable::Dictionary, "column");
    let of_trials: Vec<String> = fields(&folder, CsvTable::Dictionary, "table");
    let of_trials = of_trials.iter().zip(described).filter(|(table, _)| *table == "trials").map(|(_, column)| column);
    let heads: Vec<String> =
        TrialStatistics::columns().into_iter().map(|TableColumn { name, .. }| name.into_owned()).collect();
    assert_eq!(of_trials.collect::<Vec<_>>(), heads);
}

/// Analysed recordings come back from their files as they were, to the last digit.
#[test]
fn analysed_recordings_are_kept_in_files_until_all_are_read() {
    let folder = folder("kept");
    let RecordingAnalysis { trial, facts, .. } = analysis("kept-recording");
    let content = ComparedContent { kind: SignalKind::Highlight, target: Some(LocationId(3)) };
    let sent = CommunicationEvent { press: 7, clock: SessionTime(1_234_567_891), content };
    let count = PreventionCounts { presses: 90, lead_ms: 1_001, ..PreventionCounts::default() };
    let details = TrialDetails {
        offers: Vec::new(),
        lanes: Some([vec![sent], Vec::new()]),
        swept: vec![ConceptPreventionCounts { concept: ConceptName::TomCom, parameter: 0.1 + 0.2, count }],
        probes: Some(one_right_answer(Condition::None)),
    };
    let plan = RecordedPlan { participant: trial.participant.clone(), recorded_as: None, plan: None, place: None };
    let (reason, orders, presses, errors) = ("no time".to_string(), 0, 24, 9);
    let waived = WaivedPractice { participant: trial.participant.clone(), reason, orders, presses, errors };
    let words = format!("practice criterion not met, and waived: {} (no time; ", trial.participant);
    assert!(WaivedPractice::in_words(std::slice::from_ref(&waived)).is_some_and(|told| told.starts_with(&words)));
    let practice = AnalysedRecording {
        recording: "practice".to_string(),
        digest: String::new(),
        plan,
        correction: None,
        consent: None,
        tutorial: Vec::new(),
        waived: Some(waived),
        trial: None,
    };
    let recording = AnalysedRecording {
        recording: trial.recording.clone(),
        trial: Some((trial, details, facts)),
        ..practice.clone()
    };
    let export = AnalysisFolder::create(&folder).expect("a folder");
    export.keep_analysed(0, &recording).expect("a file");
    export.keep_analysed(1, &practice).expect("a file");
    assert_eq!(export.kept_analysed(0).expect("kept"), recording);
    assert_eq!(export.kept_analysed(1).expect("kept"), practice);
    drop(export);
    assert!(fs::read_dir(&folder).expect("a folder").next().is_none(), "nothing is left");
}

/// Rows of events go through files of their own, without a first line.
#[test]
fn tables_of_events_say_what_happened() {
    let folder = folder("events");
    let RecordingAnalysis { trial, rows, .. } = analysis("recording");
    let export = AnalysisFolder::create(&folder).expect("a folder");
    export.keep(0, &rows).expect("files");
    // Nobody could see an offer.
    let written: Vec<CsvTable> = CsvTable::OF_EVENTS.into_iter().filter(|&table| table != CsvTable::Offers).collect();
    assert_eq!(export.tables_of_events(&[0]).expect("tables"), written);
    drop(export);
    assert!(!folder.join(".rows").exists());
    let actions = |column: &str| fields(&folder, CsvTable::Actions, column);
    let agents = actions("agent");
    let count = |agent: &str| agents.iter().filter(|one| *one == agent).count() as u64;
    assert_eq!([count("human"), count("robot")], [trial.human_presses, trial.robot_presses]);
    let errors = actions("error").iter().filter(|error| *error == "true").count() as u64;
    assert_eq!((errors, errors > 0), (trial.errors, true));
    // Nothing is judged of the robot, and every press of the human is.
    let judged = actions("regret").iter().zip(&agents).all(|(regret, agent)| (agent == "human") != regret.is_empty());
    assert!(judged);
    let human: BTreeSet<String> =
        actions("seq").into_iter().zip(&agents).filter(|(_, agent)| *agent == "human").map(|(seq, _)| seq).collect();
    let believed: BTreeSet<String> = fields(&folder, CsvTable::Beliefs, "seq").into_iter().collect();
    assert_eq!(believed, human);
    let sequences: BTreeSet<String> = actions("sequence").into_iter().filter(|number| !number.is_empty()).collect();
    assert_eq!(sequences.len(), trial.beliefs.expect("an estimate").lengths.len());
    let sent = fields(&folder, CsvTable::Communications, "lane").len() as u64;
    assert_eq!((sent, sent > 0), (trial.signals, true));
}

/// The settings of the first recording of a participant of the study, in which the tutorial is.
fn settings(kind: ParticipantKind) -> SessionSpec {
    let mut files = session_file("study");
    files.spec.participant.kind = kind;
    let study = files.study().expect("a plan");
    study.settings(WantedRecording { participant: 0, slot: 0, attempt: 1, instructed: false }).0
}

/// The rows of these events, each with its time in seconds.
fn answers(spec: &SessionSpec, events: Vec<(f64, ProtocolEvent)>) -> Vec<TutorialQuestionRow> {
    let mut answers = TutorialAnswerCollector::new("first", spec).expect("a tutorial");
    for (seq, (time_s, event)) in events.into_iter().enumerate() {
        let time = at(time_s);
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
    assert_eq!(unanswered[5..7], [TableCell::Unknown, TableCell::Unknown], "a question that was left out is not wrong");
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
