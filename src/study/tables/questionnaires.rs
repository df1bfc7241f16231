//! Table of answers to questionnaires.

use crate::study::column::{Column, Table, TableRow};
use crate::study::trial_statistics::{QuestionnaireAnswer, Trial};

/// An answer with the trial after which it was given.
#[derive(Clone, Copy, Debug)]
pub struct AnswerRow<'a> {
    trial: &'a Trial,
    answer: &'a QuestionnaireAnswer,
}

/// Answers after a trial.
pub fn answers(trial: &Trial) -> impl Iterator<Item = AnswerRow<'_>> {
    trial.answers.iter().map(move |answer| AnswerRow { trial, answer })
}

impl TableRow for AnswerRow<'_> {
    const TABLE: Table = Table::Questionnaires;

    fn columns() -> Vec<Column<Self>> {
        let given = "answer from 1 to points, as given (not reversed); empty: skipped";
        vec![
            Self::column("recording", "", "as in trials", |row| (&row.trial.recording).into()),
            Self::column("participant", "", "as in participants", |row| (&row.trial.participant).into()),
            Self::column("condition", "", "condition of the preceding trial", |row| row.trial.condition.name().into()),
            Self::column("questionnaire", "", "name", |row| (&row.answer.questionnaire).into()),
            Self::column("item", "", "id of the item", |row| (&row.answer.item).into()),
            Self::column("about", "", "construct that the item measures", |row| row.answer.about.as_ref().into()),
            Self::column("reversed", "", "whether agreement counts against the construct", |row| {
                row.answer.reversed.into()
            }),
            Self::column("answer", "points", given, |row| row.answer.answer.into()),
            Self::column("points", "points", "number of points of the scale", |row| row.answer.points.into()),
        ]
    }
}
