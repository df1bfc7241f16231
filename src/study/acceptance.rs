//! Answers to questionnaires by condition, and how far participants accept the assistance.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::grouping::grouped;
use crate::statistics::{mean, sample_sd};
use crate::trial_statistics::{AskedItem, QuestionnaireAnswer, TrialStatistics};
use tomcom_session::study_arm::StudyArm;

/// Acceptance of the assistance: each participant's mean answer, after assisted trials, to the questionnaire items
/// about acceptance, from 0 (none) to 1 (full). Answers to items in which agreement means rejection are reversed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Acceptance {
    /// Number of participants with high acceptance: a mean answer above 2/3.
    pub high: u64,
    /// Number of participants with medium acceptance: a mean answer above 7/12, up to 2/3.
    pub medium: u64,
    /// Number of undecided participants: a mean answer within 1/12 of the middle (one point of a seven-point scale).
    pub undecided: u64,
    /// Number of participants with low acceptance: a mean answer below 5/12.
    pub low: u64,
    pub not_reported: u64,
    /// Mean acceptance over all participants, from 0 to 1; null without answers.
    pub mean: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ItemSummary {
    #[serde(flatten)]
    pub asked: AskedItem,
    /// Condition of the trial after which the item was asked; `None` for items asked before the trials.
    pub condition: Option<StudyArm>,
    /// Number of points of the rating scale; `None` for other kinds of item.
    pub points: Option<u8>,
    /// Number of answers at each scale point, from 1, or with each option, in the order of the item's options.
    pub counts: Vec<u64>,
    pub options: Vec<String>,
    pub answers: u64,
    pub left_out: u64,
    /// Mean of the item's answers that are numbers; reversed items are not reversed here.
    pub mean: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScoreSummary {
    pub questionnaire: String,
    /// `None`: before the trials.
    pub condition: Option<StudyArm>,
    pub scores: Vec<f64>,
    pub mean: Option<f64>,
    pub sd: Option<f64>,
}

fn asked_after(trial: &TrialStatistics, answered: &QuestionnaireAnswer) -> Option<StudyArm> {
    (!answered.before).then_some(trial.planned_arm)
}

/// An answer with the trial of whose recording it is.
type TrialAnswer<'a> = (&'a TrialStatistics, &'a QuestionnaireAnswer);

/// The answers that the analysis counts, in the order of the trials, which must be ordered by participant: those after
/// trials that count; and those before the trials, which are the participant's, whatever became of the trial, as long as
/// one of the participant's counts. Of a questionnaire that was asked before several recordings the last answers count.
pub(super) fn answers_that_count(trials: &[TrialStatistics]) -> Vec<TrialAnswer<'_>> {
    let mut counted = Vec::new();
    for own in trials.chunk_by(|a, b| a.participant == b.participant) {
        if !own.iter().any(TrialStatistics::counts) {
            continue;
        }
        for (index, trial) in own.iter().enumerate() {
            let is_asked_again = |answered: &QuestionnaireAnswer| {
                let is_it = |other: &QuestionnaireAnswer| {
                    other.before && other.asked.questionnaire == answered.asked.questionnaire
                };
                own[index + 1..].iter().any(|later| later.answers.iter().any(is_it))
            };
            let counts = |answered: &&QuestionnaireAnswer| match answered.before {
                true => !is_asked_again(answered),
                false => trial.counts(),
            };
            counted.extend(trial.answers.iter().filter(counts).map(|answered| (trial, answered)));
        }
    }
    counted
}

/// Scores of all questionnaires by condition, in the order in which questionnaires and conditions occur.
pub(super) fn scores(answers: &[TrialAnswer]) -> Vec<ScoreSummary> {
    // Every answer of an occasion has the occasion's score, so the score is taken from one answer only.
    let occasions = answers.chunk_by(|(trial, one), (other_trial, other)| {
        (&trial.recording, &one.asked.questionnaire, one.before)
            == (&other_trial.recording, &other.asked.questionnaire, other.before)
    });
    let scored = occasions.filter_map(|of_occasion| {
        let (trial, answered) = of_occasion[0];
        Some(((&answered.asked.questionnaire, asked_after(trial, answered)), answered.score?))
    });
    let summary = |((questionnaire, condition), scores): ((&String, Option<StudyArm>), Vec<f64>)| ScoreSummary {
        questionnaire: questionnaire.clone(),
        condition,
        mean: mean(scores.iter().copied()),
        sd: sample_sd(&scores),
        scores,
    };
    grouped(scored).into_iter().map(summary).collect()
}

/// Answers to the items of all questionnaires by condition, in the order in which items and conditions occur.
pub(super) fn items(answers: &[TrialAnswer]) -> Vec<ItemSummary> {
    let keyed = answers.iter().map(|&(trial, answered)| {
        let AskedItem { questionnaire, item, kind, .. } = &answered.asked;
        ((questionnaire, item, asked_after(trial, answered), *kind, answered.points), answered)
    });
    let groups = grouped(keyed).into_iter();
    groups.map(|((_, _, condition, ..), answers)| ItemSummary::from_answers(condition, &answers)).collect()
}

impl ItemSummary {
    /// `answers`: at least one.
    fn from_answers(condition: Option<StudyArm>, answers: &[&QuestionnaireAnswer]) -> ItemSummary {
        let first = answers[0];
        let mut counts = vec![0; first.points.map_or(first.options.len(), usize::from)];
        let mut numbers = Vec::new();
        for (answered, answer) in answers.iter().filter_map(|one| Some((one, one.answer.as_ref()?))) {
            numbers.extend(answer.number().map(|number| number as f64));
            let point = answer.number().filter(|_| answered.points.is_some());
            let options = answered.options.iter().enumerate();
            let chosen = options.filter(|(_, option)| answer.options().contains(&option.id));
            let counted = chosen.map(|(index, _)| index).chain(point.and_then(|point| usize::try_from(point - 1).ok()));
            for index in counted {
                if let Some(count) = counts.get_mut(index) {
                    *count += 1;
                }
            }
        }
        let answered = answers.iter().filter(|one| one.answer.is_some()).count();
        ItemSummary {
            asked: first.asked.clone(),
            condition,
            points: first.points,
            counts,
            options: first.options.iter().map(|option| option.text.clone()).collect(),
            answers: answered as u64,
            left_out: (answers.len() - answered) as u64,
            mean: mean(numbers.into_iter()),
        }
    }
}

pub(super) fn acceptance(trials: &[&TrialStatistics]) -> Option<Acceptance> {
    let mut by_participant: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for trial in trials.iter().filter(|trial| trial.is_assisted()) {
        for answered in trial.answers.iter().filter(|one| one.asked.about.as_deref() == Some("acceptance")) {
            let of_one = by_participant.entry(&trial.participant).or_default();
            of_one.extend(answered.share);
        }
    }
    if by_participant.is_empty() {
        return None;
    }
    let means: Vec<Option<f64>> = by_participant.into_values().map(|shares| mean(shares.into_iter())).collect();
    // The means are rounded in twelfths, so that means of whole scale points fall on the right side of a limit.
    let twelfths: Vec<f64> = means.iter().flatten().map(|mean| (12.0 * mean * 1e6).round() / 1e6).collect();
    let count = |is: fn(f64) -> bool| twelfths.iter().filter(|&&twelfths| is(twelfths)).count() as u64;
    Some(Acceptance {
        high: count(|twelfths| twelfths > 8.0),
        medium: count(|twelfths| twelfths > 7.0 && twelfths <= 8.0),
        undecided: count(|twelfths| (5.0..=7.0).contains(&twelfths)),
        low: count(|twelfths| twelfths < 5.0),
        not_reported: means.iter().filter(|mean| mean.is_none()).count() as u64,
        mean: mean(means.iter().flatten().copied()),
    })
}
