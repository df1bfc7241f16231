//! Predictive accuracy of the human model: mean log probability per press, compared with two baselines that need no
//! inference. One baseline (informed human) knows the true world, with softmax temperature and lapse rate fitted to
//! these presses; the other baseline presses random buttons.

use serde::Serialize;
use statrs::function::logistic::{logistic, logit};

use super::fitting::response_surface::{REACH, surface};
use crate::statistics::intervals;
use tomcom_core::kitchen::cost_to_go::CostToGo;
use tomcom_core::kitchen::{Agent, Kitchen, WeightedWorlds, World};
use tomcom_core::measures::detection::{BeliefsBeforePress, TrialBeliefs};
use tomcom_core::mind::ChoiceModel;
use tomcom_core::mind::choice::ChoiceParameters;

/// Gain below which the fit of the baseline "informed human" takes a finer surface, or ends, in nats per press.
const TOLERANCE_NATS: f64 = 1e-6;
/// First and last step of the surfaces of that fit.
const STEPS: [f64; 2] = [0.5, 0.05];
/// Largest number of surfaces of that fit.
const MOST_SURFACES: usize = 60;

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PressLogLikelihood {
    /// Mean log probability under the human model with the estimated belief before the press; null without an estimate.
    pub model: Option<f64>,
    /// Mean log probability under the baseline "informed human", who knows the true world, fitted to these presses.
    pub informed: Option<f64>,
    pub uniform: Option<f64>,
    /// Difference of mean log probability between the human model and the informed human, in nats per press.
    pub gain: Option<f64>,
    /// 95 % interval of the difference `gain`, by a bootstrap over participants.
    pub gain_interval: Option<[f64; 2]>,
    /// Value of the softmax parameter tau of the choice model, per press, that fits the informed human best.
    pub informed_tau: Option<f64>,
    pub informed_lapse: Option<f64>,
}

impl PressLogLikelihood {
    /// `participants`: the participant of each trial, below their number. `seed`: of the bootstrap.
    pub fn from_trials(
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        model: &ChoiceParameters,
        trials: &[TrialBeliefs],
        participants: &[usize],
        seed: u64,
    ) -> PressLogLikelihood {
        let presses = trials.iter().map(Vec::len).sum::<usize>() as f64;
        if presses == 0.0 {
            return PressLogLikelihood::default();
        }
        let total = |informed: &ChoiceParameters, cost: &mut CostToGo| -> Vec<f64> {
            let model = ChoiceModel::new(kitchen, informed);
            trials.iter().map(|trial| trial.iter().map(|press| log_p(kitchen, cost, &model, press)).sum()).collect()
        };
        let with = |at: &[f64]| ChoiceParameters { tau: at[0].exp(), lapse: logistic(at[1]), ..model.clone() };
        let start = [model.tau.ln(), logit(model.lapse.clamp(1e-6, 1.0 - 1e-6))];
        let loss = |at: &[f64]| -total(&with(at), cost).iter().sum::<f64>() / presses;
        let best = with(&least(loss, start));
        let informed = total(&best, cost);
        let estimated: Option<Vec<f64>> = trials
            .iter()
            .map(|trial| trial.iter().map(|press| Some(press.estimate.as_ref()?.log_p)).sum::<Option<f64>>())
            .collect();
        let gains = estimated.as_ref().map(|estimated| -> Vec<(f64, f64)> {
            let number = participants.iter().map(|participant| participant + 1).max().unwrap_or(0);
            let mut sums = vec![(0.0, 0.0); number];
            let both = estimated.iter().zip(&informed).zip(trials).zip(participants);
            for (((model, informed), trial), &participant) in both {
                let (gain, presses) = sums[participant];
                sums[participant] = (gain + model - informed, presses + trial.len() as f64);
            }
            sums
        });
        PressLogLikelihood {
            model: estimated.map(|estimated| estimated.iter().sum::<f64>() / presses),
            informed: Some(informed.iter().sum::<f64>() / presses),
            uniform: Some(-(kitchen.buttons[Agent::Human.index()].len() as f64).ln()),
            gain: gains.as_ref().map(|gains| ratio(gains)),
            gain_interval: gains.map(|gains| intervals(&gains, seed, |drawn| [ratio(drawn)])[0]),
            informed_tau: Some(best.tau),
            informed_lapse: Some(best.lapse),
        }
    }
}

/// Where a loss without noise is least: each step leads to the minimum of a quadratic surface.
fn least(mut loss: impl FnMut(&[f64]) -> f64, mut at: [f64; 2]) -> [f64; 2] {
    let mut step = STEPS[0];
    for _ in 0..MOST_SURFACES {
        let Some(surface) = surface(&mut loss, &at, &[step; 2]) else { break };
        let by = surface.least(&[-REACH; 2], &[REACH; 2]);
        at.iter_mut().zip(&by).for_each(|(at, by)| *at += by * step);
        if surface.value - surface.at(&by) > TOLERANCE_NATS {
            continue;
        }
        if step <= STEPS[1] {
            break;
        }
        step = (step / 4.0).max(STEPS[1]);
    }
    at
}

/// Log probability of a press by a human who knows the true world.
fn log_p(kitchen: &Kitchen, cost: &mut CostToGo, model: &ChoiceModel, press: &BeliefsBeforePress) -> f64 {
    let truth = WeightedWorlds::certain(World::with_true_recipes(kitchen, press.state));
    model.probabilities(cost, &truth).press[press.button.index()].ln()
}

/// Ratio of the sum of the first elements to the sum of the second elements.
fn ratio(pairs: &[(f64, f64)]) -> f64 {
    let (gain, presses) = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
    gain / presses
}
