//! Answers to a questionnaire in the form that the tables need, and the questionnaire's score.

use crate::trial_statistics::QuestionnaireAnswer;
use tomcom_session::plan::{AnswerFormat, Questionnaire, QuestionnaireItem, QuestionnaireItemKind, ScoreRule};
use tomcom_session::protocol::StudyProtocolState;
use tomcom_session::{Session, TrialPhase};

/// Answers to the questionnaire that the participant has just confirmed.
pub(super) fn confirmed(session: &Session) -> Vec<QuestionnaireAnswer> {
    let (Some(questionnaire), Some(protocol)) = (session.questionnaire(), &session.protocol) else { return Vec::new() };
    let before = session.phase == TrialPhase::Ready;
    let score = score(questionnaire, protocol);
    let answered = |(index, item): (usize, &QuestionnaireItem)| {
        let form = questionnaire.form(index);
        QuestionnaireAnswer {
            questionnaire: questionnaire.name.clone(),
            item: item.id.clone(),
            text: item.text.clone(),
            about: item.about.clone(),
            reversed: item.reversed,
            kind: item.kind.unwrap_or(QuestionnaireItemKind::Scale),
            answer: protocol.given(index).cloned(),
            points: match form {
                Some(AnswerFormat::Scale(scale)) => Some(scale.points),
                _ => None,
            },
            options: item.options.clone(),
            share: share(questionnaire, protocol, index),
            before,
            score,
        }
    };
    questionnaire.items.iter().enumerate().map(answered).collect()
}

/// Answer to an item as a number from 0 to 1 on the item's scale, reversed if the item is reverse coded.
fn share(questionnaire: &Questionnaire, protocol: &StudyProtocolState, index: usize) -> Option<f64> {
    let [least, most] = questionnaire.form(index)?.ends()?;
    let share = (protocol.given(index)?.number()? - least) as f64 / (most - least).max(1) as f64;
    Some(if questionnaire.items.get(index)?.reversed { 1.0 - share } else { share })
}

/// Score of the questionnaire; `None` if the questionnaire has no scoring rule, or if an item was left out.
fn score(questionnaire: &Questionnaire, protocol: &StudyProtocolState) -> Option<f64> {
    let count = questionnaire.items.len();
    let shares: Option<Vec<f64>> = (0..count).map(|index| share(questionnaire, protocol, index)).collect();
    let shares = shares.filter(|shares| !shares.is_empty())?;
    match questionnaire.score? {
        ScoreRule::Mean => {
            let on_scale = |(index, share): (usize, &f64)| {
                let [least, most] = questionnaire.form(index)?.ends()?;
                Some(least as f64 + share * (most - least) as f64)
            };
            let sum: Option<f64> = shares.iter().enumerate().map(on_scale).sum();
            Some(sum? / count as f64)
        }
        // System Usability Scale: each item adds 0 to 4 points, and the sum of points is multiplied by 2.5 (Brooke
        // 1996).
        ScoreRule::Sus => Some(2.5 * shares.iter().map(|share| (4.0 * share).round()).sum::<f64>()),
    }
}
