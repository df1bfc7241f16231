//! ToM-Com: sends the signal whose expected saving exceeds its cost (paper, section "Planning communication").
//!
//! For every signal there are rollouts over a few decisions of the human, each paired with a baseline rollout without
//! the signal: the same sample of the belief, the same random numbers. The expected saving of a signal is the mean
//! difference between baseline and rollout in presses of both agents plus the cost to go at the horizon. A wait of the
//! human counts as a press as long as something is wanted: else a human who believes that nothing is worth doing would lose
//! nothing by waiting for the horizon. A signal that changes none of a sample's worlds saves exactly nothing in its
//! rollout, which is skipped. Where signals take time, a rollout reads its signal after the mean delay, and its saving is
//! multiplied by the probability that the signal is read: a human who misses the signal continues like the baseline.
//!
//! The rollouts of a batch can run side by side on several threads (lanes): their random numbers are drawn before, and
//! their results are added in their order, so the answer is the same on any number of threads.

mod lane;
mod rollout;
mod sample;
mod work_ahead;

use std::sync::Arc;
use std::sync::atomic::AtomicUsize;

use self::lane::{Batch, Lane, RolloutDraws};
use self::rollout::{DecisionDraws, RolloutContext};
use self::sample::{BeliefSamples, PER_DECISION, QuasiRandomLattice};
use super::concept::{Concept, DecisionPoint, Situation};
use super::recommendation::{Recommendation, SignalOption, SignalReason, aspects_told};
use super::settings::AssistantSpec;
use super::signal::{Signal, unavailable};
use crate::base::rng::{Stream, stream};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, Kitchen};
use crate::mind::choice::HumanChoice;
use crate::mind::model::{HumanModel, LookingModel};
use crate::mind::{ChoiceModel, rounded};

/// Number of rollouts after which the planner checks for which signals the sign of the net benefit is certain enough.
const BATCH: usize = 32;

/// Largest number of rollouts side by side: more would take the processors from console, display and tracker.
const MOST_LANES: usize = 2;

/// The ToM-Com planner: estimates the net benefit of each signal by paired rollouts. The planner's caches change
/// computing time, never results.
#[derive(Clone, Debug)]
pub struct Planner {
    kitchen: Arc<Kitchen>,
    spec: AssistantSpec,
    seed: u64,
    choice: ChoiceModel,
    foresight: f64,
    looking: LookingModel,
    involved: Vec<Vec<AspectId>>,
    /// For each button of the human, the aspects at which the human looks before a press: the locations involved and,
    /// before fetching an item, the robot's hand, which may be bringing the item.
    watched: Vec<Vec<AspectId>>,
    samples: BeliefSamples,
    batch: Vec<RolloutDraws>,
    /// What each thread of rollouts needs; at least one.
    lanes: Vec<Lane>,
    /// The threads of all lanes but the first, which runs on the caller's.
    threads: Option<Arc<rayon::ThreadPool>>,
}

#[derive(Clone, Debug)]
struct Candidate {
    signal: Signal,
    aspects: Vec<AspectId>,
    probability: f64,
    /// A benefit below this, in presses, is as good as none, so it need not be known more accurately.
    matters_above: f64,
    tally: PairedDifferences,
    is_decided: bool,
}

impl Planner {
    /// A planner for this human model. `seed` and the number of presses so far seed the planner's random stream.
    pub fn new(kitchen: Arc<Kitchen>, human: &HumanModel, spec: AssistantSpec, seed: u64) -> Planner {
        let buttons = kitchen.button_ids(Agent::Human);
        let aspects = |button| kitchen.involved(Agent::Human, button).into_iter().map(AspectId::of_location);
        let watched = |button| kitchen.watched(button).into_iter().map(AspectId::of_location).collect();
        Planner {
            choice: ChoiceModel::up_to_draws(&kitchen, &human.decision, spec.rollout.states),
            foresight: human.transition.foresight,
            looking: spec.rollout.looking(&human.looking),
            involved: buttons.clone().map(|button| aspects(button).collect()).collect(),
            watched: buttons.map(watched).collect(),
            samples: BeliefSamples::default(),
            batch: Vec::new(),
            lanes: vec![Lane::default()],
            threads: None,
            kitchen,
            spec,
            seed,
        }
    }

    /// The signals of this moment that can be sent; `matters_above` is the benefit below which a signal is as good as
    /// none.
    fn candidates(&self, moment: &DecisionPoint, matters_above: impl Fn(&Signal) -> f64) -> Vec<Candidate> {
        let situation = &moment.situation;
        let is_possible = |signal: &&Signal| unavailable(&self.kitchen, situation.state, signal).is_none();
        let candidate = |signal: &Signal| Candidate {
            signal: signal.clone(),
            aspects: aspects_told(&self.kitchen, situation.state, signal),
            probability: signal
                .location(&self.kitchen)
                .map_or(1.0, |location| situation.forecast.probability(self.kitchen.location(location).kind)),
            matters_above: matters_above(signal),
            tally: PairedDifferences::default(),
            is_decided: false,
        };
        moment.signals.iter().filter(is_possible).map(candidate).collect()
    }

    /// Draws the beliefs and the random numbers of the rollouts with these numbers.
    fn draw(
        &mut self,
        situation: &Situation,
        numbers: std::ops::Range<usize>,
        lattice: &QuasiRandomLattice,
        random: &mut Stream,
    ) {
        let model = &self.spec.rollout;
        self.batch.resize_with(numbers.len(), RolloutDraws::default);
        for (rollout, number) in self.batch.iter_mut().zip(numbers) {
            self.samples.draw(&self.kitchen, situation.state, number, random, &mut rollout.believed);
            let [first, sees, firsts @ ..] = lattice.point(number);
            rollout.first_s = first * model.human_press_s;
            rollout.sees = sees < self.looking.capture;
            rollout.decisions.clear();
            rollout.decisions.extend((0..model.horizon).map(|_| DecisionDraws::draw(random)));
            for (draws, first) in rollout.decisions.iter_mut().zip(firsts.chunks_exact(PER_DECISION)) {
                draws.begin_with(first);
            }
        }
    }

    /// Runs the drawn batch, on all lanes at once. Returns whether it was finished.
    fn roll_out(
        &mut self,
        cost: &mut CostToGo,
        situation: &Situation,
        candidates: &mut [Candidate],
        proceed: &(dyn Fn() -> bool + Sync),
    ) -> bool {
        let model = &self.spec.rollout;
        let looks = |rate_hz: f64| -(-rate_hz * model.human_press_s).exp_m1();
        let context = RolloutContext {
            kitchen: &self.kitchen,
            recipes: self.kitchen.true_recipes(),
            choice: &self.choice,
            involved: &self.involved,
            watched: &self.watched,
            model,
            robot_press_s: situation.robot_press_s,
            foresight: self.foresight,
            looks: looks(self.looking.looks_hz),
            other_looks: looks(self.looking.other_looks_hz),
            capture: self.looking.capture,
        };
        let undecided = || candidates.iter().filter(|candidate| !candidate.is_decided);
        let signals: Vec<(&[AspectId], f64)> = undecided().map(|one| (&one.aspects[..], one.probability)).collect();
        let Some((lane, others)) = self.lanes.split_first_mut() else { return false };
        let (context, signals, draws) = (&context, &signals[..], &self.batch[..]);
        let batch = Batch { context, situation, signals, draws, next: AtomicUsize::new(0), proceed };
        match &self.threads {
            None => lane.run(cost, &batch),
            Some(threads) => {
                let mut beside: Vec<CostToGo> = others.iter().map(|_| cost.beside()).collect();
                threads.in_place_scope(|scope| {
                    for (lane, cost) in others.iter_mut().zip(&mut beside) {
                        scope.spawn(|_| lane.run(cost, &batch));
                    }
                    lane.run(cost, &batch);
                });
                beside.iter().for_each(|other| cost.add_counts(other));
            }
        }
        let signals = signals.len();
        let mut rollouts: Vec<_> = self.lanes.iter().flat_map(|lane| lane.rollouts(signals)).collect();
        rollouts.sort_unstable_by_key(|(index, _)| *index);
        for (_, outcomes) in &rollouts {
            let undecided = candidates.iter_mut().filter(|candidate| !candidate.is_decided);
            for (candidate, outcome) in undecided.zip(*outcomes) {
                candidate.tally.add(outcome.saved, outcome.diverged);
            }
        }
        rollouts.len() == self.batch.len()
    }

    /// Whether the net benefit of every signal is known with enough certainty, or surely too small to matter.
    fn is_decided(&self, candidates: &mut [Candidate], rollouts: usize) -> bool {
        let model = &self.spec.rollout;
        if rollouts < model.least_rollouts {
            return false;
        }
        for candidate in candidates.iter_mut() {
            let (mean, error) = (candidate.tally.mean(), candidate.tally.cautious_error());
            let is_clear = (mean - self.spec.cost_of_communication).abs() > 3.0 * error;
            candidate.is_decided |= error <= model.enough_error || is_clear && error <= 2.0 * model.enough_error;
            candidate.is_decided |= mean + 3.0 * error < candidate.matters_above;
        }
        candidates.iter().all(|candidate| candidate.is_decided)
    }

    /// The candidates with their estimated savings. `proceed` is asked before each rollout; when it refuses, the
    /// savings are of no use.
    fn compared(
        &mut self,
        cost: &mut CostToGo,
        moment: &DecisionPoint,
        mut candidates: Vec<Candidate>,
        proceed: &(dyn Fn() -> bool + Sync),
    ) -> Vec<Candidate> {
        let situation = &moment.situation;
        let mut random = stream(self.seed, "communication", u64::from(moment.presses));
        let rollouts = self.spec.rollout.rollouts;
        self.samples.prepare(situation.belief, rollouts, self.spec.rollout.states, &mut random);
        let lattice = QuasiRandomLattice::shifted(&mut random);
        for first in (0..rollouts).step_by(BATCH) {
            let end = rollouts.min(first + BATCH);
            self.draw(situation, first..end, &lattice, &mut random);
            let finished = self.roll_out(cost, situation, &mut candidates, proceed);
            if !finished || self.is_decided(&mut candidates, end) {
                break;
            }
        }
        candidates
    }

    fn recommendation(
        &self,
        situation: &Situation,
        candidates: Vec<Candidate>,
        silent: Recommendation,
    ) -> Recommendation {
        let candidates = ranked(candidates);
        let reason = candidates.first().filter(|candidate| candidate.tally.mean() > 0.0).and_then(|candidate| {
            let mut reason =
                SignalReason::for_signal(&self.kitchen, situation.state, situation.belief, &candidate.signal)?;
            if let Some(choices) = candidate.tally.turning_point() {
                [reason.prevents, reason.instead] = choices.map(|choice| match choice {
                    HumanChoice::Press(button) => Some(self.kitchen.button(Agent::Human, button).name.clone()),
                    HumanChoice::Wait => None,
                });
            }
            Some(reason)
        });
        let options = self.options(&candidates);
        let best = options.first().filter(|option| option.net > 0.0).map(|option| option.signal.clone());
        Recommendation { options, best, reason, ..silent }
    }

    fn options(&self, candidates: &[Candidate]) -> Vec<SignalOption> {
        let price = self.spec.cost_of_communication;
        let option = |candidate: &Candidate| SignalOption {
            signal: candidate.signal.clone(),
            benefit: rounded(candidate.tally.mean()),
            standard_error: rounded(candidate.tally.standard_error()),
            net: rounded(candidate.tally.mean() - price),
            rollouts: candidate.tally.count(),
        };
        candidates.iter().map(option).collect()
    }

    /// The benefits of the available signals, the largest first, for a caller who knows below which benefit a signal
    /// would not be sent: such a benefit is not estimated more accurately than needed to see that.
    pub fn benefits(
        &mut self,
        cost: &mut CostToGo,
        moment: &DecisionPoint,
        matters_above: impl Fn(&Signal) -> f64,
    ) -> Vec<SignalOption> {
        let candidates = self.candidates(moment, matters_above);
        let compared = self.compared(cost, moment, candidates, &|| true);
        self.options(&ranked(compared))
    }
}

/// The candidates with the largest saving first; those with equal savings keep the layout's order.
fn ranked(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.tally.mean().total_cmp(&a.tally.mean()));
    candidates
}

impl Concept for Planner {
    /// Estimates the net benefit of the available signals and ranks the signals by their net benefit.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        let candidates = self.candidates(moment, |_| f64::NEG_INFINITY);
        let candidates = self.compared(cost, moment, candidates, &|| true);
        self.recommendation(&moment.situation, candidates, Recommendation::silent(moment.seq, moment.time))
    }

    fn work_ahead(&mut self, cost: &mut CostToGo, moment: &DecisionPoint, proceed: &(dyn Fn() -> bool + Sync)) {
        self.prepare_for_presses(cost, moment, proceed);
    }

    fn use_threads(&mut self, threads: usize) {
        let others = threads.clamp(1, MOST_LANES) - 1;
        let start = || rayon::ThreadPoolBuilder::new().num_threads(others).build().ok();
        // On a system that gives no threads, the same answers come from one.
        self.threads = if others > 0 { start().map(Arc::new) } else { None };
        self.lanes.resize_with(1 + self.threads.as_ref().map_or(0, |_| others), Lane::default);
    }
}

/// Running statistics of the differences between paired rollouts, one with and one without a signal.
#[derive(Clone, Debug, Default)]
pub struct PairedDifferences {
    count: u32,
    sum: f64,
    squares: f64,
    divergences: Vec<Divergence>,
}

/// A pair of different choices of the human, at which the rollouts without and with the signal separate.
#[derive(Clone, Copy, Debug)]
struct Divergence {
    baseline: HumanChoice,
    signalled: HumanChoice,
    /// Sum of the savings in rollouts with this pair of choices, and sum of their squares, in presses.
    sum: f64,
    squares: f64,
}

impl Divergence {
    /// Total saving of rollouts with this pair of choices minus one standard error, so that a single large saving by
    /// chance does not count as the reason.
    fn surely_saved(&self) -> f64 {
        self.sum - self.squares.sqrt()
    }
}

impl PairedDifferences {
    /// Adds the saving of a rollout, in presses, and the human's choices at which it diverged from the baseline.
    pub fn add(&mut self, saved: f64, diverged: Option<(HumanChoice, HumanChoice)>) {
        self.count += 1;
        self.sum += saved;
        self.squares += saved * saved;
        if let Some((baseline, signalled)) = diverged {
            match self
                .divergences
                .iter_mut()
                .find(|divergence| divergence.baseline == baseline && divergence.signalled == signalled)
            {
                Some(divergence) => {
                    divergence.sum += saved;
                    divergence.squares += saved * saved;
                }
                None => self.divergences.push(Divergence { baseline, signalled, sum: saved, squares: saved * saved }),
            }
        }
    }

    /// Number of pairs of rollouts so far.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Mean saving of the rollouts with the signal, in presses; 0 without rollouts.
    pub fn mean(&self) -> f64 {
        self.sum / f64::from(self.count.max(1))
    }

    /// Standard error of the mean saving, in presses.
    pub fn standard_error(&self) -> f64 {
        self.error_with(0.0)
    }

    /// Standard error of the mean saving if one further rollout saved three presses: while no rollout differed, the
    /// plain standard error would be 0.
    pub(crate) fn cautious_error(&self) -> f64 {
        self.error_with(9.0)
    }

    fn error_with(&self, square: f64) -> f64 {
        let n = f64::from(self.count.max(2));
        let spread = (self.squares - self.sum * self.sum / n).max(0.0) + square;
        (spread / (n - 1.0) / n).sqrt()
    }

    /// The choice that the signal prevents with the largest saving, and the choice that replaces it.
    pub(crate) fn turning_point(&self) -> Option<[HumanChoice; 2]> {
        let all = self.divergences.iter();
        let most = all.reduce(|best, one| if one.surely_saved() > best.surely_saved() { one } else { best })?;
        (most.sum > 0.0).then_some([most.baseline, most.signalled])
    }
}
