//! Perception where every gaze sample is an observation (paper, equation 1): the human sees o with the probability
//! c(o | s) of the true content s, and updates a belief b by Bayes' rule, b'_v = c(o | v) b_v / sum_u c(o | u) b_u.
//!
//! The observer does not know o, and b is Dirichlet, so the update is averaged over both. With b_v = g_v / sum_u g_u
//! for independent g_v ~ Gamma(alpha_v), w_v = c(o | v) and 1 / x^n = integral of t^(n - 1) exp(-t x) / (n - 1)! over
//! t,
//!
//! ```text
//! E[b'_v]   = alpha_v               integral of (w_v / (1 + t w_v))     P(t) dt
//! E[b'_v^2] = alpha_v (alpha_v + 1) integral of t (w_v / (1 + t w_v))^2 P(t) dt
//! P(t)      = product over u of (1 + t w_u)^(-alpha_u)
//! ```
//!
//! With t = e^x the integrands are analytic and fall exponentially on both sides, so the trapezoidal rule is exact to
//! about ten digits; what lies beyond its ends is a geometric series.

use crate::kitchen::{Kitchen, LocationId};
use crate::mind::dirichlet::{Dirichlet, LEAST_MEAN, PRECISIONS};
use crate::mind::model::PerceptionModel;

/// Contents that would be read with a smaller probability than this are ignored.
pub const NEGLIGIBLE: f64 = 1e-9;

/// Distance of neighbouring points x of the trapezoidal rule.
const STEP: f64 = 0.375;
/// At the first point, t times the largest precision is e^-SIDE; at the last one, t times the smallest weight is
/// e^SIDE.
const SIDE: f64 = 20.0;
/// Least weight c(o | v), so that an observation which the human holds to be impossible leaves a proper belief.
const LEAST_WEIGHT: f64 = 1e-9;

/// A weight c(o | v) at the points of the trapezoidal rule: ln(1 + t w), and t w / (1 + t w).
#[derive(Clone, Debug)]
struct WeightAtPoints(Vec<[f64; 2]>);

/// The observations that a gaze sample can give of one location.
#[derive(Clone, Debug)]
struct LocationObservations {
    /// `[s][o]`: probability c(o | s) of observing value o where value s is displayed.
    confusion: Vec<Vec<f64>>,
    /// `[o][v]`: index of c(o | v) among the weights.
    weight_of: Vec<Vec<usize>>,
}

/// The update of beliefs by observations of single gaze samples.
#[derive(Clone, Debug)]
pub struct SampleObservations {
    weights: Vec<WeightAtPoints>,
    locations: Vec<LocationObservations>,
}

/// Values of one class: those with the same weight c(o | v).
#[derive(Clone, Copy, Debug, Default)]
struct ValueClass {
    /// Sum of the alphas, and of alpha (alpha + 1).
    alpha: f64,
    squares: f64,
    /// Integrals of the first and of the second moment, before multiplication with the alphas.
    integrals: [f64; 2],
}

impl SampleObservations {
    /// The update for this kitchen.
    pub fn new(kitchen: &Kitchen, model: &PerceptionModel) -> SampleObservations {
        let mut all: Vec<f64> = Vec::new();
        let mut index_of = |weight: f64| {
            let weight = weight.max(LEAST_WEIGHT);
            all.iter().position(|other| *other == weight).unwrap_or_else(|| {
                all.push(weight);
                all.len() - 1
            })
        };
        let of_location = |index: usize| {
            let values = kitchen.aspects[index].values.len();
            let of_value = |value: usize| model.confusion(kitchen, LocationId(index as u8), value);
            let confusion: Vec<Vec<f64>> = (0..values).map(of_value).collect();
            let of_observed = |seen: usize| confusion.iter().map(|row| index_of(row[seen])).collect();
            let weight_of = (0..values).map(of_observed).collect();
            LocationObservations { confusion, weight_of }
        };
        let locations = (0..kitchen.locations.len()).map(of_location).collect();
        let least = all.iter().copied().fold(1.0, f64::min);
        let [first, last] = [-PRECISIONS[1].ln() - SIDE, SIDE - least.ln()];
        let times: Vec<f64> =
            (0..=((last - first) / STEP).ceil() as usize).map(|point| (first + STEP * point as f64).exp()).collect();
        let at_points = |weight: f64| {
            WeightAtPoints(times.iter().map(|t| [(t * weight).ln_1p(), t * weight / (1.0 + t * weight)]).collect())
        };
        SampleObservations { weights: all.into_iter().map(at_points).collect(), locations }
    }

    /// Updates the belief about a location by an observation of it, where the value `truth` is displayed.
    pub fn observe(&self, belief: &mut Dirichlet, location: usize, truth: usize) {
        let LocationObservations { confusion, weight_of } = &self.locations[location];
        let values = belief.mean().len();
        // A belief that is as certain as a Dirichlet may be here stays what it is.
        if 1.0 - belief.mean()[truth] <= 2.0 * LEAST_MEAN * values as f64 {
            return;
        }
        let alphas: Vec<f64> = (0..values).map(|value| belief.alpha(value)).collect();
        let (mut mean, mut second) = (vec![0.0; values], 0.0);
        let mut classes = vec![ValueClass::default(); self.weights.len()];
        for (seen, &p) in confusion[truth].iter().enumerate().filter(|(_, p)| **p >= NEGLIGIBLE) {
            classes.fill(ValueClass::default());
            for (alpha, &weight) in alphas.iter().zip(&weight_of[seen]) {
                classes[weight].alpha += alpha;
                classes[weight].squares += alpha * (alpha + 1.0);
            }
            self.integrate(&mut classes, belief.precision());
            for ((mean, alpha), &weight) in mean.iter_mut().zip(&alphas).zip(&weight_of[seen]) {
                *mean += p * alpha * classes[weight].integrals[0];
            }
            second += p * classes.iter().map(|class| class.squares * class.integrals[1]).sum::<f64>();
        }
        *belief = Dirichlet::of_moments(mean, second);
    }

    /// Computes the integrals of all classes that have values.
    fn integrate(&self, classes: &mut [ValueClass], precision: f64) {
        let used: Vec<usize> = (0..classes.len()).filter(|&index| classes[index].alpha > 0.0).collect();
        let points = self.weights[used[0]].0.len();
        let mut last = 0.0;
        for point in 0..points {
            let exponent: f64 = used.iter().map(|&index| classes[index].alpha * self.weights[index].0[point][0]).sum();
            last = STEP * (-exponent).exp();
            for &index in &used {
                let ratio = self.weights[index].0[point][1];
                let [first, second] = &mut classes[index].integrals;
                *first += last * ratio;
                *second += last * ratio * ratio;
            }
        }
        // Before the first point the integrands are proportional to t and t^2; after the last one to t^-precision.
        let after = last / (precision * STEP).exp_m1();
        for &index in &used {
            let ratio = self.weights[index].0[0][1];
            let [first, second] = &mut classes[index].integrals;
            *first += STEP * ratio / STEP.exp_m1() + after;
            *second += STEP * ratio * ratio / (2.0 * STEP).exp_m1() + after;
        }
    }
}
