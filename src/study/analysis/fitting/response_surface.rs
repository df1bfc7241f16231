//! Quadratic response surfaces: least squares fits to the values of a noisy function over a central composite design
//! (Box and Wilson 1951), with the surfaces' minimum and curvature.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Distance from the centre up to which a quadratic surface is trusted, in steps.
pub const REACH: f64 = 1.5;
/// Number of sweeps of coordinate descent by which the surface's minimum is found.
const SWEEPS: usize = 60;
/// A matrix counts as singular if its smallest pivot is at most this share of its largest pivot.
const SINGULAR: f64 = 1e-12;

/// A quadratic surface that approximates a noisy function; variables are in steps from its centre.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadraticSurface {
    pub value: f64,
    pub slope: DVector<f64>,
    pub curvature: DMatrix<f64>,
    /// Standard deviation of the residuals between function values and surface.
    pub noise: f64,
}

pub fn points(variables: usize) -> usize {
    design(variables).len()
}

/// Values that are not finite are ignored; `None` if too few remain.
pub fn surface(mut function: impl FnMut(&[f64]) -> f64, centre: &[f64], steps: &[f64]) -> Option<QuadraticSurface> {
    let n = centre.len();
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for by in design(n) {
        let at: Vec<f64> = by.iter().zip(centre).zip(steps).map(|((by, centre), step)| centre + by * step).collect();
        let value = function(&at);
        if value.is_finite() {
            rows.extend(terms(&by));
            values.push(value);
        }
    }
    let count = terms(&vec![0.0; n]).len();
    let design = DMatrix::from_row_iterator(values.len(), count, rows);
    let values = DVector::from_vec(values);
    let inverse = inverse(design.tr_mul(&design))?;
    let found = &inverse * design.tr_mul(&values);
    let mut curvature = DMatrix::zeros(n, n);
    for (term, (one, other)) in pairs(n).into_iter().enumerate() {
        curvature[(one, other)] += found[1 + n + term];
        curvature[(other, one)] += found[1 + n + term];
    }
    let residuals = values - design * &found;
    let variance = residuals.norm_squared() / residuals.len().saturating_sub(count).max(1) as f64;
    Some(QuadraticSurface { value: found[0], slope: found.rows(1, n).into_owned(), curvature, noise: variance.sqrt() })
}

/// Inverse of a symmetric matrix; `None` if the matrix is not positive definite beyond rounding.
pub(super) fn inverse(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let decomposed = Cholesky::<f64, Dyn>::new(matrix)?;
    let pivots = decomposed.l_dirty().diagonal().map(|root| root * root);
    (pivots.min() > SINGULAR * pivots.max()).then(|| decomposed.inverse())
}

impl QuadraticSurface {
    pub fn at(&self, by: &[f64]) -> f64 {
        let by = DVector::from_column_slice(by);
        self.value + self.slope.dot(&by) + by.dot(&(&self.curvature * &by)) / 2.0
    }

    /// Minimum within bounds, in steps: the best of coordinate descents from the centre and the ends of each axis.
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

    pub fn is_convex(&self) -> bool {
        inverse(self.curvature.clone()).is_some()
    }

    /// Variances of the position of the surface's minimum, per variable, where the surface's slope has the covariance
    /// `slopes`: the larger of H^-1 S H^-1 with the curvature H (the "sandwich" of Huber 1967 and White 1982) and of H^-1
    /// (the observed information), since a curvature that noise makes too large shrinks the first more. `None` if the
    /// surface is not convex.
    pub fn variances(&self, slopes: &DMatrix<f64>) -> Option<DVector<f64>> {
        let inverse = inverse(self.curvature.clone())?;
        let sandwich = &inverse * slopes * &inverse;
        Some(sandwich.diagonal().zip_map(&inverse.diagonal(), f64::max))
    }
}

/// Points of the central composite design for `n` variables, in steps from the centre.
fn design(n: usize) -> Vec<Vec<f64>> {
    let at = |moves: &[(usize, f64)]| {
        let mut by = vec![0.0; n];
        moves.iter().for_each(|&(index, step)| by[index] = step);
        by
    };
    let mut points = vec![at(&[])];
    for index in 0..n {
        points.extend([-1.0, -0.5, 0.5, 1.0].map(|step| at(&[(index, step)])));
        for other in 0..index {
            // Only half of the corners of each pair of variables are points; they alternate between the two diagonals.
            let turned = if (index + other) % 2 == 0 { 1.0 } else { -1.0 };
            points.extend([-1.0, 1.0].map(|step| at(&[(index, step), (other, turned * step)])));
        }
    }
    points
}

fn pairs(n: usize) -> Vec<(usize, usize)> {
    (0..n).flat_map(|one| (0..=one).map(move |other| (one, other))).collect()
}

/// Terms of the quadratic model at a point: 1, every variable, and every product of two variables.
fn terms(by: &[f64]) -> Vec<f64> {
    let products = pairs(by.len()).into_iter().map(|(one, other)| by[one] * by[other]);
    std::iter::once(1.0).chain(by.iter().copied()).chain(products).collect()
}
