//! The choice model: a softmax with lapses over the expected cost to go.
//!
//! p(a | b) ~ exp(tau Q(b, a)) with Q(b, a) = -E_b[1 + C(s')] over the worlds of belief b, and -(E_b[C(s)] + 0.5) for
//! waiting (paper, section "Human model"). A small share of presses are slips: to the neighbouring button, to the
//! button with the look-alike symbol, or to any button. The belief filter uses the likelihood of one press, the planner
//! draws choices, and the attribution of errors uses all probabilities. The reference implementations of filter and
//! planner implement the same choice model a second time, so that tests can compare the two.

use super::belief::Belief;
use super::model::model_table;
use crate::base::rng::Stream;
use crate::kitchen::cost_to_go::{CostToGo, MAX_BUTTONS};
use crate::kitchen::{Agent, ButtonId, Kitchen, WeightedWorlds};

/// Exponent of negligible softmax weights: the planner counts weights below e^-20 as 0.
const NEGLIGIBLE_EXPONENT: f64 = 20.0;

/// Largest cost to go in presses, since a cost to go is stored in a byte.
const MOST_PRESSES: usize = u8::MAX as usize;

/// A choice of the human: to press one of the human's buttons, or to wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HumanChoice {
    /// The human presses nothing now.
    Wait,
    /// The human presses this button.
    Press(ButtonId),
}

/// The probabilities of all choices of the human: of waiting, and of each button.
#[derive(Clone, Debug, PartialEq)]
pub struct ChoiceProbabilities {
    /// Probability that the human waits.
    pub wait: f64,
    /// Probability of each button, by [`ButtonId`], given that a button is pressed.
    pub press: Vec<f64>,
}

/// The softmax weights of all choices in one decision, before slips. The planner draws choices from these weights.
#[derive(Clone, Copy, Debug)]
pub struct ChoiceWeights {
    wait: f64,
    press: [f64; MAX_BUTTONS],
    total: f64,
}

/// Predicts the choices of a human from the human's belief (softmax with lapses).
#[derive(Clone, Debug)]
pub struct ChoiceModel {
    parameters: ChoiceParameters,
    /// For each intended button, the two buttons that a slip may hit: the nearest other button, and the button with the
    /// look-alike symbol (the nearest button again where no button looks alike).
    slips_to: Vec<[ButtonId; 2]>,
    /// For each button, the other intended buttons from which a slip hits this button, with the probability of that
    /// slip.
    slips_from: Vec<Vec<(usize, f64)>>,
    /// Probability that a press slips to one given button, whichever button is intended.
    anywhere: f64,
    /// Probability that a press slips to the neighbour of the intended button or, respectively, to its look-alike.
    slipping: f64,
    /// `[n][k]`: exp(-tau k / n), the weight of a button whose cost to go, summed over n draws, exceeds that of the
    /// best button by k presses.
    weights: Vec<Vec<f64>>,
}

impl ChoiceModel {
    /// The choice model for beliefs that are represented by weighted worlds.
    pub fn new(kitchen: &Kitchen, parameters: &ChoiceParameters) -> ChoiceModel {
        let buttons = kitchen.button_ids(Agent::Human);
        let slips = |button| {
            let next = kitchen.nearest_button(Agent::Human, button).unwrap_or(button);
            [next, kitchen.look_alike_button(Agent::Human, button).unwrap_or(next)]
        };
        let slips_to: Vec<[ButtonId; 2]> = buttons.map(slips).collect();
        let [anywhere, slipping] = parameters.slip_probabilities(slips_to.len());
        let of_button = |button: usize| {
            let times = |to: &[ButtonId; 2]| to.iter().filter(|slipped| slipped.index() == button).count();
            let all = slips_to.iter().map(times).enumerate().filter(|(_, times)| *times > 0);
            all.map(|(from, times)| (from, slipping * times as f64)).collect()
        };
        let slips_from = (0..slips_to.len()).map(of_button).collect();
        ChoiceModel { parameters: parameters.clone(), slips_from, slips_to, anywhere, slipping, weights: Vec::new() }
    }

    /// The choice model for beliefs represented by exactly `draws` drawn worlds. Softmax weights are not truncated.
    pub(crate) fn for_draws(kitchen: &Kitchen, parameters: &ChoiceParameters, draws: usize) -> ChoiceModel {
        let mut model = ChoiceModel::new(kitchen, parameters);
        let row = (0..=draws * MOST_PRESSES).map(|more| parameters.weight(more, draws));
        model.weights.resize(draws, Vec::new());
        model.weights.push(row.take_while(|weight| *weight > 0.0).collect());
        model
    }

    /// The choice model for beliefs represented by at most `draws` drawn worlds. Softmax weights below e^-20 are 0.
    pub fn up_to_draws(kitchen: &Kitchen, parameters: &ChoiceParameters, draws: usize) -> ChoiceModel {
        let row = |n: usize| {
            let last = (NEGLIGIBLE_EXPONENT * n as f64 / parameters.tau).min((n * MOST_PRESSES) as f64) as usize;
            (0..=last).map(|more| parameters.weight(more, n.max(1))).collect()
        };
        ChoiceModel { weights: (0..=draws).map(row).collect(), ..ChoiceModel::new(kitchen, parameters) }
    }

    /// The number of tabulated softmax weights.
    pub fn tabulated(&self) -> usize {
        self.weights.iter().map(Vec::len).sum()
    }

    /// The number of the human's buttons.
    pub fn buttons(&self) -> usize {
        self.slips_to.len()
    }

    /// The probabilities of all choices of a human whose belief is given by weighted worlds.
    pub fn probabilities(&self, cost: &mut CostToGo, worlds: &WeightedWorlds) -> ChoiceProbabilities {
        let (tau, count) = (self.parameters.tau, self.buttons());
        let mut here = 0.0;
        let mut after = [0.0; MAX_BUTTONS];
        for one in &worlds.all {
            let decision = cost.decision(one.world.state, &one.world.recipes, Agent::Human);
            here += one.weight * f64::from(decision.here);
            for (sum, &value) in after.iter_mut().zip(&decision.after[..count]) {
                *sum += one.weight * f64::from(value);
            }
        }
        let least = after[..count].iter().copied().fold(f64::INFINITY, f64::min);
        let intended: Vec<f64> = after[..count].iter().map(|value| (-tau * (value - least)).exp()).collect();
        let total: f64 = intended.iter().sum();
        let wait = (-tau * (here + self.parameters.wait_cost - 1.0 - least)).min(f64::MAX.ln() / 2.0).exp();
        let intended: Vec<f64> = intended.iter().map(|weight| weight / total).collect();
        ChoiceProbabilities { wait: wait / (wait + total), press: self.with_slips(&intended) }
    }

    /// Probability that each button is pressed, from the probability that each button is intended: applies slips.
    fn with_slips(&self, intended: &[f64]) -> Vec<f64> {
        let lapse = self.parameters.lapse;
        let mut pressed: Vec<f64> = intended.iter().map(|p| (1.0 - lapse) * p + self.anywhere).collect();
        for (to, p) in self.slips_to.iter().zip(intended) {
            for button in to {
                pressed[button.index()] += self.slipping * p;
            }
        }
        pressed
    }

    /// The tabulated softmax weights for the number of draws of [`ChoiceModel::for_draws`].
    #[inline]
    fn draws_row(&self) -> &[f64] {
        self.weights.last().map_or(&[], Vec::as_slice)
    }

    /// Probabilities of the slips that hit a button while another one is intended, each times the weight of the
    /// intended button.
    #[inline]
    fn slips_to_button<'a>(
        &'a self,
        button: usize,
        weight: &'a impl Fn(usize) -> f64,
    ) -> impl Iterator<Item = f64> + 'a {
        self.slips_from[button].iter().map(move |&(from, chance)| chance * weight(from))
    }

    /// Likelihood p(a | b), given that a button is pressed. `sums[x]` is the cost to go after button x, in presses,
    /// summed over the drawn worlds that represent the belief b. Needs a model from [`ChoiceModel::for_draws`].
    #[inline]
    pub(crate) fn press_likelihood(&self, sums: &[u32], button: ButtonId) -> f64 {
        let weight = relative_weights(self.draws_row(), sums, fewest(sums));
        let total: f64 = (0..sums.len()).map(&weight).sum();
        let intended = (1.0 - self.parameters.lapse) * weight(button.index());
        let pressed =
            self.slips_to_button(button.index(), &weight).fold(intended, |pressed, slipped| pressed + slipped);
        pressed / total + self.anywhere
    }

    /// p(a | b) of every button, given that a button is pressed, from the same sums as
    /// [`ChoiceModel::press_likelihood`].
    pub(crate) fn press_probabilities(&self, sums: &[u32]) -> [f64; MAX_BUTTONS] {
        let (intended, total) = all_weights(self.draws_row(), sums, fewest(sums));
        let weight = |button: usize| intended[button];
        let mut pressed = [0.0; MAX_BUTTONS];
        for (button, pressed) in pressed.iter_mut().enumerate().take(self.buttons()) {
            let slipped: f64 = self.slips_to_button(button, &weight).sum();
            *pressed = ((1.0 - self.parameters.lapse) * weight(button) + slipped) / total + self.anywhere;
        }
        pressed
    }

    /// The softmax weights of all choices. `here` is the cost to go of the present state and `sums[x]` the cost to go
    /// after button x, both in presses and summed over `draws` drawn worlds. Needs a model that has the weights for
    /// this number of draws.
    #[inline]
    pub fn weights(&self, here: u32, sums: &[u32], draws: u32) -> ChoiceWeights {
        let least = fewest(sums);
        let (press, total) = all_weights(&self.weights[draws as usize], sums, least);
        let gain = (f64::from(least) - f64::from(here)) / f64::from(draws) + 1.0 - self.parameters.wait_cost;
        let wait = (self.parameters.tau * gain).min(f64::MAX.ln() / 2.0).exp();
        ChoiceWeights { wait, press, total }
    }

    /// The choice that the human intends, before slips; the random number `draw` is uniform in [0, 1).
    pub fn intended(&self, weights: &ChoiceWeights, draw: f64) -> HumanChoice {
        let mut left = draw * (weights.wait + weights.total) - weights.wait;
        if left < 0.0 {
            return HumanChoice::Wait;
        }
        let mut last = 0;
        for (button, &weight) in weights.press[..self.buttons()].iter().enumerate() {
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

    /// The choice that the human executes, slips included; the random number `draw` is uniform in [0, 1).
    pub(crate) fn executed(&self, intended: HumanChoice, draw: f64) -> HumanChoice {
        let HumanChoice::Press(button) = intended else { return intended };
        let ChoiceParameters { lapse, lapse_anywhere: anywhere, .. } = self.parameters;
        if draw >= lapse {
            return intended;
        }
        let at = draw / lapse;
        if at < anywhere {
            return HumanChoice::Press(ButtonId(((at / anywhere) * self.buttons() as f64) as u8));
        }
        let [next, alike] = self.slips_to[button.index()];
        HumanChoice::Press(if at < (1.0 + anywhere) / 2.0 { next } else { alike })
    }
}

/// The smallest of the costs to go after the buttons, summed over draws.
#[inline]
fn fewest(sums: &[u32]) -> u32 {
    sums.iter().copied().min().unwrap_or(0)
}

/// The softmax weight of each button, by its index, relative to the best button. `sums` are the costs to go after the
/// buttons, summed over draws, `least` is the smallest of them, and `row` is the table of weights for the number of
/// draws; weights beyond it are 0.
#[inline]
fn relative_weights<'a>(row: &'a [f64], sums: &'a [u32], least: u32) -> impl Fn(usize) -> f64 + 'a {
    move |button| row.get((sums[button] - least) as usize).copied().unwrap_or(0.0)
}

/// The softmax weights of all buttons as in [`relative_weights`], and their sum.
#[inline]
fn all_weights(row: &[f64], sums: &[u32], least: u32) -> ([f64; MAX_BUTTONS], f64) {
    let weight = relative_weights(row, sums, least);
    let (mut weights, mut total) = ([0.0; MAX_BUTTONS], 0.0);
    for (button, own) in weights.iter_mut().enumerate().take(sums.len()) {
        *own = weight(button);
        total += *own;
    }
    (weights, total)
}

model_table! {
    /// Parameters of the choice model (paper, section "Human model").
    ChoiceParameters, GivenChoice, decision {
        /// Softmax rationality tau, per press: how strongly a lower expected cost to go is preferred.
        tau: f64,
        /// The lapse rate: share of presses that are slips.
        lapse: f64,
        /// Share of the slips that hit any button at random. The other slips hit the neighbouring button and the
        /// look-alike button with equal probability.
        lapse_anywhere: f64,
        /// Cost of waiting instead of pressing, in presses, in the choice model.
        wait_cost: f64,
        /// Number of drawn worlds that represent a belief.
        cases: usize,
    }
}

impl ChoiceParameters {
    /// The worlds that represent the human's belief in this choice model.
    pub fn worlds(&self, kitchen: &Kitchen, belief: &Belief, random: &mut Stream) -> WeightedWorlds {
        belief.worlds(kitchen, self.cases.max(1), random)
    }

    /// For a kitchen with `buttons` buttons: the probability that a press slips to one given button, whichever is
    /// intended, and the probability that it slips to the neighbour or, respectively, to the look-alike.
    pub(crate) fn slip_probabilities(&self, buttons: usize) -> [f64; 2] {
        [self.lapse * self.lapse_anywhere / buttons as f64, self.lapse * (1.0 - self.lapse_anywhere) / 2.0]
    }

    /// exp(tau Q) relative to the best button, for a button whose cost to go, summed over `draws` draws, is higher by
    /// `more` presses.
    pub fn weight(&self, more: usize, draws: usize) -> f64 {
        (-self.tau * more as f64 / draws as f64).exp()
    }
}
