//! The reference planner: planning of communication implemented directly from the equations (paper, section "Planning
//! communication"), for tests and benchmarks. The reference planner shares with [`tomcom_core::communication::planner`] only the cost to go,
//! the kitchen's rules, the robot's policy and the parameters.
//!
//! Every rollout has an explicit belief whose components are gamma variates, updated by the human model ([`Particle`]).
//! Every decision computes Q from worlds drawn from that belief. All signals and the baseline get the same number of
//! complete rollouts with the same random numbers.

use std::sync::Arc;

use rand::RngExt;

use super::person::{Particle, pick, press_chances};
use tomcom_core::base::rng::{Stream, stream};
use tomcom_core::communication::concept::DecisionPoint;
use tomcom_core::communication::recommendation::aspects_told;
use tomcom_core::communication::settings::AssistantSpec;
use tomcom_core::communication::concept::RobotIntent;
use tomcom_core::communication::{Signal, unavailable};
use tomcom_core::kitchen::cost_to_go::{CostToGo, Fidelity};
use tomcom_core::kitchen::{Agent, AspectId, ButtonId, Kitchen, LocationId, State};
use tomcom_core::mind::model::HumanModel;
use tomcom_core::robot::policy;

/// Estimated benefit of one signal by the reference planner.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceBenefit {
    pub signal: Signal,
    /// Expected saving of the signal in presses of both agents.
    pub benefit: f64,
    pub standard_error: f64,
}

/// The reference planner of signals, without optimisations, to check the optimised planner.
#[derive(Clone, Debug)]
pub struct ReferencePlanner {
    kitchen: Arc<Kitchen>,
    human: HumanModel,
    spec: AssistantSpec,
    seed: u64,
}

/// State of a simulated continuation of the trial (rollout).
struct Future {
    state: State,
    person: Particle,
    /// The button to which the robot's arm is moving, the time of arrival in seconds, and whether the robot makes the
    /// press in any case.
    robot_press: Option<(ButtonId, f64, bool)>,
    now_s: f64,
    /// Number of presses of both agents so far, and of waits of the human while something was wanted.
    spent: u32,
    /// The state aspects of the signal, and the time at which the human reads it; `None` once it is read.
    signal: Option<(Vec<AspectId>, f64)>,
}

impl Future {
    /// Lets the human read the signal, if its reading is due at `now_s`.
    fn read_by(&mut self, kitchen: &Kitchen, now_s: f64) {
        if let Some((aspects, _)) = self.signal.take_if(|(_, read_s)| *read_s <= now_s) {
            for aspect in aspects {
                self.person.settle(aspect, kitchen.true_value(self.state, aspect));
            }
        }
    }

    /// Lets the human see the contents of the locations for which `is_seen` holds.
    fn see(&mut self, kitchen: &Kitchen, is_seen: impl Fn(LocationId) -> bool) {
        for place in (0..kitchen.locations.len()).map(|index| LocationId(index as u8)).filter(|place| is_seen(*place)) {
            let aspect = AspectId::of_location(place);
            self.person.settle(aspect, kitchen.true_value(self.state, aspect));
        }
    }
}

impl ReferencePlanner {
    /// A reference planner for a human model. `seed` and the number of presses so far seed the planner's random stream.
    pub fn new(kitchen: Arc<Kitchen>, mut human: HumanModel, spec: AssistantSpec, seed: u64) -> ReferencePlanner {
        human.looking = spec.rollout.looking(&human.looking);
        ReferencePlanner { kitchen, human, spec, seed }
    }

    /// Expected benefit of each available signal, estimated by rollouts.
    pub fn advise(&self, cost: &mut CostToGo, moment: &DecisionPoint) -> Vec<ReferenceBenefit> {
        let situation = &moment.situation;
        let possible =
            moment.signals.iter().filter(|signal| unavailable(&self.kitchen, situation.state, signal).is_none());
        let signals: Vec<&Signal> = possible.collect();
        let mut saved: Vec<Vec<f64>> = vec![Vec::new(); signals.len()];
        for rollout in 0..self.spec.rollout.rollouts as u64 {
            let silent = self.roll_out(cost, moment, None, rollout);
            for (signal, saved) in signals.iter().zip(&mut saved) {
                // A human who misses the signal continues as without the signal.
                let kind = signal.location(&self.kitchen).map(|location| self.kitchen.location(location).kind);
                let is_read = kind.map_or(1.0, |kind| situation.forecast.probability(kind));
                saved.push(is_read * (silent - self.roll_out(cost, moment, Some(signal), rollout)));
            }
        }
        let worth = |(signal, saved): (&&Signal, &Vec<f64>)| {
            let n = saved.len() as f64;
            let benefit = saved.iter().sum::<f64>() / n;
            let spread = saved.iter().map(|one| (one - benefit).powi(2)).sum::<f64>();
            let standard_error = (spread / (n - 1.0).max(1.0) / n).sqrt();
            ReferenceBenefit { signal: (*signal).clone(), benefit, standard_error }
        };
        signals.iter().zip(&saved).map(worth).collect()
    }

    /// Random stream of a rollout for one purpose at one step; it is the same for all signals.
    fn chance(&self, of: &str, presses: u32, rollout: u64, step: u64) -> Stream {
        stream(self.seed, of, u64::from(presses) << 32 | rollout << 8 | step)
    }

    /// Number of presses of both agents and waits of the human in one rollout, plus the cost to go at its end.
    fn roll_out(&self, cost: &mut CostToGo, moment: &DecisionPoint, signal: Option<&Signal>, rollout: u64) -> f64 {
        let DecisionPoint { situation, presses, .. } = *moment;
        let mut random = self.chance("plain belief", presses, rollout, 0);
        let mut person = Particle::draw(&self.kitchen, situation.belief, &mut random);
        let first_s = random.random::<f64>() * self.spec.rollout.human_press_s;
        let sees = random.random::<f64>() < self.human.looking.capture;
        let signal =
            signal.map(|signal| (aspects_told(&self.kitchen, situation.state, signal), situation.forecast.delay_s));
        for &aspect in situation.changed.iter().filter(|_| sees) {
            person.settle(aspect, self.kitchen.true_value(situation.state, aspect));
        }
        let robot_press = match situation.robot {
            RobotIntent::Busy { button, remaining_s, driven } => Some((button, remaining_s, driven)),
            RobotIntent::Free | RobotIntent::Still => None,
        };
        let mut future = Future { state: situation.state, person, robot_press, now_s: 0.0, spent: 0, signal };
        future.read_by(&self.kitchen, 0.0);
        for step in 0..self.spec.rollout.horizon {
            let until_s = first_s + step as f64 * self.spec.rollout.human_press_s;
            if situation.robot != RobotIntent::Still {
                let mut random = self.chance("plain robot", presses, rollout, step as u64);
                self.robot_until(cost, &mut future, until_s, situation.robot_press_s, &mut random);
            }
            future.read_by(&self.kitchen, until_s);
            future.now_s = until_s;
            let mut random = self.chance("plain decision", presses, rollout, step as u64);
            self.decide(cost, &mut future, &mut random);
        }
        f64::from(future.spent) + f64::from(cost.all_orders(future.state, &self.kitchen.true_recipes()))
    }

    /// Lets the robot act until the human's next decision.
    fn robot_until(&self, cost: &mut CostToGo, future: &mut Future, until_s: f64, press_s: f64, random: &mut Stream) {
        let (kitchen, recipes) = (&self.kitchen, self.kitchen.true_recipes());
        loop {
            if future.robot_press.is_none() {
                let choices = policy::choices(kitchen, cost, Fidelity::Searched, future.state, &recipes);
                if !choices.is_empty() {
                    let button = choices[random.random_range(0..choices.len())];
                    future.robot_press = Some((button, future.now_s + press_s, false));
                }
            }
            let Some((button, due_s, driven)) = future.robot_press.filter(|(_, due_s, _)| *due_s <= until_s) else {
                return;
            };
            future.read_by(kitchen, due_s);
            (future.now_s, future.robot_press) = (due_s, None);
            if driven
                || policy::best_presses(kitchen, cost, Fidelity::Searched, future.state, &recipes).contains(&button)
            {
                let before = future.state;
                future.state = kitchen.press(before, &recipes, Agent::Robot, button).unwrap_or(before);
                future.spent += 1;
                if random.random::<f64>() < self.human.transition.foresight {
                    future.person.robot_pressed(kitchen, cost, self.spec.rollout.states, random);
                }
                if random.random::<f64>() < self.human.looking.capture {
                    let now = future.state;
                    future.see(kitchen, |place| before.code(place) != now.code(place));
                }
            }
        }
    }

    /// Lets the human look at locations, decide, and press.
    fn decide(&self, cost: &mut CostToGo, future: &mut Future, random: &mut Stream) {
        let kitchen = &self.kitchen;
        let chance = |rate_hz: f64| 1.0 - (-rate_hz * self.spec.rollout.human_press_s).exp();
        let looks = chance(self.human.looking.looks_hz);
        let other_looks = chance(self.human.looking.other_looks_hz);
        let draw = random.random::<f64>();
        let glances: Vec<f64> = kitchen.locations.iter().map(|_| random.random()).collect();
        future.see(kitchen, |place| glances[place.index()] < other_looks);
        let mut chosen = self.chosen_press(cost, &future.person, draw, random);
        if let Some(button) = chosen {
            let places = kitchen.watched(button).into_iter();
            let seen: Vec<LocationId> = places.filter(|place| glances[place.index()] < looks).collect();
            future.see(kitchen, |place| seen.contains(&place));
            if !seen.is_empty() {
                chosen = self.chosen_press(cost, &future.person, draw, random);
            }
        }
        let before = future.state;
        // A wait counts as a press as long as something is wanted.
        if chosen.is_some() || kitchen.wanted(before).next().is_some() {
            future.spent += 1;
        }
        let Some(button) = chosen else { return };
        let after = kitchen.press(before, &kitchen.true_recipes(), Agent::Human, button);
        // A human whose belief is contradicted by the effect of the press looks at the locations involved.
        let truth = |index: usize| {
            let mut certain = vec![0.0; kitchen.aspects[index].values.len()];
            certain[kitchen.true_value(before, AspectId(index as u8))] = 1.0;
            certain
        };
        let truth: Vec<Vec<f64>> = (0..kitchen.aspects.len()).map(truth).collect();
        future.person.pressed(kitchen, &truth, button, after.is_some());
        future.state = after.unwrap_or(before);
    }

    /// The human's action for a uniform random number `draw`: `None` for waiting, or a press, slips included.
    fn chosen_press(&self, cost: &mut CostToGo, person: &Particle, draw: f64, random: &mut Stream) -> Option<ButtonId> {
        let (kitchen, decision) = (&self.kitchen, &self.human.decision);
        let (here, after) = person.prospects(kitchen, cost, self.spec.rollout.states, random);
        let least = after.iter().copied().fold(f64::INFINITY, f64::min);
        let presses: f64 = after.iter().map(|after| (-decision.tau * (after - least)).exp()).sum();
        let waits = (-decision.tau * (here + decision.wait_cost - 1.0 - least)).exp();
        let p_wait = if waits.is_finite() { waits / (waits + presses) } else { 1.0 };
        if draw < p_wait {
            return None;
        }
        let mut left = (draw - p_wait) / (1.0 - p_wait);
        let chances = press_chances(kitchen, decision, &after);
        let reached = chances.iter().position(|chance| {
            left -= chance;
            left < 0.0
        });
        reached.map(|index| ButtonId(index as u8)).or_else(|| Some(ButtonId(pick(&chances, random) as u8)))
    }
}
