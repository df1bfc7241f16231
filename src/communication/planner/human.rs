//! The human in a rollout: what it holds for possible, how that changes, and what it does.
//!
//! One sample of the belief stands for it: states and recipes drawn from it, equal ones together with their number. Most
//! people hold point-like beliefs, so few different ones are left.

use super::robot::{RobotChoices, RobotPolicy};
use crate::kitchen::cost_to_go::{CostToGo, Fidelity, MAX_BUTTONS};
use crate::kitchen::{Agent, AspectId, AspectKind, ButtonId, ContentId, Kitchen, OrderContent, Recipes, State};
use crate::mind::decision::{DecisionModel, Slips};

/// One way the kitchen may be, and how many of the draws it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    pub state: State,
    pub recipes: Recipes,
    pub count: u32,
}

/// What a human holds for possible.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cases {
    pub all: Vec<Case>,
}

/// What the human does at a decision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HumanChoice {
    Wait,
    Press(ButtonId),
}

impl Cases {
    pub fn copy_from(&mut self, other: &Cases) {
        self.all.clear();
        self.all.extend_from_slice(&other.all);
    }

    /// Adds a draw.
    pub fn add(&mut self, state: State, recipes: Recipes, count: u32) {
        match self.all.iter_mut().find(|case| case.state == state && case.recipes == recipes) {
            Some(case) => case.count += count,
            None => self.all.push(Case { state, recipes, count }),
        }
    }

    /// The number of all draws.
    fn count(&self) -> u32 {
        self.all.iter().map(|case| case.count).sum()
    }

    /// Puts equal ones together.
    fn merge(&mut self) {
        let mut kept = 0;
        for index in 0..self.all.len() {
            let Case { state, recipes, count } = self.all[index];
            match self.all[..kept].iter_mut().find(|case| case.state == state && case.recipes == recipes) {
                Some(case) => case.count += count,
                None => {
                    self.all[kept] = Case { state, recipes, count };
                    kept += 1;
                }
            }
        }
        self.all.truncate(kept);
    }

    /// The truth about an aspect is known from now on; whether that changed anything.
    pub fn learn(&mut self, kitchen: &Kitchen, aspect: AspectId, truth: State) -> bool {
        let mut changed = false;
        match kitchen.aspects[aspect.index()].kind {
            AspectKind::Location(location) => {
                let code = truth.code(location);
                for case in self.all.iter_mut().filter(|case| case.state.code(location) != code) {
                    case.state.set_code(location, code);
                    changed = true;
                }
            }
            AspectKind::Recipe(dish) => {
                let stack: ContentId = kitchen.dish(dish).stack();
                for case in self.all.iter_mut().filter(|case| case.recipes.get(dish) != stack) {
                    case.recipes.set(dish, stack);
                    changed = true;
                }
            }
        }
        if changed {
            self.merge();
        }
        changed
    }

    /// The human pressed a button itself, and knows whether that had an effect: cases where it would have been otherwise are
    /// given up. If none is left, what was involved is looked at: it is as it truly is.
    pub fn pressed(
        &mut self,
        kitchen: &Kitchen,
        button: ButtonId,
        involved: &[AspectId],
        before: State,
        after: Option<State>,
    ) {
        let told = |case: &Case| kitchen.press(case.state, &case.recipes, Agent::Human, button);
        if self.all.iter().any(|case| told(case).is_some() == after.is_some()) {
            self.all.retain_mut(|case| {
                let next = told(case);
                case.state = next.unwrap_or(case.state);
                next.is_some() == after.is_some()
            });
            return self.merge();
        }
        let truth = after.unwrap_or(before);
        for &aspect in involved {
            self.learn(kitchen, aspect, truth);
        }
        if let crate::kitchen::ButtonAction::Serve(order) = kitchen.button(Agent::Human, button).action
            && let OrderContent::Dish(dish) = before.order(order)
        {
            self.learn(kitchen, kitchen.aspect_of_dish(dish), truth);
        }
    }

    /// The human notices that the robot pressed something, not what: every case moves on as the robot's policy would in it,
    /// divided evenly among what it may press. `draw` (0 to 1) decides about remainders.
    pub fn robot_pressed(&mut self, kitchen: &Kitchen, cost: &mut CostToGo, policy: &mut RobotPolicy, draw: f64) {
        let n = self.count();
        for index in 0..self.all.len() {
            let Case { state, recipes, count } = self.all[index];
            let choices: RobotChoices = policy.choices(kitchen, cost, fidelity(count, n), state, &recipes);
            let ways = choices.count();
            if ways == 0 {
                continue;
            }
            let first = (draw * f64::from(ways)) as u32;
            let share = |way: u32| count / ways + u32::from(way < count % ways);
            let after = |way: u32| super::robot::press(kitchen, state, &recipes, choices.nth((first + way) % ways));
            self.all[index].state = after(0);
            self.all[index].count = share(0);
            for way in (1..ways).filter(|&way| share(way) > 0) {
                self.all.push(Case { state: after(way), recipes, count: share(way) });
            }
        }
        self.merge();
    }
}

/// How closely a case of `count` among `n` draws is looked at.
fn fidelity(count: u32, n: u32) -> Fidelity {
    if count * HARDLY >= n { Fidelity::PlanBound } else { Fidelity::LowerBound }
}

/// How the human decides, with what that needs again and again.
#[derive(Clone, Debug)]
pub struct Decider {
    model: DecisionModel,
    slips: Slips,
    /// `[n][k]`: exp(-tau k / n), up to where it vanishes.
    weights: Vec<Vec<f64>>,
    buttons: usize,
}

/// Cases of less than one draw in so many hardly count: their bounds do for their costs.
const HARDLY: u32 = 8;
/// Weights below e^-20 count as 0.
const VANISHES: f64 = 20.0;

/// A decision that is ready to be drawn from.
#[derive(Clone, Copy, Debug)]
pub struct Inclination {
    wait: f64,
    /// By button, what is meant.
    meant: [f64; MAX_BUTTONS],
    total: f64,
}

impl Decider {
    /// For up to `states` draws.
    pub fn new(kitchen: &Kitchen, model: &DecisionModel, states: usize) -> Decider {
        let row = |n: usize| {
            let last = (VANISHES * n as f64 / model.tau) as usize;
            (0..=last).map(|more| model.weight(more, n.max(1))).collect()
        };
        let buttons = kitchen.buttons[Agent::Human.index()].len();
        let weights = (0..=states).map(row).collect();
        Decider { model: model.clone(), slips: Slips::for_kitchen(kitchen), weights, buttons }
    }

    /// What the human is inclined to do: exp(tau Q), Q over the cases; waiting by E[C(s)] + its cost.
    pub fn inclination(&self, cost: &mut CostToGo, cases: &Cases) -> Inclination {
        let mut sums = [0u32; MAX_BUTTONS];
        let n = cases.count();
        let mut here = 0u32;
        for case in &cases.all {
            let decision = cost.decision_with(fidelity(case.count, n), case.state, &case.recipes, Agent::Human);
            here += case.count * u32::from(decision.here);
            for (sum, &after) in sums.iter_mut().zip(&decision.after) {
                *sum += case.count * u32::from(after);
            }
        }
        let sums = &sums[..self.buttons];
        let least = sums.iter().copied().min().unwrap_or(0);
        let row = &self.weights[n as usize];
        let mut meant = [0.0; MAX_BUTTONS];
        let mut total = 0.0;
        for (weight, &sum) in meant.iter_mut().zip(sums) {
            *weight = row.get((sum - least) as usize).copied().unwrap_or(0.0);
            total += *weight;
        }
        let gain = (f64::from(least) - f64::from(here)) / f64::from(n) + 1.0 - self.model.wait_cost;
        let wait = (self.model.tau * gain).min(f64::MAX.ln() / 2.0).exp();
        Inclination { wait, meant, total }
    }

    /// What the human means to do, by a draw from 0 to 1.
    pub fn meant(&self, inclination: &Inclination, draw: f64) -> HumanChoice {
        let mut left = draw * (inclination.wait + inclination.total) - inclination.wait;
        if left < 0.0 {
            return HumanChoice::Wait;
        }
        let mut last = 0;
        for (button, &weight) in inclination.meant[..self.buttons].iter().enumerate() {
            if weight > 0.0 {
                last = button;
                left -= weight;
                if left < 0.0 {
                    break;
                }
            }
        }
        HumanChoice::Press(ButtonId(last as u8))
    }

    /// What is pressed of what is meant: a few presses slip.
    pub fn done(&self, meant: HumanChoice, draw: f64) -> HumanChoice {
        let HumanChoice::Press(button) = meant else { return meant };
        if draw >= self.model.lapse {
            return meant;
        }
        let at = draw / self.model.lapse;
        let anywhere = self.model.lapse_anywhere;
        if at < anywhere {
            return HumanChoice::Press(ButtonId(((at / anywhere) * self.buttons as f64) as u8));
        }
        let [next, alike] = self.slips.of_button(button);
        HumanChoice::Press(if at < (1.0 + anywhere) / 2.0 { next } else { alike })
    }
}
