//! The downhill simplex method (Nelder and Mead 1965): finds a minimum of a function of a few variables without its
//! gradient.

use std::cell::Cell;

/// Coefficients of reflection, expansion, contraction and shrinking, as in the paper of Nelder and Mead.
const REFLECT: f64 = 1.0;
const EXPAND: f64 = 2.0;
const CONTRACT: f64 = 0.5;
const SHRINK: f64 = 0.5;

/// A corner of the simplex: the function's value there, and the point.
type Corner = (f64, Vec<f64>);

/// The smallest value of a function that a search found, and the point where the function has it.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionMinimum {
    /// The point of the minimum, one value per argument of the function.
    pub at: Vec<f64>,
    /// Value of the function at the minimum.
    pub value: f64,
    /// Number of function evaluations.
    pub evaluations: usize,
    /// Whether the function's values at the corners of the last simplex are within the tolerance.
    pub converged: bool,
}

/// Looks for the minimum of `function` from `start`, with first steps of these sizes along each variable, until the
/// values at the simplex's corners differ by at most `tolerance`, or the function was evaluated `most` times. Values
/// that are not finite count as infinitely bad.
pub fn minimise(
    mut function: impl FnMut(&[f64]) -> f64,
    start: &[f64],
    steps: &[f64],
    tolerance: f64,
    most: usize,
) -> FunctionMinimum {
    let asked = Cell::new(0);
    let mut ask = |at: Vec<f64>| -> Corner {
        asked.set(asked.get() + 1);
        let value = function(&at);
        (if value.is_finite() { value } else { f64::INFINITY }, at)
    };
    let mut corners = vec![ask(start.to_vec())];
    for (index, step) in steps.iter().enumerate() {
        let mut at = start.to_vec();
        at[index] += step;
        corners.push(ask(at));
    }
    let mut converged = false;
    while asked.get() < most && !converged {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        improve(&mut corners, &mut ask);
        let values = corners.iter().map(|corner| corner.0);
        converged = values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min) <= tolerance;
    }
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (value, at) = corners.swap_remove(0);
    FunctionMinimum { at, value, evaluations: asked.get(), converged }
}

/// Replaces the worst corner of a sorted simplex by a better one, or shrinks the simplex towards its best corner.
fn improve(corners: &mut [Corner], ask: &mut impl FnMut(Vec<f64>) -> Corner) {
    let worst = corners.len() - 1;
    let centre = centre(&corners[..worst]);
    let beyond = |by: f64, from: &[f64]| -> Vec<f64> {
        centre.iter().zip(from).map(|(centre, from)| centre + by * (centre - from)).collect()
    };
    let reflected = ask(beyond(REFLECT, &corners[worst].1));
    let better = if reflected.0 < corners[0].0 {
        let expanded = ask(beyond(EXPAND, &corners[worst].1));
        Some(if expanded.0 < reflected.0 { expanded } else { reflected })
    } else if reflected.0 < corners[worst - 1].0 {
        Some(reflected)
    } else {
        let from = if reflected.0 < corners[worst].0 { &reflected } else { &corners[worst] };
        let contracted = ask(beyond(-CONTRACT, &from.1));
        (contracted.0 < from.0).then_some(contracted)
    };
    match better {
        Some(better) => corners[worst] = better,
        None => {
            let best = corners[0].1.clone();
            for corner in &mut corners[1..] {
                *corner = ask(best.iter().zip(&corner.1).map(|(best, at)| best + SHRINK * (at - best)).collect());
            }
        }
    }
}

/// Centroid (mean point) of corners of the simplex.
fn centre(corners: &[Corner]) -> Vec<f64> {
    let variables = corners[0].1.len();
    (0..variables).map(|index| corners.iter().map(|(_, at)| at[index]).sum::<f64>() / corners.len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_bottom_of_a_curved_valley() {
        // Test function: Rosenbrock's function, whose minimum is 0 at (1, 1).
        let valley = |at: &[f64]| (1.0 - at[0]).powi(2) + 100.0 * (at[1] - at[0] * at[0]).powi(2);
        let found = minimise(valley, &[-1.2, 1.0], &[0.5, 0.5], 1e-12, 1000);
        assert!(found.converged, "{found:?}");
        assert!((found.at[0] - 1.0).abs() < 1e-4 && (found.at[1] - 1.0).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn stays_where_the_function_is_defined() {
        let found = minimise(|at| at[0] - at[0].ln(), &[3.0], &[-4.0], 1e-12, 500);
        assert!((found.at[0] - 1.0).abs() < 1e-4, "{found:?}");
        let stuck = minimise(|_| f64::NAN, &[3.0], &[1.0], 1e-12, 50);
        assert!(!stuck.value.is_finite());
    }

    #[test]
    fn says_when_it_was_not_done() {
        let found = minimise(|at| at[0].powi(2), &[100.0], &[0.1], 1e-12, 5);
        assert!(!found.converged && found.evaluations >= 5, "{found:?}");
    }
}
