//! The rollouts of one thread.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::rollout::{BaselineRollout, DecisionDraws, RobotPolicy, Rollout, RolloutContext, RolloutState};
use crate::communication::concept::Situation;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{AspectId, WeightedWorlds};
use crate::mind::choice::HumanChoice;

/// What is random in one rollout and its baseline: the human's belief, and the random numbers of the decisions.
#[derive(Clone, Debug, Default)]
pub struct RolloutDraws {
    pub believed: WeightedWorlds<u32>,
    pub decisions: Vec<DecisionDraws>,
    /// Time of the human's first decision, in seconds since the start of the rollout.
    pub first_s: f64,
    /// Whether the latest change attracts the human's gaze.
    pub sees: bool,
}

/// What a signal saved in one rollout, in presses, and the human's choices at which it diverged from the baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    pub saved: f64,
    pub diverged: Option<(HumanChoice, HumanChoice)>,
}

/// Rollouts that several threads run.
pub struct Batch<'a> {
    pub context: &'a RolloutContext<'a>,
    pub situation: &'a Situation<'a>,
    /// The signals, each with the aspects that it makes certain and the probability that it is read.
    pub signals: &'a [(&'a [AspectId], f64)],
    pub draws: &'a [RolloutDraws],
    /// Index of the next draw that nobody has taken.
    pub next: AtomicUsize,
    /// Asked before each rollout: whether to go on.
    pub proceed: &'a (dyn Fn() -> bool + Sync),
}

/// What one thread needs for rollouts, and what came of those that it has run.
#[derive(Clone, Debug, Default)]
pub struct Lane {
    policy: RobotPolicy,
    baseline: BaselineRollout,
    state: RolloutState,
    /// The outcome of each signal, of one rollout after the other.
    outcomes: Vec<Outcome>,
    /// The indices of these rollouts among the draws.
    indices: Vec<usize>,
}

impl Lane {
    /// Runs a baseline rollout for each draw of the batch that no other thread has taken, and a paired rollout for each
    /// signal that changes a world of the belief.
    pub fn run(&mut self, cost: &mut CostToGo, batch: &Batch) {
        let Batch { context, situation, signals, draws, ref next, proceed } = *batch;
        self.outcomes.clear();
        self.indices.clear();
        while proceed() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(RolloutDraws { believed, decisions, first_s, sees }) = draws.get(index) else { return };
            self.indices.push(index);
            let (first_s, read_s) = (*first_s, situation.forecast.delay_s);
            let mut rollout = Rollout { context, cost, policy: &mut self.policy, draws: decisions, first_s, read_s };
            let mut is_baseline_known = false;
            for &(aspects, probability) in signals {
                let is_known = |&aspect: &AspectId| believed.are_certain_of(context.kitchen, aspect, situation.state);
                if aspects.iter().all(is_known) {
                    self.outcomes.push(Outcome { saved: 0.0, diverged: None });
                    continue;
                }
                if !is_baseline_known {
                    self.state.begin(context.kitchen, situation, believed, *sees);
                    rollout.baseline(&mut self.state, &mut self.baseline);
                    is_baseline_known = true;
                }
                let outcome = rollout.with_signal(&mut self.state, aspects, &self.baseline);
                // A human who misses the signal saves exactly nothing by the signal.
                let saved = probability * f64::from(self.baseline.value - outcome.value);
                self.outcomes.push(Outcome { saved, diverged: outcome.diverged });
            }
        }
    }

    /// The rollouts that were run, each with its index and the outcome of each of these signals.
    pub fn rollouts(&self, signals: usize) -> impl Iterator<Item = (usize, &[Outcome])> {
        self.indices.iter().enumerate().map(move |(at, &index)| (index, &self.outcomes[at * signals..][..signals]))
    }
}
