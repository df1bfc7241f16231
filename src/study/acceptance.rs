//! The answers to questionnaires: each item by condition, and how participants take the assistance.

use std::collections::BTreeMap;

use serde::Serialize;

use super::trial_statistics::{Trial, mean};
use crate::session::settings::Condition;

/// Acceptance of the assistance: each participant's mean answer to the items about acceptance after assisted trials, from 0 (none)
/// to 1 (full). Answers to items in which agreement means rejection are reversed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Acceptance {
    /// Number of participants whose mean answer is above 2/3.
    pub high: u64,
    /// Number of participants whose mean answer is above 7/12, up to 2/3.
    pub medium: u64,
    /// Number of participants whose mean answer is within 1/12 of the middle (one point of a seven-point scale).
    pub undecided: u64,
    /// Number of participants whose mean answer is below 5/12.
    pub low: u64,
    /// Participants without answers to such items.
    pub not_reported: u64,
    /// Mean acceptance over participants.
    pub mean: Option<f64>,
}

/// Answers to one questionnaire item in one condition.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ItemSummary {
    /// The questionnaire's name.
    pub questionnaire: String,
    /// The item's id.
    pub item: String,
    /// The statement.
    pub text: String,
    /// What the item is about.
    pub about: Option<String>,
    /// Agreement speaks against what it is about.
    pub reversed: bool,
    /// The condition of the trial before.
    pub condition: Condition,
    /// Number of points of the scale.
    pub points: u8,
    /// Number of answers at each scale point, from 1.
    pub counts: Vec<u64>,
    /// How often the item was left without an answer.
    pub left_out: u64,
    /// Mean of the answers as given, in points.
    pub mean: Option<f64>,
}

/// Items of all questionnaires by condition, in order of occurrence.
pub(super) fn items(trials: &[&Trial]) -> Vec<ItemSummary> {
    let mut items: Vec<ItemSummary> = Vec::new();
    for trial in trials {
        for answered in &trial.answers {
            let is_it = |item: &ItemSummary| {
                (&item.questionnaire, &item.item, item.condition, item.points)
                    == (&answered.questionnaire, &answered.item, trial.condition, answered.points)
            };
            let at = match items.iter().position(is_it) {
                Some(at) => at,
                None => {
                    items.push(ItemSummary {
                        questionnaire: answered.questionnaire.clone(),
                        item: answered.item.clone(),
                        text: answered.text.clone(),
                        about: answered.about.clone(),
                        reversed: answered.reversed,
                        condition: trial.condition,
                        points: answered.points,
                        counts: vec![0; usize::from(answered.points)],
                        left_out: 0,
                        mean: None,
                    });
                    items.len() - 1
                }
            };
            match answered.answer.and_then(|answer| items[at].counts.get_mut(usize::from(answer).checked_sub(1)?)) {
                Some(count) => *count += 1,
                None => items[at].left_out += 1,
            }
        }
    }
    for item in &mut items {
        let given = item.counts.iter().enumerate();
        let answers = given.flat_map(|(index, &count)| std::iter::repeat_n((index + 1) as f64, count as usize));
        item.mean = mean(answers);
    }
    items
}

/// Acceptance from the answers in assisted trials; `None` without any answer.
pub(super) fn acceptance(trials: &[&Trial]) -> Option<Acceptance> {
    let mut by_participant: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for trial in trials.iter().filter(|trial| trial.is_assisted()) {
        for answered in trial.answers.iter().filter(|one| one.about.as_deref() == Some("acceptance")) {
            let of_one = by_participant.entry(&trial.participant).or_default();
            let Some(answer) = answered.answer.filter(|_| answered.points > 1) else { continue };
            let share = f64::from(answer.saturating_sub(1)) / f64::from(answered.points - 1);
            of_one.push(if answered.reversed { 1.0 - share } else { share });
        }
    }
    if by_participant.is_empty() {
        return None;
    }
    let means: Vec<Option<f64>> = by_participant.into_values().map(|shares| mean(shares.into_iter())).collect();
    // Acceptance in twelfths, rounded so that means of whole scale points fall on the correct side of a limit.
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
