//! A mixed negative binomial model of counts: y ~ NB(mu, size), log mu = log exposure + X beta + b, b ~ N(0, v_b) per
//! participant; variance mu + mu^2 / size. Errors come in runs, so that the variance of counts exceeds their mean.
//!
//! Maximum likelihood with Laplace's approximation of the integral over b (Brooks et al. 2017, The R Journal 9, section
//! 2), by Newton's method with numeric derivatives. Tests are Wald's z tests. `tests/outside/arms.py` compares the
//! model with glmmTMB where that is installed, and the likelihood with numeric integration.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;

/// Bounds of the logarithms of the participants' standard deviation and of the size parameter; at these bounds,
/// participants do not differ, or counts follow a Poisson distribution.
const LOG_SD: [f64; 2] = [-7.0, 3.0];
const LOG_SIZE: [f64; 2] = [-5.0, 12.0];
/// Step size of numeric derivatives of the likelihood.
const STEP: f64 = 1e-4;
/// Gain of a step, in nats, below which Newton's method ends.
const GAIN: f64 = 1e-10;
const MOST_STEPS: usize = 200;

#[derive(Clone, Debug, PartialEq)]
pub struct CountObservation {
    pub participant: usize,
    pub effects: Vec<f64>,
    pub count: u64,
    /// Exposure: the amount over which events are counted, such as presses; above 0.
    pub exposure: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct NegativeBinomialModel {
    pub estimates: Vec<f64>,
    pub covariance: DMatrix<f64>,
    /// Standard deviation between participants, on the log scale; 0 where participants do not differ.
    pub between_sd: f64,
    /// Size parameter: the variance of a count is mu + mu^2 / size; infinite where counts follow a Poisson
    /// distribution.
    pub size: f64,
    /// Log likelihood of the fitted model, in nats.
    pub log_likelihood: f64,
}

/// A linear combination of fixed effects, with Wald's z test against zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaldContrast {
    pub estimate: f64,
    pub standard_error: f64,
    /// z statistic: the estimate divided by its standard error.
    pub z: f64,
    pub p: f64,
}

impl NegativeBinomialModel {
    /// Fits the negative binomial model by maximum likelihood; `None` if the fixed effects are collinear, or the search
    /// does not converge.
    pub fn fit(trials: &[CountObservation]) -> Option<NegativeBinomialModel> {
        let effects = trials.first()?.effects.len();
        let rows: Vec<f64> = trials.iter().flat_map(|one| one.effects.iter().copied()).collect();
        let x = DMatrix::from_row_slice(trials.len(), effects, &rows);
        let is_determined = (x.transpose() * &x).symmetric_eigenvalues().min() > 1e-9 * trials.len() as f64;
        let total: u64 = trials.iter().map(|one| one.count).sum();
        if trials.len() <= effects || !is_determined || total == 0 {
            return None;
        }
        // Least squares estimates on the logarithms are close enough as starting values.
        let logs = trials.iter().map(|one| ((one.count as f64 + 0.5) / one.exposure).ln());
        let logs = DVector::from_iterator(trials.len(), logs);
        let start = (x.transpose() * &x).cholesky()?.solve(&(x.transpose() * logs));
        let mut at: Vec<f64> = start.iter().copied().chain([-1.0, 2.0]).collect();
        let groups = by_participant(trials);
        let likelihood = |at: &[f64]| log_likelihood(&groups, effects, at);
        let free = climb(&likelihood, &mut at)?;
        let (_, hessian) = derivatives(&likelihood, &at, &free);
        // Variables that lie at a bound are treated as known.
        let covariance = (-hessian).cholesky()?.inverse().view((0, 0), (effects, effects)).into_owned();
        let [log_sd, log_size] = [at[effects], at[effects + 1]];
        Some(NegativeBinomialModel {
            estimates: at[..effects].to_vec(),
            covariance,
            between_sd: if log_sd <= LOG_SD[0] { 0.0 } else { log_sd.exp() },
            size: if log_size >= LOG_SIZE[1] { f64::INFINITY } else { log_size.exp() },
            log_likelihood: likelihood(&at),
        })
    }

    /// Contrast: the linear combination of the fixed effects with these weights.
    pub fn contrast(&self, weights: &[f64]) -> Option<WaldContrast> {
        let weights = DVector::from_column_slice(weights);
        let estimate = weights.iter().zip(&self.estimates).map(|(weight, effect)| weight * effect).sum::<f64>();
        let standard_error = weights.dot(&(&self.covariance * &weights)).sqrt();
        let z = estimate / standard_error;
        let p = 2.0 * Normal::new(0.0, 1.0).ok()?.sf(z.abs());
        (standard_error > 0.0).then_some(WaldContrast { estimate, standard_error, z, p })
    }
}

/// The trials of each participant, in the order of participants; trials of one participant keep their order.
fn by_participant(trials: &[CountObservation]) -> Vec<Vec<&CountObservation>> {
    let participants = trials.iter().map(|one| one.participant + 1).max().unwrap_or(0);
    let mut groups = vec![Vec::new(); participants];
    trials.iter().for_each(|one| groups[one.participant].push(one));
    groups.retain(|own| !own.is_empty());
    groups
}

/// The log likelihood of fixed effects, log standard deviation and log size, for the trials of each participant; the
/// participants' random effects are integrated out by Laplace's method.
fn log_likelihood(groups: &[Vec<&CountObservation>], effects: usize, at: &[f64]) -> f64 {
    let (beta, sd, size) = (&at[..effects], at[effects].exp(), at[effects + 1].exp());
    let linear = |one: &CountObservation| {
        one.exposure.ln() + one.effects.iter().zip(beta).map(|(effect, beta)| effect * beta).sum::<f64>()
    };
    let of_participant = |own: &Vec<&CountObservation>| {
        let own: Vec<(f64, f64)> = own.iter().map(|one| (one.count as f64, linear(one))).collect();
        // h(u) = sum log f(y | linear + sd u) - u^2 / 2 is concave; u is standard normal.
        let slopes = |u: f64| {
            own.iter().fold((-u, -1.0), |(first, second), &(y, linear)| {
                let mu = (linear + sd * u).exp();
                let share = mu / (size + mu);
                (first + sd * (y - (y + size) * share), second - sd * sd * (y + size) * share * (1.0 - share))
            })
        };
        let mut u = 0.0_f64;
        for _ in 0..50 {
            let (first, second) = slopes(u);
            let step = (first / second).clamp(-2.0, 2.0);
            u -= step;
            if step.abs() < 1e-12 {
                break;
            }
        }
        let (_, second) = slopes(u);
        let value: f64 = own.iter().map(|&(y, linear)| log_pmf(y, linear + sd * u, size)).sum();
        value - u * u / 2.0 - (-second).ln() / 2.0
    };
    groups.iter().map(of_participant).sum()
}

fn log_pmf(y: f64, log_mu: f64, size: f64) -> f64 {
    let mu = log_mu.exp();
    let log_share = log_mu - (size + mu).ln();
    ln_gamma(y + size) - ln_gamma(size) - ln_gamma(y + 1.0) - size * (mu / size).ln_1p() + y * log_share
}

/// Climbs to the maximum within bounds; returns the indices of the variables that do not lie at a bound, or `None`
/// without convergence.
fn climb(value: &impl Fn(&[f64]) -> f64, at: &mut [f64]) -> Option<Vec<usize>> {
    let effects = at.len() - 2;
    let bounds = [LOG_SD, LOG_SIZE];
    let mut now = value(at);
    for _ in 0..MOST_STEPS {
        let (gradient, hessian) = derivatives(value, at, &(0..at.len()).collect::<Vec<_>>());
        // A variable at a bound is held there while the slope points beyond the bound.
        let is_held = |index: usize| {
            let Some([low, high]) = index.checked_sub(effects).map(|index| bounds[index]) else { return false };
            (at[index] <= low && gradient[index] <= 0.0) || (at[index] >= high && gradient[index] >= 0.0)
        };
        let free: Vec<usize> = (0..at.len()).filter(|&index| !is_held(index)).collect();
        let slope = DVector::from_iterator(free.len(), free.iter().map(|&index| gradient[index]));
        let curvature = DMatrix::from_fn(free.len(), free.len(), |row, column| -hessian[(free[row], free[column])]);
        let step = ascent_step(curvature, &slope)?;
        let (gain, next) = longest_gain(value, at, &free, &step, now, effects, bounds);
        let is_over = gain < GAIN;
        if gain > 0.0 {
            at.copy_from_slice(&next);
            now += gain;
        }
        if is_over {
            return Some(free);
        }
    }
    None
}

/// The step of Newton's method; where the function is not concave, the diagonal of its second derivatives is raised
/// until the step ascends.
fn ascent_step(curvature: DMatrix<f64>, slope: &DVector<f64>) -> Option<DVector<f64>> {
    let size = curvature.nrows();
    let mut raise = 0.0;
    for _ in 0..40 {
        let raised = &curvature + DMatrix::identity(size, size) * raise;
        if let Some(factor) = raised.cholesky() {
            return Some(factor.solve(slope));
        }
        raise = (raise * 4.0_f64).max(1e-3);
    }
    None
}

/// Halves the step until the step increases the function; returns the gain and the end point.
fn longest_gain(
    value: &impl Fn(&[f64]) -> f64,
    at: &[f64],
    free: &[usize],
    step: &DVector<f64>,
    now: f64,
    effects: usize,
    bounds: [[f64; 2]; 2],
) -> (f64, Vec<f64>) {
    let mut length = 1.0;
    for _ in 0..40 {
        let mut next = at.to_vec();
        for (place, &index) in free.iter().enumerate() {
            next[index] += length * step[place].clamp(-3.0, 3.0);
            if let Some([low, high]) = index.checked_sub(effects).map(|index| bounds[index]) {
                next[index] = next[index].clamp(low, high);
            }
        }
        let gain = value(&next) - now;
        if gain > 0.0 {
            return (gain, next);
        }
        length /= 2.0;
    }
    (0.0, at.to_vec())
}

/// Gradient and Hessian of the function in the free variables, by central differences.
fn derivatives(value: &impl Fn(&[f64]) -> f64, at: &[f64], free: &[usize]) -> (DVector<f64>, DMatrix<f64>) {
    let moved = |moves: &[(usize, f64)]| {
        let mut next = at.to_vec();
        moves.iter().for_each(|&(index, by)| next[index] += by);
        value(&next)
    };
    let (count, middle) = (free.len(), value(at));
    let (mut gradient, mut hessian) = (DVector::zeros(count), DMatrix::zeros(count, count));
    for (row, &i) in free.iter().enumerate() {
        let (up, down) = (moved(&[(i, STEP)]), moved(&[(i, -STEP)]));
        gradient[row] = (up - down) / (2.0 * STEP);
        hessian[(row, row)] = (up - 2.0 * middle + down) / (STEP * STEP);
        for (column, &j) in free.iter().enumerate().take(row) {
            let [a, b, c, d] = [(STEP, STEP), (STEP, -STEP), (-STEP, STEP), (-STEP, -STEP)]
                .map(|(of_i, of_j)| moved(&[(i, of_i), (j, of_j)]));
            let mixed = (a - b - c + d) / (4.0 * STEP * STEP);
            (hessian[(row, column)], hessian[(column, row)]) = (mixed, mixed);
        }
    }
    (gradient, hessian)
}
