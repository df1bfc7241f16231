//! What participants knew, by their answers to probes, and how well the estimate told it.

use serde::Serialize;

use super::probe_accuracy::{AccuracyGrouping, AwarenessEffect, ProbeAccuracy, accuracies, accuracy, awareness_effect};
use super::probe_detection::{ProbeDetection, WeighedBelief};
use super::probe_record::{ProbeResponse, ProbedKind, ProbedQuestion, ProbedTrial};
use super::probe_scores::ProbeLogScores;
use super::trial_bootstrap::interval_where_known;
use crate::measures::belief_basis::BeliefBasis;
use crate::session::probes::ProbeOrigin;

/// Seed of the bootstrap: the same answers give the same intervals.
const SEED: u64 = 1;

/// Figures of the probes of a study. Main results are over questions of the schedule about what is (level 1) that were answered in
/// time; what is left out is counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeFigures {
    /// How beliefs are known.
    pub beliefs_from: BeliefBasis,
    /// Number of participants with a question in the main results.
    pub participants: u64,
    /// What was asked, and what of it counts.
    pub counts: ProbeCounts,
    /// The estimate against answers.
    #[serde(flatten)]
    pub detection: ProbeDetection,
    /// 95 % interval of `auc` by bootstrap over participants; null with fewer than five.
    pub auc_interval: Option<[f64; 2]>,
    /// 95 % interval of `ece`, likewise.
    pub ece_interval: Option<[f64; 2]>,
    /// `auc` without weights: biased, since the estimate chose questions.
    pub auc_unweighted: Option<f64>,
    /// How well answers are predicted.
    pub log_scores: ProbeLogScores,
    /// Right answers over all, by group.
    pub accuracy: ProbeAccuracy,
    /// Right answers by aspect, change and condition.
    pub accuracies: Vec<ProbeAccuracy>,
    /// The effect of assistance on situation awareness; null without participants who have answers with and without it.
    pub assistance: Option<AwarenessEffect>,
    /// Answers about what comes next (level 2), which are no part of the main results.
    pub level_2: Vec<ProbeAccuracy>,
    /// The same of simulated participants by what they really believed at the same questions; null for people.
    pub by_true_beliefs: Option<TrueBeliefs>,
}

/// Numbers of probes and questions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ProbeCounts {
    /// Probes that began.
    pub probes: u64,
    /// Probes that waited in vain and were dropped.
    pub dropped: u64,
    /// Probes that the wizard cut short.
    pub skipped: u64,
    /// Questions that were shown.
    pub questions: u64,
    /// Questions in the main results.
    pub counted: u64,
    /// Of these, answered with "I don't know".
    pub unsure: u64,
    /// Left out: no answer in time.
    pub unanswered: u64,
    /// Left out: shown when the wizard skipped the rest of the probe.
    pub questions_skipped: u64,
    /// Left out: answered, in a probe that the wizard asked for.
    pub by_wizard: u64,
    /// Left out: answered, about what comes next.
    pub level_2: u64,
    /// Number of questions of equal weight that tell as much as those of the main results (Kish 1965).
    pub effective: f64,
}

/// What simulated participants really believed at the questions of the main results.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueBeliefs {
    /// Number of questions at which the belief is recorded.
    pub n: u64,
    /// Share of them whose answer is right where the belief is, and wrong where it is wrong.
    pub agreement: f64,
    /// The estimate against these beliefs.
    #[serde(flatten)]
    pub detection: ProbeDetection,
    /// The estimate against the answers to the same questions.
    pub by_answers: ProbeDetection,
}

impl ProbeFigures {
    /// Figures of the probes of trials, each with its participant; `None` without a question that was shown.
    pub fn from_trials<'a>(trials: impl IntoIterator<Item = (&'a str, &'a ProbedTrial)>) -> Option<ProbeFigures> {
        let participants = by_participant(trials);
        let counts = ProbeCounts::from_trials(participants.iter().flatten().copied());
        (counts.questions > 0).then_some(())?;
        let beliefs: Vec<Vec<WeighedBelief>> = participants.iter().map(|trials| beliefs(trials)).collect();
        let known: Vec<&Vec<WeighedBelief>> = beliefs.iter().filter(|of_one| !of_one.is_empty()).collect();
        let pooled = |of: &[&Vec<WeighedBelief>]| -> ProbeDetection {
            ProbeDetection::from_beliefs(&of.iter().flat_map(|one| one.iter().copied()).collect::<Vec<_>>())
        };
        let all: Vec<WeighedBelief> = beliefs.iter().flatten().copied().collect();
        let unweighted: Vec<WeighedBelief> = all.iter().map(|one| one.unweighted()).collect();
        let numbered: Vec<(usize, &ProbedQuestion)> = beliefs
            .iter()
            .enumerate()
            .flat_map(|(participant, of_one)| of_one.iter().map(move |one| (participant, one.question)))
            .collect();
        let level_2 = [ProbedKind::NextOrder, ProbedKind::NextPress].into_iter().map(|kind| {
            let is_it = |_: &ProbedTrial, one: &ProbedQuestion| one.kind == kind && one.origin == ProbeOrigin::Schedule;
            accuracy(&participants, (AccuracyGrouping::Kind, kind.words()), SEED, is_it)
        });
        let is_counted = |_: &ProbedTrial, one: &ProbedQuestion| one.is_counted();
        Some(ProbeFigures {
            beliefs_from: BeliefBasis::Probes,
            participants: known.len() as u64,
            counts,
            detection: ProbeDetection::from_beliefs(&all),
            auc_interval: interval_where_known(&known, SEED, |of| pooled(of).auc),
            ece_interval: interval_where_known(&known, SEED, |of| pooled(of).ece),
            auc_unweighted: ProbeDetection::from_beliefs(&unweighted).auc,
            log_scores: ProbeLogScores::from_questions(&numbered),
            accuracy: accuracy(&participants, (AccuracyGrouping::Kind, "all"), SEED, is_counted),
            accuracies: accuracies(&participants, SEED),
            assistance: awareness_effect(&participants, SEED),
            level_2: level_2.filter(|one| one.n > 0).collect(),
            by_true_beliefs: TrueBeliefs::from_beliefs(&all),
        })
    }
}

/// The trials of each participant, in the order of their first trials.
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

fn beliefs<'a>(trials: &[&'a ProbedTrial]) -> Vec<WeighedBelief<'a>> {
    trials.iter().flat_map(|trial| trial.counted()).filter_map(WeighedBelief::by_answer).collect()
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

impl TrueBeliefs {
    fn from_beliefs(answered: &[WeighedBelief]) -> Option<TrueBeliefs> {
        let known: Vec<[WeighedBelief; 2]> =
            answered.iter().filter_map(|one| Some([*one, one.by_true_belief()?])).collect();
        (!known.is_empty()).then_some(())?;
        let same = known.iter().filter(|[answered, believed]| answered.is_wrong == believed.is_wrong).count();
        let [by_answers, detection] = [0, 1].map(|which| {
            let of: Vec<WeighedBelief> = known.iter().map(|both| both[which]).collect();
            ProbeDetection::from_beliefs(&of)
        });
        Some(TrueBeliefs { n: known.len() as u64, agreement: same as f64 / known.len() as f64, detection, by_answers })
    }
}
