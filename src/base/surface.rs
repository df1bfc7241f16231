//! A quadratic surface through values of a function around its minimum, by least squares over a central composite design
//! (Box and Wilson 1951): where it is least and how it is curved, even if the values are a little noisy.

use super::linear::inverse;

/// The minimum is looked for within so many steps of the design's centre.
const REACH: f64 = 1.5;

/// What a surface says of the function that it goes through.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Where it is least.
    pub at: Vec<f64>,
    /// Its value there.
    pub value: f64,
    /// The inverse of its second derivatives.
    pub covariance: Vec<Vec<f64>>,
}

/// How many values [`surface`] asks for, of a function of so many variables.
pub fn points(variables: usize) -> usize {
    design(variables).len()
}

/// The surface through values around `centre`, up to a step of these sizes along each variable and each pair of them.
/// Values that are not finite are left out. `None` if it is not curved upwards in every direction.
pub fn surface(mut function: impl FnMut(&[f64]) -> f64, centre: &[f64], steps: &[f64]) -> Option<Surface> {
    let n = centre.len();
    let there = |by: &[f64]| -> Vec<f64> { (0..n).map(|index| centre[index] + by[index] * steps[index]).collect() };
    let count = 1 + n + n * (n + 1) / 2;
    let mut squares = vec![vec![0.0; count]; count];
    let mut sums = vec![0.0; count];
    for by in design(n) {
        let value = function(&there(&by));
        if value.is_finite() {
            let terms = terms(&by);
            for (row, one) in terms.iter().enumerate() {
                sums[row] += one * value;
                squares[row].iter_mut().zip(&terms).for_each(|(sum, other)| *sum += one * other);
            }
        }
    }
    let solved = inverse(&squares)?;
    let times = |row: &[f64], by: &[f64]| row.iter().zip(by).map(|(a, b)| a * b).sum::<f64>();
    let found: Vec<f64> = solved.iter().map(|row| times(row, &sums)).collect();
    let mut curvature = vec![vec![0.0; n]; n];
    for (term, (one, other)) in pairs(n).into_iter().enumerate() {
        curvature[one][other] += found[1 + n + term];
        curvature[other][one] += found[1 + n + term];
    }
    let covariance = inverse(&curvature)?;
    let least: Vec<f64> = covariance.iter().map(|row| (-times(row, &found[1..=n])).clamp(-REACH, REACH)).collect();
    let scaled = |row: usize| (0..n).map(|column| covariance[row][column] * steps[row] * steps[column]).collect();
    Some(Surface { at: there(&least), value: times(&found, &terms(&least)), covariance: (0..n).map(scaled).collect() })
}

/// The points of the design, in steps from its centre.
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
            // Half of the corners, so that the diagonals take turns.
            let turned = if (index + other) % 2 == 0 { 1.0 } else { -1.0 };
            points.extend([-1.0, 1.0].map(|step| at(&[(index, step), (other, turned * step)])));
        }
    }
    points
}

fn pairs(n: usize) -> Vec<(usize, usize)> {
    (0..n).flat_map(|one| (0..=one).map(move |other| (one, other))).collect()
}

/// 1, every variable, every product of two.
fn terms(by: &[f64]) -> Vec<f64> {
    let products = pairs(by.len()).into_iter().map(|(one, other)| by[one] * by[other]);
    std::iter::once(1.0).chain(by.iter().copied()).chain(products).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_minimum_and_curvature_of_what_is_quadratic() {
        let function = |x: &[f64]| {
            let (a, b) = (x[0] - 1.0, x[1] + 2.0);
            3.0 + 2.0 * a * a + 1.5 * b * b + a * b
        };
        let found = surface(function, &[0.9, -2.2], &[0.4, 0.3]).expect("a surface");
        // Second derivatives: 4, 3, and 1 across.
        let expected = [[3.0 / 11.0, -1.0 / 11.0], [-1.0 / 11.0, 4.0 / 11.0]];
        assert!((found.value - 3.0).abs() < 1e-9, "{found:?}");
        assert!((found.at[0] - 1.0).abs() < 1e-9 && (found.at[1] + 2.0).abs() < 1e-9, "{found:?}");
        for (row, expected) in found.covariance.iter().zip(&expected) {
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        }
        assert_eq!(points(2), 11);
    }

    #[test]
    fn a_valley_has_no_covariance() {
        assert_eq!(surface(|x| x[0] * x[0], &[0.0, 0.0], &[1.0, 1.0]), None);
        assert_eq!(surface(|x| x[0] * x[0] - x[1] * x[1], &[0.0, 0.0], &[1.0, 1.0]), None);
    }
}
