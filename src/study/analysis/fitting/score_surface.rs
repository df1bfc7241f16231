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

/// Distance from the centre along each variable up to which a point counts for a surface, in steps; with what rounding
/// adds to the outermost points of the design.
const WIDTH: f64 = 1.0 + 1e-6;

/// A point at which a log likelihood was evaluated, and the negative log likelihood of each press there, in nats.
pub type TriedPoint<'a> = (Vec<f64>, &'a [f64]);

pub fn points(variables: usize) -> usize {
    design(variables).len()
}

/// The points of the design for a surface around `centre`, with steps of the given sizes along each variable.
pub(crate) fn points_around(centre: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
    let at = |by: Vec<f64>| by.iter().zip(centre).zip(steps).map(|((by, centre), step)| centre + by * step).collect();
    design(centre.len()).into_iter().map(at).collect()
}

/// Linear regressions of the losses of all presses over the points around a centre, whose slopes are the scores;
/// variables are in steps.
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

    /// Covariance of the slope of the log likelihood: the sum over presses of the outer products of their scores, with the
    /// noise of single presses, which moves the slope as well.
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

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::response_surface::REACH;
    use super::*;
    use tomcom_core::base::rng::{Stream, stream};

    /// A number from a distribution with mean 0 and variance 1: the sum of twelve uniform numbers (Irwin and Hall).
    fn normal(random: &mut Stream) -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    }

    /// Losses of 400 measurements of x + y / 2 and 100 of y, with standard deviation 1, where x = 1 and y = -2.
    fn measurements(random: &mut Stream) -> impl Fn(&[f64]) -> Vec<f64> + use<> {
        let data: Vec<f64> = (0..500).map(|index| if index < 400 { 0.0 } else { -2.0 } + normal(random)).collect();
        move |at| {
            let mean = |index: usize| if index < 400 { at[0] + at[1] / 2.0 } else { at[1] };
            data.iter().enumerate().map(|(index, measured)| (measured - mean(index)).powi(2) / 2.0).collect()
        }
    }

    /// The surface of losses at the points of the design.
    fn designed(
        mut losses: impl FnMut(&[f64]) -> Option<Vec<f64>>,
        centre: &[f64],
        steps: &[f64],
    ) -> Option<QuadraticSurface> {
        let points = points_around(centre, steps);
        let tried: Vec<(Vec<f64>, Vec<f64>)> =
            points.into_iter().filter_map(|at| losses(&at).map(|losses| (at, losses))).collect();
        let tried: Vec<TriedPoint<'_>> = tried.iter().map(|(at, losses)| (at.clone(), &losses[..])).collect();
        ScoreRegression::new(&tried, centre, steps).map(|regression| regression.surface())
    }

    #[test]
    fn scores_of_measurements_give_their_information() {
        let losses = measurements(&mut stream(9943, "measurements", 0));
        let (centre, steps) = ([0.9, -1.8], [0.1, 0.2]);
        let found = designed(|at| Some(losses(at)), &centre, &steps).expect("a surface");
        let least = found.least(&[-REACH; 2], &[REACH; 2]);
        for (index, (at, error)) in [(1.0, 0.0707), (-2.0, 0.1)].into_iter().enumerate() {
            let found = centre[index] + least[index] * steps[index];
            assert!((found - at).abs() < 3.0 * error, "{found} instead of {at}");
        }
        // Information: 400 in x, 100 + 400 / 4 in y, 400 / 2 across; outer products scatter around that.
        for ((row, column), information) in [((0, 0), 400.0), ((1, 1), 200.0), ((1, 0), 200.0)] {
            let found = found.curvature[(row, column)] / (steps[row] * steps[column]);
            assert!((found / information - 1.0).abs() < 0.3, "{found} instead of {information}");
        }
        assert_eq!(points(5), 11);
    }

    #[test]
    fn noise_of_single_presses_does_not_count_as_information() {
        let mut random = stream(9943, "noise", 0);
        let mut sums = [0.0; 2];
        for _ in 0..100 {
            let losses = measurements(&mut random);
            let noisy = |random: &mut Stream, at: &[f64]| -> Vec<f64> {
                losses(at).into_iter().map(|loss| loss + 0.1 * normal(random)).collect()
            };
            let flat = designed(|_| Some((0..500).map(|_| normal(&mut random)).collect()), &[0.0; 5], &[1.0; 5]);
            sums[0] += flat.expect("a surface").curvature[(0, 0)] / 100.0;
            let told = designed(|at| Some(noisy(&mut random, at)), &[1.0, -2.0], &[0.1, 0.2]).expect("a surface");
            sums[1] += told.curvature[(0, 0)] / 100.0;
        }
        // Without a correction, the first would be 500 / 2, and the second 4 + 500 / 100 / 2.
        assert!(sums[0].abs() < 10.0 && (sums[1] - 4.0).abs() < 0.2, "{sums:?}");
    }

    #[test]
    fn a_valley_is_not_convex_and_ends_at_a_bound() {
        let valley = designed(|at| Some(vec![at[0], -at[0]]), &[0.0, 0.0], &[1.0, 1.0]).expect("a surface");
        assert!(!valley.is_convex(), "{valley:?}");
        let slope = designed(|at| Some(vec![at[0], -at[0], -0.1 * at[1]]), &[0.0, 0.0], &[1.0, 1.0]);
        let least = slope.expect("a surface").least(&[-1.0, -1.0], &[1.0, 1.0]);
        assert!(least[0].abs() < 1e-9 && least[1] == 1.0, "{least:?}");
    }

    #[test]
    fn points_without_a_likelihood_are_left_out() {
        let losses = measurements(&mut stream(9943, "measurements", 0));
        let some = |at: &[f64]| (at[0] < 0.95).then(|| losses(at));
        assert!(designed(some, &[0.9, -1.8], &[0.1, 0.2]).is_some());
        let (near, far) = (losses(&[0.9, -1.8]), losses(&[9.0, 9.0]));
        let outside = [(vec![0.9, -1.8], &near[..]), (vec![9.0, 9.0], &far[..])];
        assert!(ScoreRegression::new(&outside, &[0.9, -1.8], &[0.1, 0.2]).is_none());
        assert_eq!(designed(|_| None, &[0.9, -1.8], &[0.1, 0.2]), None);
        assert_eq!(designed(|at| Some(vec![f64::INFINITY, at[0]]), &[0.9, -1.8], &[0.1, 0.2]), None);
    }
}
