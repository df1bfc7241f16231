//! Sums and rates over trials.

use serde::Serialize;

use super::effect::LEVEL;
use super::statistics::{ConfidenceInterval, share_interval};
use super::trial_statistics::{FalseBeliefErrors, TrialStatistics, mean, mean_length};
use tomcom_core::measures::raters::BeliefSource;
use tomcom_core::measures::sequences::BeliefErrorCounts;

/// Sums and rates over trials of a study: presses, errors, sequences, signals, orders.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TrialTotals {
    /// Number of presses of both agents.
    pub actions: u64,
    /// Number of presses of the human.
    pub human_actions: u64,
    /// Number of presses of the robot.
    pub robot_actions: u64,
    /// Number of the human's presses that were errors.
    pub errors: u64,
    /// Number of the human's presses that the robot may have overtaken (races), which do not count as errors.
    pub races: u64,
    /// Number of the human's presses whose judgement rests on a cost to go that is not proven to be the least.
    pub unproven: u64,
    /// Errors of the human per press of both agents.
    pub error_rate: Option<f64>,
    /// Errors per press of the human.
    pub error_rate_human: Option<f64>,
    /// Source of the participants' beliefs; null if beliefs are unknown in any trial.
    pub beliefs_from: Option<BeliefSource>,
    /// Number of errors that are attributed to a false belief.
    pub belief_related_errors: Option<u64>,
    /// Errors from false beliefs, counted by kind of state aspect.
    pub belief_related_by_kind: Option<BeliefErrorCounts>,
    /// Share of the errors that follow from false beliefs, from 0 to 1.
    pub belief_related_share: Option<f64>,
    /// 95 % interval of the share `belief_related_share`.
    pub belief_related_interval: Option<ConfidenceInterval>,
    /// Number of error sequences whose errors follow from the same false belief.
    pub sequences: Option<u64>,
    /// Mean number of errors in a sequence of errors from the same false belief.
    pub mean_sequence_length: Option<f64>,
    /// Sequences of errors from the same false belief, per 100 presses of the human.
    pub sequences_per_100: Option<f64>,
    /// Errors that follow from false beliefs, per 100 presses of the human.
    pub belief_related_per_100: Option<f64>,
    /// Number of error sequences, whichever false beliefs they follow from.
    pub sequences_any_aspect: Option<u64>,
    /// Mean number of errors in an error sequence, whichever false beliefs it follows from.
    pub mean_sequence_length_any_aspect: Option<f64>,
    /// Mean time from the first error of a sequence to the first correct press after its last error, in seconds.
    pub mean_recovery_s: Option<f64>,
    /// Number of false belief episodes that caused at least one error.
    pub false_belief_episodes: Option<u64>,
    /// Number of signals shown to participants.
    pub signals: u64,
    /// Number of orders served in the trials.
    pub orders_served: u64,
}

impl TrialTotals {
    pub(super) fn from_trials(trials: &[&TrialStatistics]) -> TrialTotals {
        let sum = |of: fn(&TrialStatistics) -> u64| trials.iter().map(|trial| of(trial)).sum::<u64>();
        let (actions, human_actions, errors) =
            (sum(TrialStatistics::presses), sum(|trial| trial.human_presses), sum(|t| t.errors));
        let rate = |presses: u64| (presses > 0).then(|| errors as f64 / presses as f64);
        let totals = TrialTotals {
            actions,
            human_actions,
            robot_actions: sum(|trial| trial.robot_presses),
            errors,
            races: sum(|trial| trial.races),
            unproven: sum(|trial| trial.unproven),
            error_rate: rate(actions),
            error_rate_human: rate(human_actions),
            signals: sum(|trial| trial.signals),
            orders_served: sum(|trial| trial.orders),
            ..TrialTotals::default()
        };
        let beliefs: Option<Vec<&FalseBeliefErrors>> = trials.iter().map(|trial| trial.beliefs.as_ref()).collect();
        let Some(beliefs) = beliefs.filter(|beliefs| !beliefs.is_empty()) else { return totals };
        let related = beliefs.iter().map(|one| one.errors).sum::<u64>();
        let lengths: Vec<u32> = beliefs.iter().flat_map(|one| one.lengths.iter().copied()).collect();
        let any_aspect: Vec<u32> = beliefs.iter().flat_map(|one| one.lengths_any_aspect.iter().copied()).collect();
        let per_100 = |number: u64| (human_actions > 0).then(|| 100.0 * number as f64 / human_actions as f64);
        let interval = share_interval(related, errors, LEVEL);
        TrialTotals {
            beliefs_from: source(trials),
            belief_related_errors: Some(related),
            belief_related_by_kind: Some(
                beliefs.iter().fold(BeliefErrorCounts::default(), |sum, one| sum.plus(one.causes)),
            ),
            belief_related_share: interval.map(|interval| interval.estimate),
            belief_related_interval: interval,
            sequences: Some(lengths.len() as u64),
            sequences_per_100: per_100(lengths.len() as u64),
            belief_related_per_100: per_100(related),
            mean_sequence_length: mean_length(&lengths),
            sequences_any_aspect: Some(any_aspect.len() as u64),
            mean_sequence_length_any_aspect: mean_length(&any_aspect),
            mean_recovery_s: mean(beliefs.iter().flat_map(|one| one.recovery_s.iter().copied())),
            false_belief_episodes: beliefs.iter().map(|one| one.episodes).sum(),
            ..totals
        }
    }
}

/// The source of beliefs of these trials; the least reliable source if they differ. Trials without errors count only
/// if all are: there was nothing to find out.
fn source(trials: &[&TrialStatistics]) -> Option<BeliefSource> {
    let of = |trial: &&&TrialStatistics| trial.beliefs.as_ref().map(|beliefs| beliefs.basis);
    let with_errors = trials.iter().filter(|trial| trial.errors > 0).filter_map(|trial| of(&trial)).max();
    with_errors.or_else(|| trials.iter().filter_map(|trial| of(&trial)).max())
}
