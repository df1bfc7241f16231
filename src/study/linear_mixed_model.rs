//! A linear mixed model with one random intercept per participant, by restricted maximum likelihood (REML), with
//! Satterthwaite's degrees of freedom: y = X beta + Z b + e, b ~ N(0, v_b), e ~ N(0, v).
//!
//! The criterion is profiled over the ratio of the variances (Bates et al. 2015, Journal of Statistical Software 67,
//! section 3), so that the search is one-dimensional. Degrees of freedom follow from the observed information of the
//! two variances (Kuznetsova, Brockhoff and Christensen 2017, Journal of Statistical Software 82, section 2); where the
//! participants' variance is estimated as zero, they are those of the residuals. `tests/outside/arms.py` compares all
//! results with statsmodels and, where they are installed, with lme4 and lmerTest.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Range of the logarithm of the variance ratio in which the minimum is searched; below it, participants do not differ.
const LOG_RATIO: [f64; 2] = [-14.0, 14.0];
/// Number of grid points at which the REML criterion is evaluated before the search.
const GRID: usize = 57;
/// Precision of the logarithm of the variance ratio at which the search ends.
const PRECISION: f64 = 1e-11;

/// One measurement for the mixed model: participant, fixed effects, and value.
#[derive(Clone, Debug, PartialEq)]
pub struct MixedModelMeasurement {
    pub participant: usize,
    pub effects: Vec<f64>,
    pub value: f64,
}

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
    /// t statistic: the estimate divided by its standard error.
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

/// Solution of the generalised least squares problem for one ratio of variances.
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
    /// Fits the mixed model by REML; `None` if the fixed effects are collinear, or no degrees of freedom are left for
    /// the variances.
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
        let variances = (ratio > 0.0).then(|| {
            let projection = ResidualProjection {
                sums: &sums,
                participants: &participants,
                ratio,
                within,
                weighted: &weighted,
                covariance: &covariance,
            };
            let y = DVector::from_iterator(measurements.len(), measurements.iter().map(|one| one.value));
            covariance_of_variances(&projection, &y)
        });
        let variances = match variances {
            Some(found) => Some(found?),
            None => None,
        };
        Some(LinearMixedModel {
            estimates,
            covariance,
            between: ratio * within,
            within,
            weighted,
            participants,
            variances,
        })
    }

    /// Contrast: the linear combination of the model's fixed effects with these weights.
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
        let slope = [sums_by_participant(&u, &self.participants).norm_squared(), u.norm_squared()];
        let of_variance: f64 = (0..2).flat_map(|k| (0..2).map(move |l| slope[k] * slope[l] * variances[k][l])).sum();
        2.0 * variance * variance / of_variance
    }
}

/// W^-1 times a matrix, where W is the covariance of the measurements divided by the residual variance.
fn weigh(matrix: &DMatrix<f64>, participants: &[usize], sums: &Sums, ratio: f64) -> DMatrix<f64> {
    let mut totals = DMatrix::<f64>::zeros(sums.groups.len(), matrix.ncols());
    for (row, &participant) in participants.iter().enumerate() {
        let sum = totals.row(participant) + matrix.row(row);
        totals.set_row(participant, &sum);
    }
    let mut weighed = matrix.clone();
    for (row, &participant) in participants.iter().enumerate() {
        let shrink = ratio / (1.0 + sums.groups[participant].0 * ratio);
        let rest = matrix.row(row) - totals.row(participant) * shrink;
        weighed.set_row(row, &rest);
    }
    weighed
}

fn sums_by_participant(values: &DVector<f64>, participants: &[usize]) -> DVector<f64> {
    let count = participants.iter().map(|participant| participant + 1).max().unwrap_or(0);
    let mut sums = DVector::zeros(count);
    for (value, &participant) in values.iter().zip(participants) {
        sums[participant] += value;
    }
    sums
}

/// The matrix P = V^-1 - V^-1 X C X' V^-1, with C the covariance of the fixed effects. P has a row and a column for
/// each measurement, so it is not stored: V^-1 is the same within a participant's block, and the rest has low rank.
struct ResidualProjection<'a> {
    sums: &'a Sums,
    participants: &'a [usize],
    ratio: f64,
    within: f64,
    /// The product V^-1 X, with one row per measurement.
    weighted: &'a DMatrix<f64>,
    covariance: &'a DMatrix<f64>,
}

impl ResidualProjection<'_> {
    fn times(&self, y: &DVector<f64>) -> DVector<f64> {
        let column = DMatrix::from_column_slice(y.len(), 1, y.as_slice());
        let weighed = weigh(&column, self.participants, self.sums, self.ratio) / self.within;
        weighed.column(0) - self.weighted * (self.covariance * (self.weighted.transpose() * y))
    }

    fn traces(&self) -> [f64; 3] {
        let (effects, v) = (self.covariance.nrows(), self.within);
        let mut by_participant = DMatrix::<f64>::zeros(self.sums.groups.len(), effects);
        for (row, &participant) in self.participants.iter().enumerate() {
            let sum = by_participant.row(participant) + self.weighted.row(row);
            by_participant.set_row(participant, &sum);
        }
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
    let sums = sums_by_participant(&r, p.participants);
    // G_k P y: each participant's sum at each of its measurements, and P y itself.
    let of_sums = DVector::from_iterator(r.len(), p.participants.iter().map(|&participant| sums[participant]));
    let [both, one, neither] = p.traces();
    let (p_sums, p_r) = (p.times(&of_sums), p.times(&r));
    let [a, b, d] = [of_sums.dot(&p_sums) - both / 2.0, of_sums.dot(&p_r) - one / 2.0, r.dot(&p_r) - neither / 2.0];
    let determinant = a * d - b * b;
    (determinant > 0.0 && a > 0.0).then(|| [[d / determinant, -b / determinant], [-b / determinant, a / determinant]])
}
