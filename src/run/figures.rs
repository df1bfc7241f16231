//! What the commands print as figures. A figure that cannot be computed yet is null.

use serde::Serialize;

use super::follower::Follower;
use crate::kitchen::{Agent, DishId};
use crate::session::Happening;

/// The figures of one trial.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialFigures {
    pub human_actions: u64,
    pub robot_actions: u64,
    pub errors: u64,
    pub races: u64,
    pub signals: u64,
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
            served,
            seconds: session.trial_clock(session.time).as_secs_f64(),
        }
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
    /// Null until beliefs are related to errors.
    pub belief_related_errors: Option<u64>,
    pub sequences: Option<u64>,
    pub mean_sequence_length: Option<f64>,
    pub signals: u64,
    pub orders_served: u64,
    /// Median over the served orders of the presses of both agents since the order before.
    pub presses_per_order: Option<f64>,
    /// The same median of the least presses that each served dish takes from an empty kitchen.
    pub optimal_presses_per_order: Option<f64>,
    pub simulated_s: f64,
    pub wall_s: f64,
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
            belief_related_errors: None,
            sequences: None,
            mean_sequence_length: None,
            signals: sum(|trial| trial.signals),
            orders_served: served().count() as u64,
            presses_per_order: median(served().map(|(_, presses)| f64::from(*presses)).collect()),
            optimal_presses_per_order: median(
                served().map(|(dish, _)| f64::from(plan_lengths[dish.index()])).collect(),
            ),
            simulated_s: trials.iter().map(|trial| trial.seconds).sum(),
            wall_s: 0.0,
            recordings: Vec::new(),
        }
    }
}

/// The median; of an even number the mean of the middle two; none of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        length if length % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}
