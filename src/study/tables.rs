//! The tables that other programs read: one row an observation, one column a variable (Wickham 2014, "Tidy Data"), and the
//! dictionary that says what each column means.

use serde::Serialize;

use super::effect::{StudyMeasure, pairs};
use super::trial::Trial;
use crate::communication::concept::ConceptName;
use crate::session::settings::ParticipantKind;

/// A table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Table {
    Participants,
    Trials,
    Questionnaires,
    Concepts,
    Actions,
    Communications,
    Beliefs,
    Gaze,
    Dictionary,
}

impl Table {
    pub const ALL: [Table; 9] = [
        Table::Participants,
        Table::Trials,
        Table::Questionnaires,
        Table::Concepts,
        Table::Actions,
        Table::Communications,
        Table::Beliefs,
        Table::Gaze,
        Table::Dictionary,
    ];
    /// Those that grow with what happens in a trial.
    pub const OF_EVENTS: [Table; 4] = [Table::Actions, Table::Communications, Table::Beliefs, Table::Gaze];

    /// The name of its file is this with `.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Table::Participants => "participants",
            Table::Trials => "trials",
            Table::Questionnaires => "questionnaires",
            Table::Concepts => "concepts",
            Table::Actions => "actions",
            Table::Communications => "communications",
            Table::Beliefs => "beliefs",
            Table::Gaze => "gaze",
            Table::Dictionary => "dictionary",
        }
    }

    /// Its columns, in their order.
    pub fn columns(self) -> impl Iterator<Item = &'static str> {
        super::dictionary::DICTIONARY.iter().filter(move |row| row.table == self.name()).map(|row| row.column)
    }
}

/// A row of the dictionary.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DictionaryRow {
    pub table: &'static str,
    pub column: &'static str,
    pub unit: &'static str,
    pub meaning: &'static str,
}

/// A participant with the trials that the assistance effect is told from.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ParticipantRow {
    pub participant: String,
    pub kind: String,
    pub group: Option<String>,
    pub trials: u64,
    pub trials_counted: u64,
    /// Whether the second trial is the assisted one.
    pub assisted_second: Option<bool>,
    pub error_rate_human_1: Option<f64>,
    pub error_rate_human_2: Option<f64>,
    pub error_rate_1: Option<f64>,
    pub error_rate_2: Option<f64>,
    pub sequence_length_1: Option<f64>,
    pub sequence_length_2: Option<f64>,
    pub recovery_s_1: Option<f64>,
    pub recovery_s_2: Option<f64>,
    pub order_s_1: Option<f64>,
    pub order_s_2: Option<f64>,
    pub presses_per_order_1: Option<f64>,
    pub presses_per_order_2: Option<f64>,
    pub press_s_1: Option<f64>,
    pub press_s_2: Option<f64>,
}

/// A press.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ActionRow {
    pub recording: String,
    pub seq: u64,
    pub time_s: f64,
    pub agent: &'static str,
    pub press: u64,
    pub button: String,
    pub effective: bool,
    pub since_s: Option<f64>,
    pub regret: Option<i32>,
    pub excess: Option<i32>,
    pub race: Option<bool>,
    pub error: Option<bool>,
    pub cause: Option<&'static str>,
    pub aspect: Option<String>,
    pub second_aspect: Option<String>,
    pub gain_nats: Option<f64>,
    pub sequence: Option<u64>,
    pub cause_estimated: Option<&'static str>,
    pub rater_1: Option<String>,
    pub rater_2: Option<String>,
    pub log_p: Option<f64>,
}

/// A communication that was sent, or would have been.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct CommunicationRow {
    pub recording: String,
    pub lane: String,
    pub time_s: f64,
    pub press: u32,
    pub kind: &'static str,
    pub target: Option<String>,
    pub matched: Option<bool>,
}

/// What was believed of an aspect before a press of the human.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BeliefRow {
    pub recording: String,
    pub seq: u64,
    pub aspect: String,
    pub truth: String,
    pub estimate: String,
    pub estimate_p_truth: f64,
    pub estimate_precision: f64,
    pub believed: Option<String>,
    pub believed_p_truth: Option<f64>,
}

/// A run of gaze samples on one location, or on none.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct GazeRow {
    pub recording: String,
    pub time_s: f64,
    pub duration_s: f64,
    pub location: Option<String>,
    pub x: f64,
    pub y: f64,
    pub confidence: f64,
    pub samples: u64,
}

/// An answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnswerRow {
    pub recording: String,
    pub participant: String,
    pub condition: String,
    pub questionnaire: String,
    pub item: String,
    pub about: Option<String>,
    pub reversed: bool,
    pub answer: Option<u8>,
    pub points: u8,
}

/// What a concept would have done in a participant's unassisted trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ConceptRow {
    pub recording: String,
    pub participant: String,
    pub concept: ConceptName,
    pub parameter: f64,
    pub presses: u64,
    pub signals: u64,
    pub related: u64,
    pub prevented: u64,
    pub outside: u64,
    pub false_presses: u64,
    pub false_inside: u64,
    pub harmless: u64,
}

/// A kind of participant as it stands in tables.
pub fn kind_name(kind: ParticipantKind) -> &'static str {
    match kind {
        ParticipantKind::Simulated => "simulated",
        ParticipantKind::Keyboard => "keyboard",
        ParticipantKind::Display => "display",
    }
}

/// The rows of [`Table::Participants`]; trials are in the order of participants.
pub fn participants(trials: &[Trial]) -> Vec<ParticipantRow> {
    let of_measure: Vec<_> = StudyMeasure::ALL.iter().map(|&measure| pairs(trials, measure)).collect();
    let row = |of_one: &[Trial]| {
        let participant = &of_one[0].participant;
        let values = |measure: StudyMeasure| {
            let index = StudyMeasure::ALL.iter().position(|&other| other == measure).unwrap_or(0);
            let found = of_measure[index].iter().find(|pair| pair.participant == *participant);
            [0, 1].map(|period| found.map(|pair| pair.values[period]))
        };
        let pair = of_measure[0].iter().find(|pair| pair.participant == *participant);
        let [error_rate_human_1, error_rate_human_2] = values(StudyMeasure::ErrorRateHuman);
        let [error_rate_1, error_rate_2] = values(StudyMeasure::ErrorRate);
        let [sequence_length_1, sequence_length_2] = values(StudyMeasure::SequenceLength);
        let [recovery_s_1, recovery_s_2] = values(StudyMeasure::RecoveryS);
        let [order_s_1, order_s_2] = values(StudyMeasure::OrderS);
        let [presses_per_order_1, presses_per_order_2] = values(StudyMeasure::PressesPerOrder);
        let [press_s_1, press_s_2] = values(StudyMeasure::PressS);
        ParticipantRow {
            participant: participant.clone(),
            kind: kind_name(of_one[0].kind).to_string(),
            group: of_one[0].group.clone(),
            trials: of_one.len() as u64,
            trials_counted: of_one.iter().filter(|trial| trial.counts()).count() as u64,
            assisted_second: pair.map(|pair| pair.assisted_second),
            error_rate_human_1,
            error_rate_human_2,
            error_rate_1,
            error_rate_2,
            sequence_length_1,
            sequence_length_2,
            recovery_s_1,
            recovery_s_2,
            order_s_1,
            order_s_2,
            presses_per_order_1,
            presses_per_order_2,
            press_s_1,
            press_s_2,
        }
    };
    trials.chunk_by(|a, b| a.participant == b.participant).map(row).collect()
}

/// The rows of a trial in [`Table::Questionnaires`].
pub fn answers(trial: &Trial) -> impl Iterator<Item = AnswerRow> + '_ {
    trial.answers.iter().map(|answered| AnswerRow {
        recording: trial.recording.clone(),
        participant: trial.participant.clone(),
        condition: trial.condition.name().to_string(),
        questionnaire: answered.questionnaire.clone(),
        item: answered.item.clone(),
        about: answered.about.clone(),
        reversed: answered.reversed,
        answer: answered.answer,
        points: answered.points,
    })
}

/// The rows of a trial in [`Table::Concepts`].
pub fn concepts(trial: &Trial) -> impl Iterator<Item = ConceptRow> + '_ {
    trial.swept.iter().map(|swept| ConceptRow {
        recording: trial.recording.clone(),
        participant: trial.participant.clone(),
        concept: swept.concept,
        parameter: swept.parameter,
        presses: swept.count.presses,
        signals: swept.count.signals,
        related: swept.count.related,
        prevented: swept.count.prevented,
        outside: swept.count.outside,
        false_presses: swept.count.false_presses,
        false_inside: swept.count.false_inside,
        harmless: swept.count.harmless,
    })
}
