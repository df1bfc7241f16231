//! How well a model predicts the presses of the human: log probability per press, beside two humans who need no
//! inference: one who knows everything, with the strictness and the share of slips that suit these presses best, and one
//! who presses anything.

use rand::RngExt;
use serde::Serialize;

use super::press_view::{PressView, TrialView};
use crate::base::minimise::minimise;
use crate::base::rng::stream;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Kitchen, WeightedWorlds, World};
use crate::mind::ChoiceModel;
use crate::mind::decision::DecisionModel;

/// Resamples of the bootstrap.
const RESAMPLES: usize = 2000;
/// The ends of the bootstrap's interval, as shares of the resamples.
const INTERVAL: [f64; 2] = [0.025, 0.975];
/// The fit of the informed human is done when no better fit is in sight by so many nats per press.
const TOLERANCE_NATS: f64 = 1e-6;
/// It takes at most so many tries.
const MOST_TRIES: usize = 200;

/// Mean log probability of a press, in nats.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LogLikelihood {
    /// Under the estimate from before the press; null where nothing estimates.
    pub model: Option<f64>,
    /// Of a human who knows everything, fitted to these presses.
    pub informed: Option<f64>,
    /// Of a human who presses any button.
    pub uniform: Option<f64>,
    /// By how much the model is better than the informed human, and the interval of 95 % that a bootstrap over trials gives.
    pub gain: Option<f64>,
    pub gain_interval: Option<[f64; 2]>,
    /// What fits the informed human best.
    pub informed_tau: Option<f64>,
    pub informed_lapse: Option<f64>,
}

impl LogLikelihood {
    /// Of all presses of these trials. Random numbers of the bootstrap follow from `seed`.
    pub fn from_trials(
        kitchen: &Kitchen,
        cost: &mut CostToGo,
        model: &DecisionModel,
        trials: &[TrialView],
        seed: u64,
    ) -> LogLikelihood {
        let presses = trials.iter().map(Vec::len).sum::<usize>() as f64;
        if presses == 0.0 {
            return LogLikelihood::default();
        }
        let total = |informed: &DecisionModel, cost: &mut CostToGo| -> Vec<f64> {
            let model = ChoiceModel::new(kitchen, informed);
            trials.iter().map(|trial| trial.iter().map(|press| log_p(kitchen, cost, &model, press)).sum()).collect()
        };
        let with = |at: &[f64]| DecisionModel { tau: at[0].exp(), lapse: logistic(at[1]), ..model.clone() };
        let start = [model.tau.ln(), logit(model.lapse)];
        let loss = |at: &[f64]| -total(&with(at), cost).iter().sum::<f64>() / presses;
        let best = with(&minimise(loss, &start, &[-0.5, 0.5], TOLERANCE_NATS, MOST_TRIES).at);
        let informed = total(&best, cost);
        let estimated: Option<Vec<f64>> = trials
            .iter()
            .map(|trial| trial.iter().map(|press| Some(press.estimate.as_ref()?.log_p)).sum::<Option<f64>>())
            .collect();
        let gains = estimated.as_ref().map(|estimated| -> Vec<(f64, f64)> {
            let both = estimated.iter().zip(&informed).zip(trials);
            both.map(|((model, informed), trial)| (model - informed, trial.len() as f64)).collect()
        });
        LogLikelihood {
            model: estimated.map(|estimated| estimated.iter().sum::<f64>() / presses),
            informed: Some(informed.iter().sum::<f64>() / presses),
            uniform: Some(-(kitchen.buttons[Agent::Human.index()].len() as f64).ln()),
            gain: gains.as_ref().map(|gains| ratio(gains.iter())),
            gain_interval: gains.map(|gains| interval(&gains, seed)),
            informed_tau: Some(best.tau),
            informed_lapse: Some(best.lapse),
        }
    }
}

/// The log probability of a press for somebody who knows everything.
fn log_p(kitchen: &Kitchen, cost: &mut CostToGo, model: &ChoiceModel, press: &PressView) -> f64 {
    let truth = WeightedWorlds::certain(World::with_true_recipes(kitchen, press.state));
    model.probabilities(cost, &truth).press[press.button.index()].ln()
}

fn logit(p: f64) -> f64 {
    let p = p.clamp(1e-6, 1.0 - 1e-6);
    (p / (1.0 - p)).ln()
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// The sum of the first over the sum of the second.
fn ratio<'a>(pairs: impl Iterator<Item = &'a (f64, f64)>) -> f64 {
    let (gain, presses) = pairs.fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
    gain / presses
}

/// A percentile interval of the gain per press: trials are drawn with replacement (Efron and Tibshirani 1993).
fn interval(gains: &[(f64, f64)], seed: u64) -> [f64; 2] {
    let mut random = stream(seed, "bootstrap over trials", 0);
    let mut resampled: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn: Vec<(f64, f64)> = gains.iter().map(|_| gains[random.random_range(0..gains.len())]).collect();
            ratio(drawn.iter())
        })
        .collect();
    resampled.sort_by(f64::total_cmp);
    INTERVAL.map(|share| resampled[((RESAMPLES - 1) as f64 * share).round() as usize])
}
