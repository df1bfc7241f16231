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
    pub fn for_kitchen(kitchen: &Kitchen) -> Slips {
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
        Chances { wait: waits / (waits + total), press: self.slipped(&Slips::for_kitchen(kitchen), &meant) }
    }

    /// What is pressed of what is meant.
    fn slipped(&self, slips: &Slips, meant: &[f64]) -> Vec<f64> {
        let [anywhere, slipping] = self.slip_chances(meant.len());
        let mut pressed: Vec<f64> = meant.iter().map(|p| (1.0 - self.lapse) * p + anywhere).collect();
        for (to, p) in slips.to.iter().zip(meant) {
            for button in to {
                pressed[button.index()] += slipping * p;
            }
        }
        pressed
    }

    /// The chance that a press becomes that of one certain button of so many, whatever was meant, and that it slips to each
    /// of the two that its own may be taken for.
    fn slip_chances(&self, buttons: usize) -> [f64; 2] {
        [self.lapse * self.lapse_anywhere / buttons as f64, self.lapse * (1.0 - self.lapse_anywhere) / 2.0]
    }

    /// exp(tau Q) beside that of the best, of what takes `more` presses more over `draws` draws together.
    pub fn weight(&self, more: usize, draws: usize) -> f64 {
        (-self.tau * more as f64 / draws as f64).exp()
    }
}

/// p(a | b) of a human who presses something, with what that needs again and again.
#[derive(Clone, Debug)]
pub struct PressLikelihood {
    /// `[k]`: exp(-tau k / states), up to where it is 0.
    weights: Vec<f64>,
    /// The share of the presses that are done as they are meant.
    meant: f64,
    /// By button, from which other ones a press slips to it, and with which chance.
    slips: Vec<Vec<(usize, f64)>>,
    /// The chance that a press slips to one certain button, whatever was meant.
    anywhere: f64,
}

impl PressLikelihood {
    /// For beliefs that `states` states and recipes stand for.
    pub fn new(kitchen: &Kitchen, model: &DecisionModel, states: usize) -> PressLikelihood {
        let slips = Slips::for_kitchen(kitchen);
        let buttons = slips.to.len();
        let [anywhere, slipping] = model.slip_chances(buttons);
        let weights = (0..=states * usize::from(u8::MAX)).map(|more| model.weight(more, states));
        let of_button = |button: usize| {
            let times = |to: &[ButtonId; 2]| to.iter().filter(|slipped| slipped.index() == button).count();
            let all = slips.to.iter().map(times).enumerate().filter(|(_, times)| *times > 0);
            all.map(|(from, times)| (from, slipping * times as f64)).collect()
        };
        PressLikelihood {
            weights: weights.take_while(|weight| *weight > 0.0).collect(),
            meant: 1.0 - model.lapse,
            slips: (0..buttons).map(of_button).collect(),
            anywhere,
        }
    }

    /// p(a | b): `sums[x]` is C(s') after button x, summed over the states and recipes that stand for b.
    #[inline]
    pub fn probability(&self, sums: &[u32], button: ButtonId) -> f64 {
        let least = sums.iter().copied().min().unwrap_or(0);
        let weight = |sum: u32| self.weights.get((sum - least) as usize).copied().unwrap_or(0.0);
        let total: f64 = sums.iter().map(|&sum| weight(sum)).sum();
        let slipped = |&(from, chance): &(usize, f64)| chance * weight(sums[from]);
        let slips = self.slips[button.index()].iter().map(slipped);
        let pressed = slips.fold(self.meant * weight(sums[button.index()]), |pressed, slipped| pressed + slipped);
        pressed / total + self.anywhere
    }
}
