//! The decision part of the human model: a press is the likelier, the fewer presses are expected to be left after it.
//!
//! p(a | b) ~ exp(tau Q(b, a)) with Q(b, a) = -E_b[1 + C(s')] over the states and recipes of belief b, and
//! -(E_b[C(s)] + 0.5) for waiting (paper, section "Human model"). A few presses slip: to the neighbouring button, to the
//! look-alike symbol, or anywhere.

use serde::{Deserialize, Serialize};

use super::belief::{Belief, Case};
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, ButtonId, Kitchen};

/// The parameters of a decision.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DecisionModel {
    /// How strictly fewer expected presses are preferred, per press.
    pub tau: f64,
    /// The share of presses that slip.
    pub lapse: f64,
    /// The share of the slips that go to any button; the others go to the neighbour and to the look-alike, evenly.
    pub lapse_anywhere: f64,
    /// What waiting costs, in presses.
    pub wait_cost: f64,
    /// So many states and recipes stand for a belief.
    pub cases: usize,
}

impl Default for DecisionModel {
    fn default() -> Self {
        DecisionModel { tau: 4.0, lapse: 0.03, lapse_anywhere: 0.3, wait_cost: 0.5, cases: 32 }
    }
}

/// What a human does next, and how likely.
#[derive(Clone, Debug, PartialEq)]
pub struct Chances {
    /// Waits.
    pub wait: f64,
    /// Presses this button, by [`ButtonId`], given that it presses one.
    pub press: Vec<f64>,
}

/// Where presses slip to: to the neighbouring button and to the one with the look-alike symbol.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slips {
    /// By the button that is meant: the nearest other one, and the look-alike or else again the nearest one.
    to: Vec<[ButtonId; 2]>,
}

impl Slips {
    /// Those of the human's buttons.
    pub fn of(kitchen: &Kitchen) -> Slips {
        let buttons = (0..kitchen.buttons[Agent::Human.index()].len()).map(|index| ButtonId(index as u8));
        let to = buttons.map(|button| {
            let next = kitchen.nearest_button(Agent::Human, button).unwrap_or(button);
            [next, kitchen.look_alike_button(Agent::Human, button).unwrap_or(next)]
        });
        Slips { to: to.collect() }
    }

    /// Where a press that is meant for this button slips to, either as likely.
    pub fn of_button(&self, button: ButtonId) -> [ButtonId; 2] {
        self.to[button.index()]
    }
}

impl DecisionModel {
    /// The ways the kitchen may be that stand for a belief in this model.
    pub fn cases(&self, kitchen: &Kitchen, belief: &Belief, random: &mut Stream) -> Vec<Case> {
        belief.cases(kitchen, self.cases.max(1), random)
    }

    /// What a human does who holds these cases for possible.
    pub fn chances(&self, kitchen: &Kitchen, cost: &mut CostToGo, cases: &[Case]) -> Chances {
        let count = kitchen.buttons[Agent::Human.index()].len();
        let mut here = 0.0;
        let mut after = [0.0; MAX_BUTTONS];
        for case in cases {
            let decision = cost.decision(case.state, &case.recipes, Agent::Human);
            here += case.weight * f64::from(decision.here);
            for (sum, &value) in after.iter_mut().zip(&decision.after[..count]) {
                *sum += case.weight * f64::from(value);
            }
        }
        let least = after[..count].iter().copied().fold(f64::INFINITY, f64::min);
        let meant: Vec<f64> = after[..count].iter().map(|value| (-self.tau * (value - least)).exp()).collect();
        let total: f64 = meant.iter().sum();
        let waits = (-self.tau * (here + self.wait_cost - 1.0 - least)).min(f64::MAX.ln() / 2.0).exp();
        let meant: Vec<f64> = meant.iter().map(|weight| weight / total).collect();
        Chances { wait: waits / (waits + total), press: self.slipped(&Slips::of(kitchen), &meant) }
    }

    /// p(a | b) of a human who presses something. `sums[x]` is C(s') after button x, summed over `states` states and
    /// recipes drawn from b.
    pub fn press_chance(&self, slips: &Slips, sums: &[u32], states: f64, button: ButtonId) -> f64 {
        let least = sums.iter().copied().min().unwrap_or(0);
        let mut meant = [0.0; MAX_BUTTONS];
        let mut total = 0.0;
        for (weight, &sum) in meant.iter_mut().zip(sums) {
            *weight = match sum == least {
                true => 1.0,
                false => (-self.tau * f64::from(sum - least) / states).exp(),
            };
            total += *weight;
        }
        let slipping = self.lapse * (1.0 - self.lapse_anywhere) / 2.0;
        let mut pressed = (1.0 - self.lapse) * meant[button.index()];
        for (to, weight) in slips.to.iter().zip(&meant) {
            let here = to.iter().filter(|&&slipped| slipped == button).count();
            pressed += slipping * here as f64 * weight;
        }
        pressed / total + self.lapse * self.lapse_anywhere / sums.len() as f64
    }

    /// What is pressed of what is meant.
    fn slipped(&self, slips: &Slips, meant: &[f64]) -> Vec<f64> {
        let anywhere = self.lapse * self.lapse_anywhere / meant.len() as f64;
        let slipping = self.lapse * (1.0 - self.lapse_anywhere) / 2.0;
        let mut pressed: Vec<f64> = meant.iter().map(|p| (1.0 - self.lapse) * p + anywhere).collect();
        for (to, p) in slips.to.iter().zip(meant) {
            for button in to {
                pressed[button.index()] += slipping * p;
            }
        }
        pressed
    }
}
