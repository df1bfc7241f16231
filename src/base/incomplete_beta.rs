//! The regularised incomplete beta function: the distribution function of the beta distribution.

/// Largest number of terms of the continued fraction, which converges in O(sqrt(max(a, b))) terms.
const MAX_TERMS: u32 = 1000;
/// Relative change of the continued fraction at which it has converged.
const CONVERGED: f64 = 1e-14;
/// Replaces a denominator of 0 in the continued fraction (Lentz's method).
const TINY: f64 = 1e-300;

/// I_x(a, b): the probability that a variate of the beta distribution with parameters `a` and `b`, both above 0, is at
/// most `x`. With `a` = 0 the variate is 0, with `b` = 0 it is 1. The continued fraction is 8.17.22 of the NIST Digital
/// Library of Mathematical Functions, evaluated by Lentz's method.
pub fn regularized_incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x >= 1.0 || a <= 0.0 {
        return 1.0;
    }
    if x <= 0.0 || b <= 0.0 {
        return 0.0;
    }
    // The continued fraction converges fast below the mean of the distribution; above it, its mirror image does.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - below_mean(1.0 - x, b, a);
    }
    below_mean(x, a, b)
}

fn below_mean(x: f64, a: f64, b: f64) -> f64 {
    let log_front = ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (-x).ln_1p();
    (log_front.exp() / (a * fraction(x, a, b))).clamp(0.0, 1.0)
}

/// The denominator of the continued fraction 1 + d1 / (1 + d2 / (1 + ...)).
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    let (mut value, mut above, mut below) = (1.0, 1.0, 0.0);
    for term in 1..=MAX_TERMS {
        let m = f64::from(term / 2);
        let coefficient = match term % 2 {
            0 => m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            _ => -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        };
        let no_zero = |value: f64| if value.abs() < TINY { TINY } else { value };
        below = 1.0 / no_zero(1.0 + coefficient * below);
        above = no_zero(1.0 + coefficient / above);
        value *= above * below;
        if (above * below - 1.0).abs() < CONVERGED {
            break;
        }
    }
    value
}

/// Argument from which Stirling's series is exact to double precision with the terms below.
const STIRLING_FROM: f64 = 10.0;

/// ln Gamma(x) for x above 0, by Stirling's series (5.11.1 of the Digital Library of Mathematical Functions) after
/// steps of Gamma(x + 1) = x Gamma(x).
fn ln_gamma(x: f64) -> f64 {
    // B_2k / (2k (2k - 1)) for k = 1 to 7.
    const SERIES: [f64; 7] =
        [1.0 / 12.0, -1.0 / 360.0, 1.0 / 1260.0, -1.0 / 1680.0, 1.0 / 1188.0, -691.0 / 360_360.0, 1.0 / 156.0];
    let (mut x, mut steps) = (x, 0.0);
    while x < STIRLING_FROM {
        steps += x.ln();
        x += 1.0;
    }
    let inverse_square = 1.0 / (x * x);
    let series = SERIES.iter().rev().fold(0.0, |sum, term| sum * inverse_square + term) / x;
    (x - 0.5) * x.ln() - x + 0.5 * std::f64::consts::TAU.ln() + series - steps
}
