//! Table of answers to questionnaires.

use crate::column::{CsvCell, CsvColumn, CsvRow, CsvTable};
use crate::trial_statistics::{QuestionnaireAnswer, TrialStatistics};
use tomcom_core::base::text::GUARDED;
use tomcom_session::questionnaire::AnswerValue;

/// Row of the table of questionnaires: an answer with the trial after which it was given.
#[derive(Clone, Copy, Debug)]
pub struct AnswerRow<'a> {
    trial: &'a TrialStatistics,
    answer: &'a QuestionnaireAnswer,
}

/// Rows of the table for the questionnaire answers given after a trial.
pub fn answers(trial: &TrialStatistics) -> impl Iterator<Item = AnswerRow<'_>> {
    trial.answers.iter().map(move |answer| AnswerRow { trial, answer })
}

impl CsvRow for AnswerRow<'_> {
    const TABLE: CsvTable = CsvTable::Questionnaires;

    fn columns() -> Vec<CsvColumn<Self>> {
        let given = format!(
            "answer as given (not reversed): a point of the scale from 1, a number, a slider's position from 0 to 100, words, \
             or ids of options separated by spaces; empty: skipped; {GUARDED}"
        );
        let score = "score of the whole questionnaire at this occasion, the same at all its items; empty: it has none, or an item \
                     was skipped";
        vec![
            Self::column("recording", "", "as in trials", |row| (&row.trial.recording).into()),
            Self::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
            Self::column(
                "condition",
                "",
                "condition of the trial before it, or of the first trial if it was asked before that",
                |row| row.trial.condition.name().into(),
            ),
            Self::column("questionnaire", "", "name", |row| (&row.answer.questionnaire).into()),
            Self::column("item", "", "id of the item", |row| (&row.answer.item).into()),
            Self::column("about", "", "construct that the item measures", |row| row.answer.about.as_ref().into()),
            Self::column("reversed", "", "whether agreement counts against the construct", |row| {
                row.answer.reversed.into()
            }),
            Self::column("answer", "", given, |row| match &row.answer.answer {
                Some(AnswerValue::Number(number)) => (*number).into(),
                Some(answer) => answer.cell().into(),
                None => CsvCell::Unknown,
            }),
            Self::column("points", "points", "number of points of the scale; empty: no scale", |row| {
                row.answer.points.into()
            }),
            Self::column("kind", "", "scale, choice, number, text or slider", |row| row.answer.kind.name().into()),
            Self::column("asked", "", "before the first trial, or after the trial", |row| {
                if row.answer.before { "before" } else { "after" }.into()
            }),
            Self::column("score", "", score, |row| row.answer.score.into()),
        ]
    }
}
