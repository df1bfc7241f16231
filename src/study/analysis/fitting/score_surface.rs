//! Quadratic surfaces of a log likelihood from the scores (first derivatives) of its presses: the curvature is the sum
//! of the scores' outer products (Berndt, Hall, Hall and Hausman 1974, "BHHH"), so that a surface takes two points on
//! each axis, and none between the axes.
//!
//! The scores are slopes of a linear regression of each press's log likelihood over the points. The likelihood of a
//! press is that given all earlier presses, hence the scores at the true parameters are uncorrelated with mean 0, and the
//! sum of their outer products estimates the covariance of the log likelihood's slope, which is the information if the
//! model is right. Noise of the likelihood makes products of a score with itself too large. The regression's residuals
//! tell of noise that differs from point to point, but not of noise that neighbouring points share. Surfaces from scores
//! therefore lead the search, and do not give standard errors by themselves.

use nalgebra::{DMatrix, DVector};

use super::response_surface::{QuadraticSurface, inverse};

/// Distance from the centre up to which a point counts, in steps, with what rounding adds to the outermost.
const WIDTH: f64 = 1.0 + 1e-6;

/// A point at which a log likelihood was evaluated, and the negative log likelihood of each press there, in nats.
pub type TriedPoint<'a> = (Vec<f64>, &'a [f64]);

pub fn points(variables: usize) -> usize {
    design(variables).len()
}

/// The points of the design for a surface around `centre`, with steps of the given sizes along each variable.
pub fn points_around(centre: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
    let at = |by: Vec<f64>| by.iter().zip(centre).zip(steps).map(|((by, centre), step)| centre + by * step).collect();
    design(centre.len()).into_iter().map(at).collect()
}

/// Regressions of the losses of all presses over the points around a centre; their slopes are the scores.
pub struct ScoreRegression {
    /// A row for each point: 1, and the distance from the centre along each variable.
    design: DMatrix<f64>,
    /// Losses: a row for each point, a column for each press.
    losses: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// Regression coefficients: a column for each press, with the value at the centre above the scores.
    lines: DMatrix<f64>,
}

impl ScoreRegression {
    /// The regressions over the points that lie within a step of the centre along each variable: those of the design, and
    /// those of earlier surfaces, which make the noise less. All points have the same presses in the same order. Points
    /// whose sum is not finite are ignored; `None` if too few remain.
    pub fn new(tried: &[TriedPoint<'_>], centre: &[f64], steps: &[f64]) -> Option<ScoreRegression> {
        let (mut rows, mut losses) = (Vec::new(), Vec::new());
        for (at, of_presses) in tried {
            let by = || at.iter().zip(centre).zip(steps).map(|((at, centre), step)| (at - centre) / step);
            if by().all(|by| by.abs() <= WIDTH) && of_presses.iter().sum::<f64>().is_finite() {
                rows.extend(std::iter::once(1.0).chain(by()));
                losses.push(*of_presses);
            }
        }
        let presses = losses.first()?.len();
        let design = DMatrix::from_row_iterator(losses.len(), 1 + centre.len(), rows);
        let losses = DMatrix::from_row_iterator(losses.len(), presses, losses.into_iter().flatten().copied());
        let inverse = inverse(design.tr_mul(&design))?;
        let lines = &inverse * design.tr_mul(&losses);
        Some(ScoreRegression { design, losses, inverse, lines })
    }

    fn freedom(&self) -> f64 {
        self.design.nrows().saturating_sub(self.design.ncols()).max(1) as f64
    }

    /// Covariance of the log likelihood's slope: the sum of the outer products of the scores, with their noise.
    pub(crate) fn score_products(&self) -> DMatrix<f64> {
        let scores = self.lines.rows(1, self.lines.nrows() - 1);
        scores * scores.transpose()
    }

    fn of_slopes(&self) -> DMatrix<f64> {
        let variables = self.design.ncols() - 1;
        self.inverse.view((1, 1), (variables, variables)).into_owned()
    }

    /// The quadratic surface with the scores' outer products as curvature, less the noise of single presses.
    pub fn surface(&self) -> QuadraticSurface {
        let press_noise = (&self.losses - &self.design * &self.lines).norm_squared() / self.freedom();
        let curvature = self.score_products() - self.of_slopes() * press_noise;
        let bend = |row: usize| {
            let by = self.design.row(row).columns(1, curvature.nrows()).transpose();
            by.dot(&(&curvature * &by)) / 2.0
        };
        let unbent = DVector::from_fn(self.losses.nrows(), |row, _| self.losses.row(row).sum() - bend(row));
        let found = &self.inverse * self.design.tr_mul(&unbent);
        QuadraticSurface {
            value: found[0],
            slope: found.rows(1, curvature.nrows()).into_owned(),
            noise: press_noise.sqrt(),
            curvature,
        }
    }
}

/// Points of the design for `n` variables, in steps from the centre: the centre, and two points on each axis.
fn design(n: usize) -> Vec<Vec<f64>> {
    let at = |index: usize, step: f64| (0..n).map(|other| if other == index { step } else { 0.0 }).collect();
    let on_axes = (0..n).flat_map(|index| [-1.0, 1.0].map(|step| at(index, step)));
    std::iter::once(vec![0.0; n]).chain(on_axes).collect()
}
