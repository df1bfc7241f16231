//! The study: statistics, what concepts would have prevented, tables and report.

mod arms;
mod effect;
mod headline;
mod numbers;
mod planned;
mod power;
mod prevention;
mod probes;
mod rater_episodes;
mod report;
mod tables;

use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::BeliefErrorCounts;
use tomcom_session::plan::QuestionnaireItemKind;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_study::analysis::offer_summary::OfferSummary;
use tomcom_study::column::{CsvRow, CsvTable, TableCell};
use tomcom_study::facts::RecordingFacts;
use tomcom_study::figures::StudySummary;
use tomcom_study::kept_cost::KeptCost;
use tomcom_study::pass::reading::{self, AnalysisScope, RecordingAnalysis};
use tomcom_study::robot_tally::RobotEventSummary;
use tomcom_study::trial_statistics::{
    AskedItem, DetailTotals, FalseBeliefErrors, QuestionnaireAnswer, SignalSenderWithParameter, TrialStatistics,
    arrange,
};

use crate::support::*;

fn near(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 1e-9 * wanted.abs().max(1.0), "{found} instead of {wanted}");
}

/// A trial of 200 presses of the human with this many errors, three of four of them belief related.
fn trial(participant: &str, period: u32, condition: Condition, errors: u64) -> TrialStatistics {
    let related = errors * 3 / 4;
    let lengths = if related > 0 { vec![related as u32] } else { Vec::new() };
    TrialStatistics {
        recording: format!("{participant}-{period}"),
        participant: participant.to_string(),
        seed: 1,
        kind: ParticipantKind::Simulated,
        started: None,
        group: Some("AB".to_string()),
        period: Some(period),
        is_planned: true,
        condition,
        study_arm: StudyArm::from_settings(condition, ConceptName::TomCom, false),
        planned_arm: StudyArm::from_settings(condition, ConceptName::TomCom, false),
        aims: None,
        wizard_sees: WizardVisibility::State,
        acting: SignalSenderWithParameter::from_settings(
            StudyArm::from_settings(condition, ConceptName::TomCom, false),
            1.5,
        ),
        left_out: None,
        human_model: "plain".to_string(),
        initiative_presses: 0,
        display_losses: None,
        ended: Some(TrialEndReason::Presses),
        arm: ArmKind::Timed,
        robot: RobotEventSummary::default(),
        human_presses: 200,
        robot_presses: 100,
        errors,
        races: 0,
        unproven: 0,
        beliefs: Some(FalseBeliefErrors {
            basis: BeliefSource::Recorded,
            errors: related,
            of_two: 0,
            causes: BeliefErrorCounts { places: related, ..BeliefErrorCounts::default() },
            lengths_any_aspect: lengths.clone(),
            lengths,
            recovery_s: vec![6.0],
            episodes: Some(1),
        }),
        orders: 12,
        order_s: Some(20.0),
        presses_per_order: Some(19.0),
        additional_presses_per_order: Some(2.5),
        press_s: Some(1.8),
        signals: 0,
        signal_contents: 0,
        useful_signals: None,
        display_arm: None,
        offers: OfferSummary::default(),
        seconds: 400.0,
        answers: Vec::new(),
        wizard: None,
        wizard_saw_advice: false,
        raters: None,
        shared_beliefs: None,
        settled_by: None,
        stale_consensus: None,
        probes: None,
    }
}

/// A trial of the human in this arm, of 200 presses.
fn in_arm(participant: String, period: u32, arm: StudyArm, errors: u64) -> TrialStatistics {
    TrialStatistics { participant, study_arm: arm, planned_arm: arm, ..trial("", period, arm.condition(), errors) }
}

/// An answer after a trial.
fn answer(kind: QuestionnaireItemKind, answer: AnswerValue) -> QuestionnaireAnswer {
    QuestionnaireAnswer {
        asked: AskedItem {
            questionnaire: "sheet".to_string(),
            item: "item".to_string(),
            text: "What did you think?".to_string(),
            about: None,
            reversed: false,
            kind,
        },
        answer: Some(answer),
        points: None,
        options: Vec::new(),
        share: None,
        before: false,
        score: None,
    }
}

/// The recording of a person, with errors, signals and gaze, in this empty folder.
fn record_person(folder: &Path) {
    fs::copy("tests/golden/format-3-hand.jsonl", folder.join("events.jsonl")).expect("a recording");
}

/// What this recording of a trial gives.
fn read(folder: &Path, name: &str) -> RecordingAnalysis {
    let scope = AnalysisScope { concepts: false, events: true, raters: None };
    let read = reading::read(folder, name, &scope, &mut KeptCost::default()).expect("a recording");
    read.expect("a trial").1
}

fn cell<'a, Row: CsvRow>(row: &'a Row, name: &str) -> TableCell<'a> {
    let columns = Row::columns();
    let column = columns.iter().find(|column| column.name == name).unwrap_or_else(|| panic!("no column {name}"));
    column.cell(row)
}

/// The figures of these trials alone.
fn summary(trials: &[TrialStatistics]) -> StudySummary {
    with_details(trials, DetailTotals::default())
}

fn with_details(trials: &[TrialStatistics], details: DetailTotals) -> StudySummary {
    StudySummary::from_trials(trials, details, &RecordingFacts::default(), 0)
}

/// The report with these figures, beside all tables.
fn page(figures: &StudySummary, trials: &[TrialStatistics]) -> String {
    tomcom_study::report::page(figures, trials, &RecordingFacts::default(), CsvTable::ALL)
}

/// Participants with errors in the first and in the second trial; those of the first list are assisted in the second one.
fn trials(assisted_second: &[[u64; 2]], assisted_first: &[[u64; 2]]) -> Vec<TrialStatistics> {
    let mut trials = Vec::new();
    for (group, errors) in [assisted_second, assisted_first].into_iter().enumerate() {
        for (index, errors) in errors.iter().enumerate() {
            for period in [1, 2] {
                let assisted = (group == 0) == (period == 2);
                let condition = if assisted { Condition::Wizard } else { Condition::None };
                let code = format!("{}{index}", ["A", "B"][group]);
                trials.push(trial(&code, period, condition, errors[period as usize - 1]));
            }
        }
    }
    arrange(&mut trials);
    trials
}
