//! What the commands print as figures. A figure that cannot be computed yet is null.

use serde::Serialize;

use super::follower::Follower;
use crate::kitchen::{Agent, DishId};
use crate::measures::attribution::Cause;
use crate::measures::median;
use crate::measures::sequences::{Sequence, sequences, sequences_by_target};
use crate::session::Happening;
use crate::session::settings::ParticipantKind;

/// The figures of one trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFigures {
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    pub races: u64,
    pub signals: u64,
    /// None where it is not known what the human believed.
    pub beliefs: Option<TrialBeliefs>,
    /// For each served order, its dish and the presses of both agents since the one before it.
    pub served: Vec<(DishId, u32)>,
    /// The trial's length by its own clock, in seconds.
    pub seconds: f64,
}

impl TrialFigures {
    /// The figures of a session so far.
    pub fn of(follower: &Follower) -> TrialFigures {
        let session = &follower.session;
        let mut before = 0;
        let served = session.served.iter().map(|served| {
            let presses = served.presses - before;
            before = served.presses;
            (served.dish, presses)
        });
        let served = served.collect();
        let signals = session.timeline.iter().filter(|entry| matches!(entry.what, Happening::Signal { .. }));
        TrialFigures {
            human_actions: u64::from(session.presses[Agent::Human.index()]),
            robot_actions: u64::from(session.presses[Agent::Robot.index()]),
            errors: follower.errors() as u64,
            races: follower.judged.iter().filter(|press| press.verdict.race).count() as u64,
            signals: signals.count() as u64,
            beliefs: TrialBeliefs::of(follower),
            served,
            seconds: session.trial_clock(session.time).as_secs_f64(),
        }
    }
}

/// What false beliefs did in one trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialBeliefs {
    /// Errors that are belief related.
    pub related: u64,
    /// Of those, the ones that no single target explains.
    pub related_to_pairs: u64,
    pub sequences: Vec<Sequence>,
    pub by_target: Vec<Sequence>,
    /// False belief episodes that caused at least one error.
    pub episodes: u64,
}

impl TrialBeliefs {
    /// Those of a session so far; none if it is not known for every press what the human believed.
    fn of(follower: &Follower) -> Option<TrialBeliefs> {
        let judged = &follower.judged;
        let is_simulated = follower.session.spec.participant.kind == ParticipantKind::Simulated;
        if !is_simulated || judged.iter().any(|press| !press.belief_known) {
            return None;
        }
        let count = |is: fn(Cause) -> bool| judged.iter().filter_map(|press| press.cause).filter(|&c| is(c)).count();
        Some(TrialBeliefs {
            related: count(|cause| matches!(cause, Cause::Belief { .. })) as u64,
            related_to_pairs: count(|cause| matches!(cause, Cause::Belief { with: Some(_), .. })) as u64,
            sequences: sequences(judged),
            by_target: sequences_by_target(judged),
            episodes: follower.episodes.harmful().count() as u64,
        })
    }
}

/// What false beliefs did, in one trial or several. Null where it is not known what the human believed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BeliefFigures {
    pub belief_related_errors: Option<u64>,
    /// Of those, the ones that it takes two false beliefs to explain.
    pub errors_of_two_beliefs: Option<u64>,
    pub sequences: Option<u64>,
    pub mean_sequence_length: Option<f64>,
    /// Seconds from the first error of a sequence to the first correct press after its last.
    pub mean_recovery_s: Option<f64>,
    /// Sequences of errors about the same aspect alone.
    pub sequences_by_aspect: Option<u64>,
    pub mean_sequence_length_by_aspect: Option<f64>,
    /// Times that an aspect was believed wrong and caused at least one error.
    pub false_belief_episodes: Option<u64>,
}

impl BeliefFigures {
    /// Sums up trials.
    pub fn of<'a>(trials: impl IntoIterator<Item = &'a TrialFigures>) -> BeliefFigures {
        let trials: Option<Vec<&TrialBeliefs>> = trials.into_iter().map(|trial| trial.beliefs.as_ref()).collect();
        let Some(trials) = trials else { return BeliefFigures::default() };
        let sum = |of: fn(&TrialBeliefs) -> u64| Some(trials.iter().map(|trial| of(trial)).sum());
        let lengths = |of: fn(&TrialBeliefs) -> &[Sequence]| {
            mean(trials.iter().flat_map(|trial| of(trial)).map(|sequence| f64::from(sequence.length)))
        };
        let recovery = |sequence: &Sequence| Some(sequence.recovered?.secs_since(sequence.began));
        BeliefFigures {
            belief_related_errors: sum(|trial| trial.related),
            errors_of_two_beliefs: sum(|trial| trial.related_to_pairs),
            sequences: sum(|trial| trial.sequences.len() as u64),
            mean_sequence_length: lengths(|trial| &trial.sequences),
            mean_recovery_s: mean(trials.iter().flat_map(|trial| &trial.sequences).filter_map(recovery)),
            sequences_by_aspect: sum(|trial| trial.by_target.len() as u64),
            mean_sequence_length_by_aspect: lengths(|trial| &trial.by_target),
            false_belief_episodes: sum(|trial| trial.episodes),
        }
    }

    /// The figures for people; `errors` is the number of all errors.
    pub fn describe(&self, errors: u64) -> String {
        let (Some(related), Some(sequences)) = (self.belief_related_errors, self.sequences) else {
            return "belief related errors: not known, since nobody knows what the participant believed".to_string();
        };
        let number = |value: Option<f64>| value.map_or("-".to_string(), |value| format!("{value:.1}"));
        format!(
            "belief related: {related} of {errors} errors ({:.0} %), in {sequences} sequences of {} errors each (by \
             single aspect {}), over after {} s",
            100.0 * related as f64 / errors.max(1) as f64,
            number(self.mean_sequence_length),
            number(self.mean_sequence_length_by_aspect),
            number(self.mean_recovery_s),
        )
    }
}

/// The figures of `tomcom simulate`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulationFigures {
    pub trials: u64,
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    /// Presses of the human that the robot may have overtaken; they are not counted as errors.
    pub races: u64,
    #[serde(flatten)]
    pub beliefs: BeliefFigures,
    pub signals: u64,
    pub orders_served: u64,
    /// Median over the served orders of the presses of both agents since the order before.
    pub presses_per_order: Option<f64>,
    /// The same median of the least presses that each served dish takes from an empty kitchen.
    pub optimal_presses_per_order: Option<f64>,
    pub simulated_s: f64,
    pub wall_s: f64,
    /// Recordings that are excluded: they are left out of the figures.
    pub excluded: u64,
    pub recordings: Vec<String>,
}

impl SimulationFigures {
    /// Sums up trials. `plan_lengths`: the least presses for each dish from an empty kitchen.
    pub fn of(trials: &[TrialFigures], plan_lengths: &[u32]) -> SimulationFigures {
        let sum = |of: fn(&TrialFigures) -> u64| trials.iter().map(of).sum();
        let served = || trials.iter().flat_map(|trial| &trial.served);
        SimulationFigures {
            trials: trials.len() as u64,
            human_actions: sum(|trial| trial.human_actions),
            robot_actions: sum(|trial| trial.robot_actions),
            errors: sum(|trial| trial.errors),
            races: sum(|trial| trial.races),
            beliefs: BeliefFigures::of(trials),
            signals: sum(|trial| trial.signals),
            orders_served: served().count() as u64,
            presses_per_order: median(served().map(|(_, presses)| f64::from(*presses)).collect()),
            optimal_presses_per_order: median(
                served().map(|(dish, _)| f64::from(plan_lengths[dish.index()])).collect(),
            ),
            simulated_s: trials.iter().map(|trial| trial.seconds).sum(),
            wall_s: 0.0,
            excluded: 0,
            recordings: Vec::new(),
        }
    }
}

/// The mean; none of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}
