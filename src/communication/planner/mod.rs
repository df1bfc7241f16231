//! ToM-Com: says what is expected to save more presses than it costs (paper, section "Planning communication").
//!
//! For every signal, rollouts over some decisions of the human, each paired with one in which nothing is said: the same
//! sample of the belief, the same random numbers. The benefit of a signal is the mean of what the silent rollout takes more,
//! presses of both plus the cost to go at its end. A signal that changes nothing of what a sample holds for possible makes
//! no difference in its rollout, exactly, and is not tried out.

pub mod human;
mod lattice;
mod robot;
mod rollout;
mod sample;
mod tally;

use std::sync::Arc;

use self::human::{Cases, Decider};
use self::lattice::{Lattice, PER_DECISION};
use self::robot::RobotPolicy;
use self::rollout::{BaselineRollout, Rollout, RolloutContext, RolloutDraws, RolloutState};
use self::sample::BeliefSamples;
use self::tally::PairedDifferences;
use super::concept::{self, Concept};
use super::recommendation::{Reason, Recommendation, SignalOption, aspects_told};
use super::settings::AssistantSpec;
use super::situation::Situation;
use super::{Signal, unavailable};
use crate::base::rng::{Stream, stream};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, ButtonAction, ButtonId, Kitchen};
use crate::mind::model::HumanModel;
use crate::mind::witness::rounded;

/// After so many rollouts it is looked at which signals are decided.
const BATCH: usize = 32;

/// Plans communication. What it remembers from one question to the next changes the time that an answer takes, never the
/// answer.
#[derive(Clone, Debug)]
pub struct Planner {
    kitchen: Arc<Kitchen>,
    spec: AssistantSpec,
    seed: u64,
    decider: Decider,
    foresight: f64,
    involved: Vec<Vec<AspectId>>,
    /// By button of the human, what is looked at before it is pressed: those places, and before something is fetched the
    /// robot's hand, which may be bringing it.
    watched: Vec<Vec<AspectId>>,
    policy: RobotPolicy,
    samples: BeliefSamples,
    trace: BaselineRollout,
    moment: RolloutState,
    silent: Cases,
    told: Cases,
    draws: Vec<RolloutDraws>,
}

/// A signal that is tried out.
#[derive(Clone, Debug)]
struct Arm {
    signal: Signal,
    aspects: Vec<AspectId>,
    tally: PairedDifferences,
    is_decided: bool,
}

impl Planner {
    /// A planner for people as `human` says. Its chances follow from `seed` and the presses until a moment.
    pub fn new(kitchen: Arc<Kitchen>, human: &HumanModel, spec: AssistantSpec, seed: u64) -> Planner {
        let buttons = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| ButtonId(index as u8));
        let aspects = |button| kitchen.involved(Agent::Human, button).into_iter().map(AspectId::of_location);
        let of_robot = AspectId::of_location(kitchen.hands[Agent::Robot.index()]);
        let fetches = |button| matches!(kitchen.button(Agent::Human, button).action, ButtonAction::Take(_));
        let watched = |button| aspects(button).chain(fetches(button).then_some(of_robot)).collect();
        Planner {
            decider: Decider::new(&kitchen, &human.decision, spec.rollout.states),
            foresight: human.transition.foresight,
            involved: buttons.clone().map(|button| aspects(button).collect()).collect(),
            watched: buttons.map(watched).collect(),
            policy: RobotPolicy::default(),
            samples: BeliefSamples::default(),
            trace: BaselineRollout::default(),
            moment: RolloutState::default(),
            silent: Cases::default(),
            told: Cases::default(),
            draws: Vec::new(),
            kitchen,
            spec,
            seed,
        }
    }

    fn arms(&self, situation: &Situation, signals: &[Signal]) -> Vec<Arm> {
        let possible = signals.iter().filter(|signal| unavailable(&self.kitchen, situation.state, signal).is_none());
        let arm = |signal: &Signal| Arm {
            signal: signal.clone(),
            aspects: aspects_told(&self.kitchen, situation.state, signal),
            tally: PairedDifferences::default(),
            is_decided: false,
        };
        possible.map(arm).collect()
    }

    /// One rollout without a signal, and one for each signal that changes something.
    fn roll_out(
        &mut self,
        cost: &mut CostToGo,
        situation: &Situation,
        arms: &mut [Arm],
        number: usize,
        lattice: &Lattice,
        random: &mut Stream,
    ) {
        let model = &self.spec.rollout;
        self.samples.draw(&self.kitchen, situation.state, number, random, &mut self.silent);
        let [first, sees, firsts @ ..] = lattice.point(number);
        let first_s = first * model.human_press_s;
        let sees = sees < model.capture;
        self.draws.clear();
        self.draws.extend((0..model.horizon).map(|_| RolloutDraws::draw(random)));
        for (draws, first) in self.draws.iter_mut().zip(firsts.chunks_exact(PER_DECISION)) {
            draws.begin_with(first);
        }
        let stage = RolloutContext {
            kitchen: &self.kitchen,
            recipes: self.kitchen.true_recipes(),
            decider: &self.decider,
            involved: &self.involved,
            watched: &self.watched,
            model,
            robot_press_s: situation.robot_press_s,
            foresight: self.foresight,
            looks: -(-model.looks_hz * model.human_press_s).exp_m1(),
            other_looks: -(-model.other_looks_hz * model.human_press_s).exp_m1(),
        };
        let mut rollout = Rollout { stage: &stage, cost, policy: &mut self.policy, draws: &self.draws, first_s };
        let mut is_silent_known = false;
        for arm in arms.iter_mut().filter(|arm| !arm.is_decided) {
            self.told.copy_from(&self.silent);
            let mut changed = false;
            for &aspect in &arm.aspects {
                changed |= self.told.learn(&self.kitchen, aspect, situation.state);
            }
            if !changed {
                arm.tally.add(0.0, None);
                continue;
            }
            if !is_silent_known {
                self.moment.begin(&self.kitchen, situation, &self.silent, sees);
                rollout.silent(&mut self.moment, &mut self.trace);
                is_silent_known = true;
            }
            self.moment.begin(&self.kitchen, situation, &self.told, sees);
            let outcome = rollout.told(&mut self.moment, &self.trace);
            arm.tally.add(f64::from(self.trace.value - outcome.value), outcome.parted);
        }
    }

    /// Whether it is clear what every signal is worth.
    fn is_decided(&self, arms: &mut [Arm], rollouts: usize) -> bool {
        let model = &self.spec.rollout;
        if rollouts < model.least_rollouts {
            return false;
        }
        for arm in arms.iter_mut() {
            let error = arm.tally.cautious_error();
            let is_clear = (arm.tally.mean() - self.spec.cost_of_communication).abs() > 3.0 * error;
            arm.is_decided |= error <= model.enough_error || is_clear && error <= 2.0 * model.enough_error;
        }
        arms.iter().all(|arm| arm.is_decided)
    }

    fn recommendation(&self, situation: &Situation, arms: Vec<Arm>, silent: Recommendation) -> Recommendation {
        let price = self.spec.cost_of_communication;
        let mut arms = arms;
        // The first of equals is the first in the layout.
        arms.sort_by(|a, b| b.tally.mean().total_cmp(&a.tally.mean()));
        let option = |arm: &Arm| SignalOption {
            signal: arm.signal.clone(),
            benefit: rounded(arm.tally.mean()),
            standard_error: rounded(arm.tally.standard_error()),
            net: rounded(arm.tally.mean() - price),
            rollouts: arm.tally.count(),
        };
        let reason = arms.first().filter(|arm| arm.tally.mean() > 0.0).and_then(|arm| {
            let mut reason = Reason::for_signal(&self.kitchen, situation.state, situation.belief, &arm.signal)?;
            if let Some((prevents, instead)) = arm.tally.turning_point() {
                let name = |button: ButtonId| self.kitchen.button(Agent::Human, button).name.clone();
                reason.prevents = Some(name(prevents));
                reason.instead = instead.map(name);
            }
            Some(reason)
        });
        let options: Vec<SignalOption> = arms.iter().map(option).collect();
        let best = options.first().filter(|option| option.net > 0.0).map(|option| option.signal.clone());
        Recommendation { options, best, reason, ..silent }
    }
}

impl Concept for Planner {
    /// What the signals are worth now; those that cannot be sent are left out.
    fn advise(&mut self, cost: &mut CostToGo, moment: &concept::DecisionPoint) -> Recommendation {
        let situation = &moment.situation;
        let mut random = stream(self.seed, "communication", u64::from(moment.presses));
        let mut arms = self.arms(situation, moment.signals);
        let rollouts = self.spec.rollout.rollouts;
        self.samples.prepare(situation.belief, rollouts, self.spec.rollout.states, &mut random);
        let lattice = Lattice::shifted(&mut random);
        for number in 0..rollouts {
            self.roll_out(cost, situation, &mut arms, number, &lattice, &mut random);
            if (number + 1) % BATCH == 0 && self.is_decided(&mut arms, number + 1) {
                break;
            }
        }
        self.recommendation(situation, arms, Recommendation::silent(moment.seq, moment.time))
    }
}
