//! Concepts that sent signals by themselves in simulated trials, compared with each other and with what the analysis of
//! unassisted trials (offline) predicts for the concepts.
//!
//! Arms are compared over the trials that all arms have: the same seed, participant and period. In such trials orders,
//! participants and random streams are the same, so the differences are within a trial. Offline, a signal changes
//! nothing that follows; live, the trial continues differently after a signal, so the predicted and the live results
//! differ.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::grouping::grouped;
use crate::roc::ConceptRocCurve;
use crate::trial_statistics::{SignalSenderWithParameter, TrialStatistics, TrialTotals};
use tomcom_session::settings::ParticipantKind;

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalSenderResults {
    #[serde(flatten)]
    pub arm: SignalSenderWithParameter,
    pub trials: u64,
    /// Errors that follow from false beliefs, per 100 presses of the human.
    pub belief_related_per_100: Option<f64>,
    /// Error sequences (errors from the same false belief) per 100 presses of the human.
    pub sequences_per_100: Option<f64>,
    pub mean_sequence_length: Option<f64>,
    pub orders: u64,
    pub orders_per_minute: Option<f64>,
    /// Interruptions by signals per 100 presses of the human; a proposal of several presses is one interruption.
    pub interruptions_per_100: Option<f64>,
    /// Pieces of content that signals told per 100 presses of the human; a proposal of k presses has k contents.
    pub contents_per_100: Option<f64>,
    /// Judged by simulating each trial without the signal; null where a trial was not judged.
    pub useless_per_100: Option<f64>,
    /// Share of useless signals among all signals; null without signals, or where a trial was not judged.
    pub useless_share: Option<f64>,
    /// By which errors from false beliefs per press are fewer than without signals; null without such an arm.
    pub prevented: Option<f64>,
    /// As predicted from unassisted trials with the same parameter; null where that was not analysed.
    pub prevented_offline: Option<f64>,
    /// Interruptions per 100 presses of the human that the analysis of unassisted trials predicts.
    pub interruptions_per_100_offline: Option<f64>,
}

/// Identifies a simulated trial across arms: seed, participant's code and period.
type TrialKey = (u64, String, Option<u32>);

fn key(trial: &TrialStatistics) -> TrialKey {
    (trial.seed, trial.participant.clone(), trial.period)
}

/// Results of all arms over the trials that all of the arms have; empty unless at least two arms share trials.
pub fn live_arms(trials: &[&TrialStatistics], roc: &[ConceptRocCurve]) -> Vec<SignalSenderResults> {
    let simulated = |trial: &&TrialStatistics| trial.kind == ParticipantKind::Simulated && trial.beliefs.is_some();
    let mut groups = grouped(trials.iter().copied().filter(simulated).map(|trial| (trial.acting, trial)));
    groups.sort_by(|(a, _), (b, _)| a.rank().0.cmp(&b.rank().0).then(a.rank().1.total_cmp(&b.rank().1)));
    let sets = groups.iter().map(|(_, group)| group.iter().map(|trial| key(trial)).collect::<BTreeSet<TrialKey>>());
    let shared = sets.reduce(|a, b| a.intersection(&b).cloned().collect()).unwrap_or_default();
    if groups.len() < 2 || shared.is_empty() {
        return Vec::new();
    }
    groups.iter_mut().for_each(|(_, group)| group.retain(|trial| shared.contains(&key(trial))));
    let mut arms: Vec<SignalSenderResults> =
        groups.iter().map(|(arm, group)| SignalSenderResults::from_trials(*arm, group)).collect();
    let without = arms.iter().find(|arm| arm.arm.concept == "none").and_then(|arm| arm.belief_related_per_100);
    for arm in arms.iter_mut().filter(|arm| arm.arm.concept != "none") {
        let rates = arm.belief_related_per_100.zip(without).filter(|(_, without)| *without > 0.0);
        arm.prevented = rates.map(|(with, without)| 1.0 - with / without);
        let points = roc.iter().filter(|roc| roc.concept.name() == arm.arm.concept).flat_map(|roc| &roc.points);
        let is_same = |parameter: f64| arm.arm.parameter.is_some_and(|own| (own - parameter).abs() < 1e-9);
        let point = points.into_iter().find(|point| is_same(point.parameter));
        arm.prevented_offline = point.map(|point| point.tpr);
        arm.interruptions_per_100_offline = point.map(|point| point.signals_per_100_actions);
    }
    arms
}

impl SignalSenderResults {
    /// Beliefs are known in all of the trials.
    fn from_trials(arm: SignalSenderWithParameter, trials: &[&TrialStatistics]) -> SignalSenderResults {
        let totals = TrialTotals::from_trials(trials);
        let (presses, orders, signals) = (totals.human_actions, totals.orders_served, totals.signals);
        let per_100 = |number: u64| (presses > 0).then(|| 100.0 * number as f64 / presses as f64);
        let share_of = Some(signals).filter(|&signals| signals > 0);
        let judged = trials.iter().map(|trial| match trial.signals {
            0 => Some(0),
            signals => trial.useful_signals.map(|useful| signals - useful),
        });
        let useless: Option<u64> = judged.sum();
        let seconds: f64 = trials.iter().map(|trial| trial.seconds).sum();
        SignalSenderResults {
            arm,
            trials: trials.len() as u64,
            belief_related_per_100: totals.belief_related_per_100,
            sequences_per_100: totals.sequences_per_100,
            mean_sequence_length: totals.mean_sequence_length,
            orders,
            orders_per_minute: (seconds > 0.0).then(|| 60.0 * orders as f64 / seconds),
            interruptions_per_100: per_100(signals),
            contents_per_100: per_100(trials.iter().map(|trial| trial.signal_contents).sum()),
            useless_per_100: useless.and_then(per_100),
            useless_share: useless.zip(share_of).map(|(useless, signals)| useless as f64 / signals as f64),
            prevented: None,
            prevented_offline: None,
            interruptions_per_100_offline: None,
        }
    }
}
