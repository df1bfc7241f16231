//! Results of freeze probes: what participants knew, and how well the estimate predicted their beliefs.

use serde::Serialize;

use super::probe_accuracy::{
    ProbeAccuracyGrouping, ProbeAnswerAccuracy, SituationAwarenessEffect, accuracies, accuracy, awareness_effect,
};
use super::probe_detection::{ProbeDetection, WeightedProbeBelief};
use super::probe_record::{ProbeQuestionKind, ProbeResponse, ProbedQuestion, ProbedTrial};
use super::probe_scores::ProbeLogScores;
use super::trial_bootstrap::interval_where_known;
use tomcom_core::measures::raters::BeliefSource;
use tomcom_session::probes::ProbeOrigin;

/// Seed of the bootstrap's random numbers: the same answers give the same intervals.
const SEED: u64 = 1;

/// Results of the freeze probes of a study. Main results are over scheduled questions about the present state (level 1)
/// that were answered in time; the questions that the main results leave out are counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeSummary {
    /// Source of what participants believed: recorded beliefs, or answers to freeze probes.
    pub beliefs_from: BeliefSource,
    /// Number of participants with a probe question in the main results.
    pub participants: u64,
    /// Numbers of probes and questions, and how many questions the main results include.
    pub counts: ProbeCounts,
    /// Accuracy of the belief estimate, measured by the answers to freeze probes.
    #[serde(flatten)]
    pub detection: ProbeDetection,
    /// 95 % interval of `detection.auc` by bootstrap over participants; null with fewer than five participants.
    pub auc_interval: Option<[f64; 2]>,
    /// 95 % interval of `detection.ece` by bootstrap over participants; null with fewer than five participants.
    pub ece_interval: Option<[f64; 2]>,
    /// Area under the ROC curve without weights of questions, which is biased, since the estimate took part in the
    /// choice of questions.
    pub auc_unweighted: Option<f64>,
    /// How well the answers to freeze probes are predicted by the estimate and by baselines.
    pub log_scores: ProbeLogScores,
    /// Share of right answers over all questions of the main results.
    pub accuracy: ProbeAnswerAccuracy,
    /// Share of right answers in groups of questions: by state aspect, by change of the location, by condition.
    pub accuracies: Vec<ProbeAnswerAccuracy>,
    /// Effect of assistance on situation awareness; null if no participant has answers with and without assistance.
    pub assistance: Option<SituationAwarenessEffect>,
    /// Share of right answers to questions about what comes next (level 2 of situation awareness), which are not in the
    /// main results.
    pub level_2: Vec<ProbeAnswerAccuracy>,
    /// For simulated participants, accuracy of the estimate measured by what the participants believed, at the same
    /// probe questions; null for people.
    pub by_true_beliefs: Option<RecordedBeliefComparison>,
}

/// Numbers of freeze probes and of their questions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProbeCounts {
    /// Number of freeze probes that began.
    pub probes: u64,
    /// Number of freeze probes that did not begin in time and were dropped.
    pub dropped: u64,
    /// Number of freeze probes of which the wizard skipped remaining questions.
    pub skipped: u64,
    /// Number of questions that were shown to participants.
    pub questions: u64,
    /// Number of questions in the main results.
    pub counted: u64,
    /// Number of questions in the main results that were answered with "I don't know".
    pub unsure: u64,
    /// Number of questions left out because they were not answered in time.
    pub unanswered: u64,
    /// Number of questions left out because the wizard skipped the rest of the probe while they were shown.
    pub questions_skipped: u64,
    /// Number of answered questions left out because the wizard, not the schedule, started the probe.
    pub by_wizard: u64,
    /// Number of answered questions left out because they ask what comes next.
    pub level_2: u64,
    /// Effective sample size of the main results: the number of questions of equal weight that would be as informative
    /// as the weighted questions (Kish 1965).
    pub effective: f64,
}

/// Comparison of probe answers with what simulated participants believed, at the questions of the main results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordedBeliefComparison {
    /// Number of probe questions for which the participant's belief is recorded.
    pub n: u64,
    /// Share of the questions with a recorded belief where answer and belief are both right or both wrong.
    pub agreement: f64,
    /// Accuracy of the belief estimate, measured by recorded beliefs.
    #[serde(flatten)]
    pub detection: ProbeDetection,
    /// Accuracy of the belief estimate at the same questions, measured by the participants' answers.
    pub by_answers: ProbeDetection,
}

impl ProbeSummary {
    /// Results of the freeze probes of these trials, each given with its participant's code; `None` if no question was
    /// shown.
    pub fn from_trials<'a>(trials: impl IntoIterator<Item = (&'a str, &'a ProbedTrial)>) -> Option<ProbeSummary> {
        let participants = by_participant(trials);
        let counts = ProbeCounts::from_trials(participants.iter().flatten().copied());
        (counts.questions > 0).then_some(())?;
        let beliefs: Vec<Vec<WeightedProbeBelief>> = participants.iter().map(|trials| beliefs(trials)).collect();
        let known: Vec<&Vec<WeightedProbeBelief>> = beliefs.iter().filter(|of_one| !of_one.is_empty()).collect();
        let pooled = |of: &[&Vec<WeightedProbeBelief>]| -> ProbeDetection {
            ProbeDetection::from_beliefs(&of.iter().flat_map(|one| one.iter().copied()).collect::<Vec<_>>())
        };
        let all: Vec<WeightedProbeBelief> = beliefs.iter().flatten().copied().collect();
        let unweighted: Vec<WeightedProbeBelief> = all.iter().map(|one| one.unweighted()).collect();
        let numbered: Vec<(usize, &ProbedQuestion)> = beliefs
            .iter()
            .enumerate()
            .flat_map(|(participant, of_one)| of_one.iter().map(move |one| (participant, one.question)))
            .collect();
        let level_2 = [ProbeQuestionKind::NextOrder, ProbeQuestionKind::NextPress].into_iter().map(|kind| {
            let is_it = |_: &ProbedTrial, one: &ProbedQuestion| one.kind == kind && one.origin == ProbeOrigin::Schedule;
            accuracy(&participants, (ProbeAccuracyGrouping::Kind, kind.words()), SEED, is_it)
        });
        let is_counted = |_: &ProbedTrial, one: &ProbedQuestion| one.is_counted();
        Some(ProbeSummary {
            beliefs_from: BeliefSource::Probes,
            participants: known.len() as u64,
            counts,
            detection: ProbeDetection::from_beliefs(&all),
            auc_interval: interval_where_known(&known, SEED, |of| pooled(of).auc),
            ece_interval: interval_where_known(&known, SEED, |of| pooled(of).ece),
            auc_unweighted: ProbeDetection::from_beliefs(&unweighted).auc,
            log_scores: ProbeLogScores::from_questions(&numbered),
            accuracy: accuracy(&participants, (ProbeAccuracyGrouping::Kind, "all"), SEED, is_counted),
            accuracies: accuracies(&participants, SEED),
            assistance: awareness_effect(&participants, SEED),
            level_2: level_2.filter(|one| one.n > 0).collect(),
            by_true_beliefs: RecordedBeliefComparison::from_beliefs(&all),
        })
    }
}

/// The trials of each participant; the participants are in the order of their first trial.
fn by_participant<'a>(trials: impl IntoIterator<Item = (&'a str, &'a ProbedTrial)>) -> Vec<Vec<&'a ProbedTrial>> {
    let mut participants: Vec<(&str, Vec<&ProbedTrial>)> = Vec::new();
    for (code, trial) in trials {
        match participants.iter_mut().find(|(other, _)| *other == code) {
            Some((_, of_one)) => of_one.push(trial),
            None => participants.push((code, vec![trial])),
        }
    }
    participants.into_iter().map(|(_, of_one)| of_one).collect()
}

fn beliefs<'a>(trials: &[&'a ProbedTrial]) -> Vec<WeightedProbeBelief<'a>> {
    trials.iter().flat_map(|trial| trial.counted()).filter_map(WeightedProbeBelief::by_answer).collect()
}

impl ProbeCounts {
    fn from_trials<'a>(trials: impl Iterator<Item = &'a ProbedTrial>) -> ProbeCounts {
        let mut counts = ProbeCounts::default();
        let (mut weights, mut squares) = (0.0, 0.0);
        for trial in trials {
            counts.probes += trial.begun;
            counts.dropped += trial.dropped;
            counts.skipped += trial.skipped;
            for question in &trial.questions {
                counts.questions += 1;
                match question {
                    one if one.response == ProbeResponse::Skipped => counts.questions_skipped += 1,
                    one if one.response == ProbeResponse::Missing => counts.unanswered += 1,
                    one if one.origin == ProbeOrigin::Wizard => counts.by_wizard += 1,
                    one if one.kind.is_level_2() => counts.level_2 += 1,
                    one => {
                        counts.counted += 1;
                        counts.unsure += u64::from(one.response == ProbeResponse::Unsure);
                        weights += one.weight();
                        squares += one.weight() * one.weight();
                    }
                }
            }
        }
        counts.effective = if squares > 0.0 { weights * weights / squares } else { 0.0 };
        counts
    }
}

impl RecordedBeliefComparison {
    fn from_beliefs(answered: &[WeightedProbeBelief]) -> Option<RecordedBeliefComparison> {
        let known: Vec<[WeightedProbeBelief; 2]> =
            answered.iter().filter_map(|one| Some([*one, one.by_true_belief()?])).collect();
        (!known.is_empty()).then_some(())?;
        let same = known.iter().filter(|[answered, believed]| answered.is_wrong == believed.is_wrong).count();
        let [by_answers, detection] = [0, 1].map(|which| {
            let of: Vec<WeightedProbeBelief> = known.iter().map(|both| both[which]).collect();
            ProbeDetection::from_beliefs(&of)
        });
        Some(RecordedBeliefComparison {
            n: known.len() as u64,
            agreement: same as f64 / known.len() as f64,
            detection,
            by_answers,
        })
    }
}
