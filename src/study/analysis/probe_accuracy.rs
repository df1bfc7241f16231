//! Share of right answers in freeze probes: by state aspect, by what happened at the aspect's location, by condition;
//! and the effect of assistance.

use serde::Serialize;

use super::probe_record::{ProbeQuestionKind, ProbeResponse, ProbedQuestion, ProbedTrial, weighted_share};
use super::trial_bootstrap::interval_where_known;
use tomcom_session::study_arm::StudyArm;

/// The property of a question by which a table of accuracies is grouped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ProbeAccuracyGrouping {
    /// Questions are grouped by their kind: orders, recipes, other locations.
    Kind,
    /// Questions are grouped by the state aspect that they are about.
    Aspect,
    /// Questions are grouped by the time since the last change of the location.
    Age,
    /// Questions are grouped by whether the location changed since the participant last looked at it.
    Seen,
    /// Questions are grouped by the condition of the trial: who could send signals.
    Condition,
    /// Questions are grouped by whether the belief estimate took part in the choice of the questions.
    Choice,
    /// Questions are grouped by the participant's confidence in the answer.
    Confidence,
}

/// Share of right answers in one group of probe questions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeAnswerAccuracy {
    /// Property by which probe questions were grouped.
    pub by: ProbeAccuracyGrouping,
    /// Name of the group of probe questions.
    pub group: String,
    /// Number of questions in the group that were answered in time.
    pub n: u64,
    /// Number of questions answered with "I don't know", which counts as wrong.
    pub unsure: u64,
    /// Share of right answers, weighted by the inverse of the questions' inclusion probability.
    pub accuracy: Option<f64>,
    /// 95 % interval of the accuracy, by bootstrap over participants; null with fewer than five participants.
    pub interval: Option<[f64; 2]>,
}

/// Effect of assistance on situation awareness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SituationAwarenessEffect {
    /// Number of compared participants, who have answers in assisted and in unassisted trials.
    pub participants: u64,
    /// Mean over the compared participants of accuracy with assistance minus accuracy without.
    pub difference: f64,
    /// 95 % interval of the mean difference, by bootstrap over participants; null with fewer than five participants.
    pub interval: Option<[f64; 2]>,
}

/// Groups of questions by time since the location's last change: upper end in seconds, and name.
const AGES: [(f64, &str); 4] = [
    (5.0, "changed less than 5 s ago"),
    (15.0, "changed 5 to 15 s ago"),
    (60.0, "changed 15 to 60 s ago"),
    (f64::INFINITY, "changed more than 60 s ago"),
];

/// The groups to which a probe question belongs, in the order of the table.
fn groups(trial: &ProbedTrial, question: &ProbedQuestion) -> Vec<(ProbeAccuracyGrouping, usize, String)> {
    let kind = match question.kind {
        ProbeQuestionKind::Order => 0,
        ProbeQuestionKind::Recipe => 1,
        _ => 2,
    };
    let choice = ["drawn without the estimate", "drawn with the estimate"][usize::from(question.uses_estimate)];
    let mut groups = vec![
        (ProbeAccuracyGrouping::Kind, kind, question.kind.words().to_string()),
        (ProbeAccuracyGrouping::Aspect, 0, question.aspect.clone()),
        (ProbeAccuracyGrouping::Condition, trial.planned_arm as usize, trial.planned_arm.name().to_string()),
        (ProbeAccuracyGrouping::Choice, usize::from(question.uses_estimate), choice.to_string()),
    ];
    if let Some((frozen, changed_unseen)) =
        question.frozen.as_ref().and_then(|frozen| Some((frozen, frozen.changed_unseen?)))
    {
        groups.push(match frozen.changed_s {
            None => (ProbeAccuracyGrouping::Age, AGES.len(), "not changed in the trial".to_string()),
            Some(s) => {
                let age = AGES.iter().position(|(to, _)| s < *to).unwrap_or(AGES.len() - 1);
                (ProbeAccuracyGrouping::Age, age, AGES[age].1.to_string())
            }
        });
        let seen = ["not changed by others since the last look", "changed by others since the last look"];
        let index = usize::from(changed_unseen);
        groups.push((ProbeAccuracyGrouping::Seen, index, seen[index].to_string()));
    }
    if let Some(confidence) = question.confidence.filter(|_| question.response != ProbeResponse::Unsure) {
        let group = format!("confidence {confidence} of 3");
        groups.push((ProbeAccuracyGrouping::Confidence, usize::from(confidence), group));
    }
    groups
}

/// Accuracy in each group of each grouping, over the probe questions of the main results; `participants` holds the
/// trials of each participant.
pub fn accuracies(participants: &[Vec<&ProbedTrial>], seed: u64) -> Vec<ProbeAnswerAccuracy> {
    let mut all: Vec<(ProbeAccuracyGrouping, usize, String)> = participants
        .iter()
        .flatten()
        .flat_map(|trial| trial.counted().flat_map(|question| groups(trial, question)))
        .collect();
    all.sort();
    all.dedup();
    all.into_iter()
        .map(|key| {
            let is_in = |trial: &ProbedTrial, question: &ProbedQuestion| {
                question.is_counted() && groups(trial, question).contains(&key)
            };
            accuracy(participants, (key.0, &key.2), seed, is_in)
        })
        .collect()
}

/// Accuracy over the probe questions of one group.
pub fn accuracy(
    participants: &[Vec<&ProbedTrial>],
    (by, group): (ProbeAccuracyGrouping, &str),
    seed: u64,
    is_in: impl Fn(&ProbedTrial, &ProbedQuestion) -> bool,
) -> ProbeAnswerAccuracy {
    let of_one = |trials: &Vec<&ProbedTrial>| -> Vec<(f64, bool)> {
        let all = trials.iter().flat_map(|trial| trial.questions.iter().filter(|one| is_in(trial, one)));
        all.filter_map(|one| Some((one.weight(), !one.is_wrong()?))).collect()
    };
    let answers: Vec<Vec<(f64, bool)>> = participants.iter().map(of_one).collect();
    // The bootstrap needs only two sums of weights for each participant: of all answers, and of right ones.
    let sums: Vec<[f64; 2]> = answers
        .iter()
        .filter(|of_one| !of_one.is_empty())
        .map(|of_one| {
            let right = of_one.iter().filter(|(_, is_right)| *is_right).map(|(weight, _)| weight).sum();
            [of_one.iter().map(|(weight, _)| weight).sum(), right]
        })
        .collect();
    let share = |sums: &[[f64; 2]]| {
        let [all, right] = sums.iter().fold([0.0, 0.0], |[all, right], one| [all + one[0], right + one[1]]);
        (all > 0.0).then(|| right / all)
    };
    let questions =
        || participants.iter().flatten().flat_map(|trial| trial.questions.iter().filter(|one| is_in(trial, one)));
    ProbeAnswerAccuracy {
        by,
        group: group.to_string(),
        n: questions().filter(|one| one.is_wrong().is_some()).count() as u64,
        unsure: questions().filter(|one| one.response == ProbeResponse::Unsure).count() as u64,
        accuracy: weighted_share(answers.into_iter().flatten()),
        interval: interval_where_known(&sums, seed, share),
    }
}

/// The effect of assistance on the accuracy of answers, within participants; `None` if no participant has answers in
/// both assisted and unassisted trials.
pub fn awareness_effect(participants: &[Vec<&ProbedTrial>], seed: u64) -> Option<SituationAwarenessEffect> {
    let share = |trials: &[&ProbedTrial], assisted: bool| {
        let of = trials.iter().filter(|trial| (trial.planned_arm != StudyArm::None) == assisted);
        let answers = of.flat_map(|trial| trial.counted());
        weighted_share(answers.filter_map(|one| Some((one.weight(), !one.is_wrong()?))))
    };
    let differences: Vec<f64> =
        participants.iter().filter_map(|of| Some(share(of, true)? - share(of, false)?)).collect();
    let mean = |of: &[f64]| (!of.is_empty()).then(|| of.iter().sum::<f64>() / of.len() as f64);
    Some(SituationAwarenessEffect {
        participants: differences.len() as u64,
        difference: mean(&differences)?,
        interval: interval_where_known(&differences, seed, mean),
    })
}
