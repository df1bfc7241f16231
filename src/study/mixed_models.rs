//! Mixed models of the trials of participants: a linear one of log rates, and a negative binomial one of counts.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};
use statrs::function::gamma::ln_gamma;

/// Range of the logarithm of the variance ratio in which the minimum is searched; below it, participants do not differ.
const LOG_RATIO: [f64; 2] = [-14.0, 14.0];
/// Number of grid points at which the REML criterion is evaluated before the search.
const GRID: usize = 57;
/// Precision of the logarithm of the variance ratio at which the search ends.
const PRECISION: f64 = 1e-11;

#[derive(Clone, Debug, PartialEq)]
pub struct MixedModelMeasurement {
    pub participant: usize,
    pub effects: Vec<f64>,
    pub value: f64,
}

/// A linear mixed model with one random intercept per participant, by restricted maximum likelihood (REML), with
/// Satterthwaite's degrees of freedom: y = X beta + Z b + e, b ~ N(0, v_b), e ~ N(0, v).
///
/// The criterion is profiled over the ratio of the variances (Bates et al. 2015, Journal of Statistical Software 67,
/// section 3), so that the search is one-dimensional. Degrees of freedom follow from the observed information of the
/// two variances (Kuznetsova, Brockhoff and Christensen 2017, Journal of Statistical Software 82, section 2); where the
/// participants' variance is estimated as zero, they are those of the residuals. `tests/outside/arms.py` compares all
/// results with statsmodels and, where they are installed, with lme4 and lmerTest.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMixedModel {
    pub estimates: DVector<f64>,
    pub covariance: DMatrix<f64>,
    pub between: f64,
    pub within: f64,
    /// The product V^-1 X, with one row per measurement.
    weighted: DMatrix<f64>,
    participants: Vec<usize>,
    /// Covariance of the estimates of the two variances; `None` where the variance between participants is zero.
    variances: Option<[[f64; 2]; 2]>,
}

/// A linear combination of fixed effects, with its t test against zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MixedModelContrast {
    pub estimate: f64,
    pub standard_error: f64,
    /// Satterthwaite's degrees of freedom of the t test.
    pub df: f64,
    pub t: f64,
    pub p: f64,
}

impl MixedModelContrast {
    /// Confidence interval of the estimate; the confidence level `level` is between 0 and 1.
    pub fn interval(&self, level: f64) -> [f64; 2] {
        let quantile = StudentsT::new(0.0, 1.0, self.df).map_or(f64::NAN, |t| t.inverse_cdf(0.5 + level / 2.0));
        let half = quantile * self.standard_error;
        [self.estimate - half, self.estimate + half]
    }

    pub(crate) fn p_below(&self, bound: f64) -> f64 {
        let t = (self.estimate - bound) / self.standard_error;
        StudentsT::new(0.0, 1.0, self.df).map_or(f64::NAN, |distribution| distribution.cdf(t))
    }
}

/// Sums over the measurements, from which the REML criterion follows for every ratio of variances.
struct Sums {
    n: f64,
    xx: DMatrix<f64>,
    xy: DVector<f64>,
    yy: f64,
    /// For each participant: number of measurements, and sums of effects and of values.
    groups: Vec<(f64, DVector<f64>, f64)>,
}

struct Solution {
    estimates: DVector<f64>,
    /// Unscaled covariance of the fixed effects: (X' W^-1 X)^-1, with W = V / v.
    inverse: DMatrix<f64>,
    within: f64,
    deviance: f64,
}

impl Sums {
    fn new(measurements: &[MixedModelMeasurement]) -> Sums {
        let effects = measurements.first().map_or(0, |one| one.effects.len());
        let count = measurements.iter().map(|one| one.participant + 1).max().unwrap_or(0);
        let mut sums = Sums {
            n: measurements.len() as f64,
            xx: DMatrix::zeros(effects, effects),
            xy: DVector::zeros(effects),
            yy: 0.0,
            groups: vec![(0.0, DVector::zeros(effects), 0.0); count],
        };
        for one in measurements {
            let x = DVector::from_column_slice(&one.effects);
            sums.xx += &x * x.transpose();
            sums.xy += &x * one.value;
            sums.yy += one.value * one.value;
            let group = &mut sums.groups[one.participant];
            group.0 += 1.0;
            group.1 += &x;
            group.2 += one.value;
        }
        sums
    }

    /// Solves for one ratio gamma of variances: W^-1 subtracts, from each participant's block, gamma / (1 + n gamma)
    /// times the block's sums.
    fn solve(&self, ratio: f64) -> Option<Solution> {
        let (mut xx, mut xy, mut yy, mut log_det) = (self.xx.clone(), self.xy.clone(), self.yy, 0.0);
        for (n, x, y) in &self.groups {
            let shrink = ratio / (1.0 + n * ratio);
            xx -= x * x.transpose() * shrink;
            xy -= x * (shrink * y);
            yy -= shrink * y * y;
            log_det += (n * ratio).ln_1p();
        }
        let factor = xx.cholesky()?;
        let estimates = factor.solve(&xy);
        let df = self.n - xy.len() as f64;
        let within = (yy - estimates.dot(&xy)) / df;
        // Without residual variance the criterion is undefined, since the fixed effects explain the values completely.
        let is_noise = within > 1e-12 * (self.yy / self.n).max(f64::MIN_POSITIVE);
        let deviance = df * within.ln() + log_det + 2.0 * factor.l().diagonal().map(f64::ln).sum();
        is_noise.then(|| Solution { estimates, inverse: factor.inverse(), within, deviance })
    }

    /// The ratio of variances that minimises the REML criterion; zero at the lower end of the range.
    fn best_ratio(&self) -> Option<f64> {
        let at = |log_ratio: f64| self.solve(log_ratio.exp()).map_or(f64::INFINITY, |found| found.deviance);
        let step = (LOG_RATIO[1] - LOG_RATIO[0]) / (GRID - 1) as f64;
        let places: Vec<f64> = (0..GRID).map(|index| LOG_RATIO[0] + step * index as f64).collect();
        let best = places.iter().copied().min_by(|a, b| at(*a).total_cmp(&at(*b)))?;
        let found = golden_section(at, best - step, best + step);
        let border = self.solve(0.0)?.deviance;
        Some(if border <= at(found) { 0.0 } else { found.exp() })
    }
}

/// Minimum between `low` and `high` of a function with a single minimum, by golden-section search.
fn golden_section(value: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let share = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut a, mut b) = (high - share * (high - low), low + share * (high - low));
    let (mut at_a, mut at_b) = (value(a), value(b));
    while high - low > PRECISION {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - share * (high - low);
            at_a = value(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + share * (high - low);
            at_b = value(b);
        }
    }
    (low + high) / 2.0
}

impl LinearMixedModel {
    /// `None` if the fixed effects are collinear, or no degrees of freedom are left for the variances.
    pub fn fit(measurements: &[MixedModelMeasurement]) -> Option<LinearMixedModel> {
        let effects = measurements.first()?.effects.len();
        let sums = Sums::new(measurements);
        let has_freedom = measurements.len() > effects;
        let is_determined = sums.xx.clone().symmetric_eigenvalues().min() > 1e-9 * sums.n;
        if !has_freedom || !is_determined {
            return None;
        }
        let ratio = sums.best_ratio()?;
        let Solution { estimates, inverse, within, .. } = sums.solve(ratio)?;
        let covariance = inverse * within;
        let participants: Vec<usize> = measurements.iter().map(|one| one.participant).collect();
        let rows: Vec<f64> = measurements.iter().flat_map(|one| one.effects.iter().copied()).collect();
        let x = DMatrix::from_row_slice(measurements.len(), effects, &rows);
        let weighted = weigh(&x, &participants, &sums, ratio) / within;
        let variances = match ratio > 0.0 {
            true => {
                let (participants, weighted, covariance) = (&participants[..], &weighted, &covariance);
                let p = ResidualProjection { sums: &sums, participants, ratio, within, weighted, covariance };
                let y = DVector::from_iterator(measurements.len(), measurements.iter().map(|one| one.value));
                Some(covariance_of_variances(&p, &y)?)
            }
            false => None,
        };
        let between = ratio * within;
        Some(LinearMixedModel { estimates, covariance, between, within, weighted, participants, variances })
    }

    pub fn contrast(&self, weights: &[f64]) -> Option<MixedModelContrast> {
        let weights = DVector::from_column_slice(weights);
        let estimate = weights.dot(&self.estimates);
        let variance = weights.dot(&(&self.covariance * &weights));
        let standard_error = variance.sqrt();
        let df = self.degrees_of_freedom(&weights, variance);
        let t = estimate / standard_error;
        let p = 2.0 * StudentsT::new(0.0, 1.0, df).ok()?.sf(t.abs());
        Some(MixedModelContrast { estimate, standard_error, df, t, p })
    }

    /// Satterthwaite's degrees of freedom 2 v^2 / Var(v), with the variance of v by the delta method.
    fn degrees_of_freedom(&self, weights: &DVector<f64>, variance: f64) -> f64 {
        let Some(variances) = self.variances else {
            return (self.participants.len() - weights.len()) as f64;
        };
        // dC/dv_k = C X' V^-1 G_k V^-1 X C; G is ZZ' for the participants, and the identity for the residuals.
        let u = &self.weighted * (&self.covariance * weights);
        let slope = [sums_by_participant(&column(&u), &self.participants).norm_squared(), u.norm_squared()];
        let of_variance: f64 = (0..2).flat_map(|k| (0..2).map(move |l| slope[k] * slope[l] * variances[k][l])).sum();
        2.0 * variance * variance / of_variance
    }
}

/// W^-1 times a matrix, where W is the covariance of the measurements divided by the residual variance.
fn weigh(matrix: &DMatrix<f64>, participants: &[usize], sums: &Sums, ratio: f64) -> DMatrix<f64> {
    let totals = sums_by_participant(matrix, participants);
    let mut weighed = matrix.clone();
    for (row, &participant) in participants.iter().enumerate() {
        let shrink = ratio / (1.0 + sums.groups[participant].0 * ratio);
        let rest = matrix.row(row) - totals.row(participant) * shrink;
        weighed.set_row(row, &rest);
    }
    weighed
}

/// A row for each participant: the sum of the rows of its measurements.
fn sums_by_participant(rows: &DMatrix<f64>, participants: &[usize]) -> DMatrix<f64> {
    let count = participants.iter().map(|participant| participant + 1).max().unwrap_or(0);
    let mut sums = DMatrix::<f64>::zeros(count, rows.ncols());
    for (row, &participant) in participants.iter().enumerate() {
        let sum = sums.row(participant) + rows.row(row);
        sums.set_row(participant, &sum);
    }
    sums
}

fn column(values: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_column_slice(values.len(), 1, values.as_slice())
}

/// The matrix P = V^-1 - V^-1 X C X' V^-1, with C the covariance of the fixed effects. P has a row and a column for
/// each measurement, so it is not stored: V^-1 is the same within a participant's block, and the rest has low rank.
struct ResidualProjection<'a> {
    sums: &'a Sums,
    participants: &'a [usize],
    ratio: f64,
    within: f64,
    weighted: &'a DMatrix<f64>,
    covariance: &'a DMatrix<f64>,
}

impl ResidualProjection<'_> {
    fn times(&self, y: &DVector<f64>) -> DVector<f64> {
        let weighed = weigh(&column(y), self.participants, self.sums, self.ratio) / self.within;
        weighed.column(0) - self.weighted * (self.covariance * (self.weighted.transpose() * y))
    }

    fn traces(&self) -> [f64; 3] {
        let v = self.within;
        let by_participant = sums_by_participant(self.weighted, self.participants);
        // X' V^-1 V^-1 X, and the same of the participants' sums.
        let all = self.weighted.transpose() * self.weighted;
        let grouped = by_participant.transpose() * &by_participant;
        let (c_all, c_grouped) = (self.covariance * &all, self.covariance * &grouped);
        let mut traces = [(&c_grouped * &c_grouped).trace(), (&c_grouped * &c_all).trace(), (&c_all * &c_all).trace()];
        traces[2] -= 2.0 * c_all.trace() / v;
        for ((n, ..), sum) in self.sums.groups.iter().zip(by_participant.row_iter()) {
            let shrink = self.ratio / (1.0 + n * self.ratio);
            // The sum of each row of the participant's block of V^-1.
            let weight = (1.0 - n * shrink) / v;
            let explained = (sum * self.covariance * sum.transpose())[(0, 0)];
            traces[0] += n * weight * (n * weight - 2.0 * explained);
            traces[1] += weight * (n * weight - 2.0 * explained);
            traces[2] += (n - 1.0) / (v * v) + weight * weight + 2.0 * shrink * explained / v;
        }
        traces
    }
}

/// The inverse of the observed information of (v_b, v): I_kl = y'P G_k P G_l P y - tr(P G_k P G_l) / 2, with G = ZZ' for
/// the participants, and the identity for the residuals.
fn covariance_of_variances(p: &ResidualProjection, y: &DVector<f64>) -> Option<[[f64; 2]; 2]> {
    let r = p.times(y);
    let sums = sums_by_participant(&column(&r), p.participants);
    // G_k P y: each participant's sum at each of its measurements, and P y itself.
    let of_sums = DVector::from_iterator(r.len(), p.participants.iter().map(|&participant| sums[participant]));
    let [both, one, neither] = p.traces();
    let (p_sums, p_r) = (p.times(&of_sums), p.times(&r));
    let [a, b, d] = [of_sums.dot(&p_sums) - both / 2.0, of_sums.dot(&p_r) - one / 2.0, r.dot(&p_r) - neither / 2.0];
    let determinant = a * d - b * b;
    (determinant > 0.0 && a > 0.0).then(|| [[d / determinant, -b / determinant], [-b / determinant, a / determinant]])
}

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

/// A mixed negative binomial model of counts: y ~ NB(mu, size), log mu = log exposure + X beta + b, b ~ N(0, v_b) per
/// participant; variance mu + mu^2 / size. Errors come in runs, so that the variance of counts exceeds their mean.
///
/// Maximum likelihood with Laplace's approximation of the integral over b (Brooks et al. 2017, The R Journal 9, section
/// 2), by Newton's method with numeric derivatives. Tests are Wald's z tests. `tests/outside/arms.py` compares the
/// model with glmmTMB where that is installed, and the likelihood with numeric integration.
#[derive(Clone, Debug, PartialEq)]
pub struct NegativeBinomialModel {
    pub estimates: Vec<f64>,
    pub covariance: DMatrix<f64>,
    /// Standard deviation between participants, on the log scale; 0 where participants do not differ.
    pub between_sd: f64,
    /// The variance of a count is mu + mu^2 / size; infinite where counts follow a Poisson distribution.
    pub size: f64,
    pub log_likelihood: f64,
}

/// A linear combination of fixed effects, with Wald's z test against zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct WaldContrast {
    pub estimate: f64,
    pub standard_error: f64,
    pub z: f64,
    pub p: f64,
}

impl NegativeBinomialModel {
    /// `trials`: ordered by participant. `None` if the fixed effects are collinear, or the search does not converge.
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
        let likelihood = |at: &[f64]| log_likelihood(trials, effects, at);
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

    pub fn contrast(&self, weights: &[f64]) -> Option<WaldContrast> {
        let weights = DVector::from_column_slice(weights);
        let estimate = weights.iter().zip(&self.estimates).map(|(weight, effect)| weight * effect).sum::<f64>();
        let standard_error = weights.dot(&(&self.covariance * &weights)).sqrt();
        let z = estimate / standard_error;
        let p = 2.0 * Normal::standard().sf(z.abs());
        (standard_error > 0.0).then_some(WaldContrast { estimate, standard_error, z, p })
    }
}

/// The log likelihood of fixed effects, log standard deviation and log size; the participants' random effects are integrated
/// out by Laplace's method.
fn log_likelihood(trials: &[CountObservation], effects: usize, at: &[f64]) -> f64 {
    let (beta, sd, size) = (&at[..effects], at[effects].exp(), at[effects + 1].exp());
    let linear = |one: &CountObservation| {
        one.exposure.ln() + one.effects.iter().zip(beta).map(|(effect, beta)| effect * beta).sum::<f64>()
    };
    let of_participant = |own: &[CountObservation]| {
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
    trials.chunk_by(|a, b| a.participant == b.participant).map(of_participant).sum()
}

fn log_pmf(y: f64, log_mu: f64, size: f64) -> f64 {
    let mu = log_mu.exp();
    let log_share = log_mu - (size + mu).ln();
    ln_gamma(y + size) - ln_gamma(size) - ln_gamma(y + 1.0) - size * (mu / size).ln_1p() + y * log_share
}

/// The indices of the variables that do not lie at a bound; `None` without convergence.
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
