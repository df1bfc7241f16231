//! Linear algebra of small symmetric matrices.

/// Inverse of a symmetric positive definite matrix by Cholesky decomposition; `None` if the matrix is not positive definite.
pub fn inverse(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let mut lower = vec![vec![0.0; n]; n];
    for row in 0..n {
        for column in 0..=row {
            let sum: f64 = (0..column).map(|k| lower[row][k] * lower[column][k]).sum();
            let rest = matrix[row][column] - sum;
            lower[row][column] = match row == column {
                true if rest.is_finite() && rest > 0.0 => rest.sqrt(),
                true => return None,
                false => rest / lower[column][column],
            };
        }
    }
    let column_of = |column: usize| {
        let mut solved = vec![0.0; n];
        for row in 0..n {
            let sum: f64 = (0..row).map(|k| lower[row][k] * solved[k]).sum();
            solved[row] = (f64::from(u8::from(row == column)) - sum) / lower[row][row];
        }
        for row in (0..n).rev() {
            let sum: f64 = (row + 1..n).map(|k| lower[k][row] * solved[k]).sum();
            solved[row] = (solved[row] - sum) / lower[row][row];
        }
        solved
    };
    // The inverse is symmetric: its columns are its rows.
    Some((0..n).map(column_of).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverts_what_is_positive_definite_and_refuses_what_is_not() {
        let found = inverse(&[vec![4.0, 2.0], vec![2.0, 3.0]]).expect("an inverse");
        let expected = [[0.375, -0.25], [-0.25, 0.5]];
        for (row, expected) in found.iter().zip(&expected) {
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        }
        assert_eq!(inverse(&[vec![1.0, 2.0], vec![2.0, 1.0]]), None);
        assert_eq!(inverse(&[vec![f64::NAN]]), None);
    }
}
