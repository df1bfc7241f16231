//! Quadratic surfaces of a log likelihood from the scores (first derivatives) of its presses: the curvature is the sum
//! of the scores' outer products (Berndt, Hall, Hall and Hausman 1974, "BHHH"), so that a surface takes a few points on
//! each axis, and none between the axes.
//!
//! The scores are slopes of a linear regression of each press's log likelihood over the points. The likelihood of a
//! press is that given all earlier presses, hence the scores at the true parameters are uncorrelated with mean 0, and the
//! sum of their outer products estimates the information. Noise of the likelihood makes products of a score with itself
//! too large; the regression's residuals tell by how much.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Distance from the centre up to which a quadratic surface is trusted, in steps.
pub const REACH: f64 = 1.5;
/// Number of sweeps of coordinate descent by which the surface's minimum is found.
const SWEEPS: usize = 60;
/// A matrix counts as singular if its smallest pivot is at most this share of its largest pivot.
const SINGULAR: f64 = 1e-12;
/// Points on each axis, in steps from the centre, and those of a surface of few variables, whose residuals would
/// otherwise be too few to tell the noise.
const ARMS: [f64; 2] = [-1.0, 1.0];
const MANY_ARMS: [f64; 4] = [-1.0, -0.5, 0.5, 1.0];
/// Largest number of variables of a surface that counts as having few.
const FEW: usize = 3;
/// Distance from the centre along each variable up to which a point counts for a surface, in steps; with what rounding
/// adds to the outermost points of the design.
const WIDTH: f64 = 1.0 + 1e-6;

/// A quadratic surface that approximates a noisy negative log likelihood; variables are in steps from its centre.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticSurface {
    /// Value of the surface at its centre, in nats.
    pub value: f64,
    /// First derivatives of the surface at its centre.
    pub slope: DVector<f64>,
    /// Second derivatives of the surface.
    pub curvature: DMatrix<f64>,
    /// Standard deviation of the residuals between function values and surface, in nats.
    pub noise: f64,
    /// Covariance of the surface's first derivatives that follows from the residuals.
    pub slope_covariance: DMatrix<f64>,
}

/// A point at which a log likelihood was evaluated, and the negative log likelihood of each press there, in nats.
pub type TriedPoint<'a> = (Vec<f64>, &'a [f64]);

/// Number of points of the design for this number of variables.
pub fn points(variables: usize) -> usize {
    design(variables).len()
}

/// The points of the design for a surface around `centre`, with steps of the given sizes along each variable.
pub fn points_around(centre: &[f64], steps: &[f64]) -> Vec<Vec<f64>> {
    let at = |by: Vec<f64>| by.iter().zip(centre).zip(steps).map(|((by, centre), step)| centre + by * step).collect();
    design(centre.len()).into_iter().map(at).collect()
}

/// Fits a quadratic surface around `centre` to the points that lie within a step of it along each variable, those of the
/// design and those of earlier surfaces, which makes the noise less. All points have the same presses in the same order.
/// Points whose sum is not finite are ignored; `None` if too few remain.
pub fn surface(tried: &[TriedPoint<'_>], centre: &[f64], steps: &[f64]) -> Option<QuadraticSurface> {
    let n = centre.len();
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for (at, losses) in tried {
        let by = || at.iter().zip(centre).zip(steps).map(|((at, centre), step)| (at - centre) / step);
        if by().all(|by| by.abs() <= WIDTH) && losses.iter().sum::<f64>().is_finite() {
            rows.extend(std::iter::once(1.0).chain(by()));
            values.push(*losses);
        }
    }
    let presses = values.first()?.len();
    let design = DMatrix::from_row_iterator(values.len(), 1 + n, rows);
    let values = DMatrix::from_row_iterator(values.len(), presses, values.into_iter().flatten().copied());
    let inverse = inverse(design.tr_mul(&design))?;
    let freedom = values.nrows().saturating_sub(1 + n).max(1) as f64;
    let of_slopes = inverse.view((1, 1), (n, n));
    let project = &inverse * design.transpose();

    let lines = &project * &values;
    let scores = lines.rows(1, n);
    let press_noise = (&values - &design * &lines).norm_squared() / freedom;
    let curvature = scores * scores.transpose() - of_slopes * press_noise;

    let bend = |row: usize| {
        let by = design.row(row).columns(1, n).transpose();
        by.dot(&(&curvature * &by)) / 2.0
    };
    let unbent = DVector::from_fn(values.nrows(), |row, _| values.row(row).sum() - bend(row));
    let found = project * &unbent;
    let variance = (unbent - design.clone() * &found).norm_squared() / freedom;
    Some(QuadraticSurface {
        value: found[0],
        slope: found.rows(1, n).into_owned(),
        noise: variance.sqrt(),
        slope_covariance: of_slopes * variance,
        curvature,
    })
}

/// Inverse of a symmetric matrix; `None` if the matrix is not positive definite beyond rounding.
fn inverse(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let decomposed = Cholesky::<f64, Dyn>::new(matrix)?;
    let pivots = decomposed.l_dirty().diagonal().map(|root| root * root);
    (pivots.min() > SINGULAR * pivots.max()).then(|| decomposed.inverse())
}

impl QuadraticSurface {
    /// Value of the surface at a distance `by` from the surface's centre, in steps.
    pub fn at(&self, by: &[f64]) -> f64 {
        let by = DVector::from_column_slice(by);
        self.value + self.slope.dot(&by) + by.dot(&(&self.curvature * &by)) / 2.0
    }

    /// Minimum of the surface within bounds, in steps from the surface's centre: the best result of coordinate descents
    /// from the centre and from the ends of each axis.
    pub fn least(&self, low: &[f64], high: &[f64]) -> Vec<f64> {
        let n = self.slope.len();
        let mut starts = vec![vec![0.0; n]];
        for index in 0..n {
            for end in [low[index], high[index]] {
                let mut start = vec![0.0; n];
                start[index] = end;
                starts.push(start);
            }
        }
        let ends = starts.into_iter().map(|start| self.descend(start, low, high));
        let better = |best: Vec<f64>, one: Vec<f64>| if self.at(&one) < self.at(&best) { one } else { best };
        ends.reduce(better).unwrap_or_default()
    }

    fn descend(&self, mut by: Vec<f64>, low: &[f64], high: &[f64]) -> Vec<f64> {
        for _ in 0..SWEEPS {
            for index in 0..by.len() {
                let bend = self.curvature[(index, index)];
                let others: f64 = self.curvature.row(index).iter().zip(&by).map(|(bend, by)| bend * by).sum();
                let slope = self.slope[index] + others - bend * by[index];
                let value = |x: f64| slope * x + bend * x * x / 2.0;
                by[index] = match bend > 0.0 {
                    true => (-slope / bend).clamp(low[index], high[index]),
                    false if value(low[index]) < value(high[index]) => low[index],
                    false => high[index],
                };
            }
        }
        by
    }

    /// Covariance of the position of the surface's minimum: the inverse of the curvature (the observed information, if
    /// values are negative log likelihoods) plus the part due to noise. `None` if the surface is not convex.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let inverse = inverse(self.curvature.clone())?;
        Some(&inverse * &self.slope_covariance * &inverse + &inverse)
    }
}

/// Points of the design for `n` variables, in steps from the centre: the centre, and points on each axis.
fn design(n: usize) -> Vec<Vec<f64>> {
    let arms = if n <= FEW { &MANY_ARMS[..] } else { &ARMS[..] };
    let at = |index: usize, step: f64| (0..n).map(|other| if other == index { step } else { 0.0 }).collect();
    let on_axes = (0..n).flat_map(|index| arms.iter().map(move |&step| at(index, step)));
    std::iter::once(vec![0.0; n]).chain(on_axes).collect()
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::base::rng::{Stream, stream};

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
        surface(
            &tried.iter().map(|(at, losses)| (at.clone(), &losses[..])).collect::<Vec<TriedPoint<'_>>>(),
            centre,
            steps,
        )
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
        let error = found.covariance().expect("a covariance")[(0, 0)].sqrt() * steps[0];
        assert!((0.055..0.09).contains(&error), "{error}");
        assert_eq!((points(3), points(5)), (13, 11));
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
        // Without a correction, the first would be 500 / 2, and the second 4 + 500 / 100 / 2.5.
        assert!(sums[0].abs() < 10.0 && (sums[1] - 4.0).abs() < 0.2, "{sums:?}");
    }

    #[test]
    fn a_valley_has_no_covariance_and_ends_at_a_bound() {
        let valley = designed(|at| Some(vec![at[0], -at[0]]), &[0.0, 0.0], &[1.0, 1.0]).expect("a surface");
        assert_eq!(valley.covariance(), None);
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
        let outside =
            |one: &[f64]| surface(&[(vec![0.9, -1.8], &near), (one.to_vec(), &far)], &[0.9, -1.8], &[0.1, 0.2]);
        assert_eq!(outside(&[9.0, 9.0]), None);
        assert_eq!(designed(|_| None, &[0.9, -1.8], &[0.1, 0.2]), None);
        assert_eq!(designed(|at| Some(vec![f64::INFINITY, at[0]]), &[0.9, -1.8], &[0.1, 0.2]), None);
    }
}
