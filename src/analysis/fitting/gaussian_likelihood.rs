//! A person's log likelihood as a quadratic function of the human model's parameters, which takes the noise of the
//! likelihood's estimate into account.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::score_surface::QuadraticSurface;

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
    /// H^-1 S H^-1, so that I = H (H + S)^-1 H. Directions in which the curvature is negative, by the noise that is
    /// subtracted from the curvature, carry no information.
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
    use super::*;

    /// A surface with this slope and curvature, whose slope has this variance by noise.
    fn surface(slope: &[f64], curvature: &[f64], noise: f64) -> QuadraticSurface {
        let n = slope.len();
        QuadraticSurface {
            value: 3.0,
            slope: DVector::from_column_slice(slope),
            curvature: DMatrix::from_row_slice(n, n, curvature),
            noise: noise.sqrt(),
            slope_covariance: DMatrix::identity(n, n) * noise,
        }
    }

    #[test]
    fn a_surface_without_noise_keeps_its_maximum_and_curvature() {
        // Of 2 (x - 1)^2 + 8 (y + 0.5)^2 + (x - 1) (y + 0.5), in steps of 0.5 and 0.25 from (0.7, -0.4).
        let (centre, steps) = ([0.7, -0.4], [0.5, 0.25]);
        let exact = surface(&[-0.55, 0.325], &[1.0, 0.125, 0.125, 1.0], 0.0);
        let found = GaussianLikelihood::from_surface(&exact, &centre, &steps);
        let wanted = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 16.0]);
        assert!((&found.information - &wanted).amax() < 1e-6, "{found:?}");
        let maximum = inverse(found.information) * found.weighted;
        assert!((maximum[0] - 1.0).abs() < 1e-6 && (maximum[1] + 0.5).abs() < 1e-6, "{maximum}");
    }

    #[test]
    fn noise_takes_information_away() {
        let found = GaussianLikelihood::from_surface(&surface(&[1.0], &[8.0], 2.0), &[0.0], &[1.0]);
        assert!((found.information[(0, 0)] - 8.0 * 8.0 / (8.0 + 2.0)).abs() < 1e-6, "{found:?}");
        assert!((found.weighted[0] + 0.8).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_direction_without_curvature_carries_no_information() {
        let found =
            GaussianLikelihood::from_surface(&surface(&[1.0, 1.0], &[-2.0, 0.0, 0.0, 5.0], 0.5), &[1.0; 2], &[1.0; 2]);
        assert!(found.information[(0, 0)].abs() < 1e-9 && found.weighted[0].abs() < 1e-9, "{found:?}");
        assert!(found.information[(1, 1)] > 4.0, "{found:?}");
    }
}
