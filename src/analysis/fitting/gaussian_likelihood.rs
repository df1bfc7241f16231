//! A person's log likelihood as a quadratic function of the human model's parameters, which takes the noise of the
//! likelihood's estimate into account.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::response_surface::QuadraticSurface;

/// Small number added to the diagonal of a matrix that is inverted, as a share of the matrix's largest element;
/// rounding loses 1e-12 of that element.
const RIDGE: f64 = 1e-9;
/// The log likelihood of one person's presses as -(x - m)' I (x - m) / 2 + const, with the information matrix I and the
/// maximum m.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianLikelihood {
    /// The information matrix I: curvature of the person's log likelihood.
    pub information: DMatrix<f64>,
    /// The product I m of information and maximum, which exists also where the presses do not determine the maximum m.
    pub weighted: DVector<f64>,
}

impl GaussianLikelihood {
    /// The likelihood of a person without presses: it carries no information about the parameters.
    pub fn flat(parameters: usize) -> GaussianLikelihood {
        GaussianLikelihood { information: DMatrix::zeros(parameters, parameters), weighted: DVector::zeros(parameters) }
    }

    /// Approximates a log likelihood by a surface of its negative around a centre, whose variables are in steps.
    ///
    /// With slope g, curvature H and noise of the slope with covariance S, the covariance of the maximum m is H^-1 +
    /// H^-1 S H^-1, so that I = H (H + S)^-1 H. Directions in which the surface does not bend up carry no information.
    pub fn from_surface(surface: &QuadraticSurface, centre: &[f64], steps: &[f64]) -> GaussianLikelihood {
        let n = centre.len();
        let bent = SymmetricEigen::new(surface.curvature.clone());
        let sizes = DMatrix::from_diagonal(&bent.eigenvalues.map(|bend| bend.max(0.0)));
        let curvature = &bent.eigenvectors * sizes * bent.eigenvectors.transpose();
        let both = &curvature + &surface.slope_covariance;
        let ridge = DMatrix::identity(n, n) * (RIDGE * both.amax().max(f64::MIN_POSITIVE));
        let share = &curvature * inverse(both + ridge);
        let in_steps = &share * &curvature;
        let per_step = DMatrix::from_diagonal(&DVector::from_iterator(n, steps.iter().map(|step| 1.0 / step)));
        let information = &per_step * (&in_steps + in_steps.transpose()) * &per_step / 2.0;
        let slope = &per_step * (&share * &surface.slope);
        let weighted = &information * DVector::from_column_slice(centre) - slope;
        GaussianLikelihood { information, weighted }
    }
}

/// Inverse of a matrix that is invertible except for rounding; otherwise zero, so that what the matrix weighs counts as
/// unknown.
pub(super) fn inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = matrix.shape();
    matrix.try_inverse().unwrap_or_else(|| DMatrix::zeros(rows, columns))
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::super::response_surface::surface;
    use super::super::score_surface::{ScoreRegression, TriedPoint, points_around};
    use super::*;
    use crate::base::rng::stream;

    #[test]
    fn a_surface_without_noise_keeps_its_maximum_and_curvature() {
        let loss = |x: &[f64]| 2.0 * (x[0] - 1.0).powi(2) + 8.0 * (x[1] + 0.5).powi(2) + (x[0] - 1.0) * (x[1] + 0.5);
        let (centre, steps) = ([0.7, -0.4], [0.5, 0.25]);
        let found = GaussianLikelihood::from_surface(&surface(loss, &centre, &steps).expect("one"), &centre, &steps);
        let wanted = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 16.0]);
        assert!((&found.information - &wanted).amax() < 1e-6, "{found:?}");
        let maximum = inverse(found.information) * found.weighted;
        assert!((maximum[0] - 1.0).abs() < 1e-6 && (maximum[1] + 0.5).abs() < 1e-6, "{maximum}");
    }

    #[test]
    fn noise_takes_information_away() {
        let mut sign = 1.0;
        let mut noisy = |x: &[f64]| {
            sign = -sign;
            4.0 * x[0] * x[0] + 0.4 * sign
        };
        let (centre, steps) = ([0.0], [1.0]);
        let rough = surface(&mut noisy, &centre, &steps).expect("a surface");
        let found = GaussianLikelihood::from_surface(&rough, &centre, &steps);
        let information = found.information[(0, 0)];
        let (bend, noise) = (rough.curvature[(0, 0)], rough.slope_covariance[(0, 0)]);
        assert!((information - bend * bend / (bend + noise)).abs() < 1e-6 && noise > 0.0, "{found:?}");
        assert!(information > 0.0 && information < bend, "{found:?}");
    }

    #[test]
    fn a_likelihood_of_noise_alone_gives_little_information() {
        let mut random = stream(9827, "noise", 0);
        let mut sum = 0.0;
        for _ in 0..200 {
            // 40 presses whose losses, each with variance 1/12, do not depend on the parameter.
            let noise =
                points_around(&[0.0], &[1.0]).into_iter().map(|at| (at, (0..40).map(|_| random.random()).collect()));
            let noise: Vec<(Vec<f64>, Vec<f64>)> = noise.collect();
            let tried: Vec<TriedPoint<'_>> = noise.iter().map(|(at, losses)| (at.clone(), &losses[..])).collect();
            let flat = ScoreRegression::new(&tried, &[0.0], &[1.0]).expect("points").surface();
            sum += GaussianLikelihood::from_surface(&flat, &[0.0], &[1.0]).information[(0, 0)];
        }
        // The sum of the squared slopes of noise is 40 / 12 / 2 = 1.7 in the mean.
        assert!(sum / 200.0 < 0.2, "{}", sum / 200.0);
    }
}
