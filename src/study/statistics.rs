//! Textbook statistics for small samples, such as a study with some tens of participants.
//!
//! Probability distributions come from the crate `statrs`. `tests/outside/study.py` compares every result with SciPy,
//! pingouin and scikit-learn.

use rand::RngExt;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_core::measures::median;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FTest {
    pub f: f64,
    pub df: [f64; 2],
    /// p value: probability, without an effect, of an F statistic at least this large.
    pub p: f64,
    pub n: usize,
    /// Partial eta squared: the effect's sum of squares divided by the sum of effect and residual sums of squares.
    pub partial_eta_sq: f64,
}

impl FTest {
    /// F test from sums of squares of `n` participants; `None` without degrees of freedom or without variance.
    fn from_sums_of_squares(effect: f64, df_effect: f64, residual: f64, df_residual: f64, n: usize) -> Option<FTest> {
        if df_effect <= 0.0 || df_residual <= 0.0 || residual <= 0.0 {
            return None;
        }
        let f = (effect / df_effect) / (residual / df_residual);
        let p = FisherSnedecor::new(df_effect, df_residual).ok()?.sf(f);
        Some(FTest { f, df: [df_effect, df_residual], p, n, partial_eta_sq: effect / (effect + residual) })
    }
}

/// Mixed analysis of variance with two measurements per person (within) and any number of groups (between).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MixedAnova {
    pub within: Option<FTest>,
    pub between: Option<FTest>,
    pub interaction: Option<FTest>,
}

/// Mixed analysis of variance; each row holds a person's group and the person's two measurements. Sums of squares are of
/// type III: the factor within is tested at the unweighted mean of the groups, so that groups of unequal size do not mix the
/// factor between into it.
pub(crate) fn mixed_anova(rows: &[(usize, [f64; 2])]) -> MixedAnova {
    let groups = rows.iter().map(|(group, _)| group + 1).max().unwrap_or(0);
    let in_group = |group: usize| rows.iter().filter(move |(other, _)| *other == group).map(|(_, values)| *values);
    let sizes: Vec<f64> = (0..groups).map(|group| in_group(group).count() as f64).collect();
    let used: Vec<usize> = (0..groups).filter(|&group| sizes[group] > 0.0).collect();
    let (number, n) = (used.len() as f64, rows.len() as f64);
    let difference = |values: [f64; 2]| values[1] - values[0];
    let sum = |values: [f64; 2]| values[1] + values[0];
    let decompose = |of: fn([f64; 2]) -> f64| {
        let all = mean_or_zero(rows.iter().map(|(_, values)| of(*values)));
        let means: Vec<f64> = (0..groups).map(|group| mean_or_zero(in_group(group).map(of))).collect();
        let between: f64 = used.iter().map(|&group| sizes[group] * (means[group] - all).powi(2)).sum();
        let residual: f64 = rows.iter().map(|(group, values)| (of(*values) - means[*group]).powi(2)).sum();
        let unweighted = mean_or_zero(used.iter().map(|&group| means[group]));
        (unweighted, between / 2.0, residual / 2.0)
    };
    let (mean_difference, interaction, residual_within) = decompose(difference);
    let (_, between, residual_between) = decompose(sum);
    // The unweighted mean of the groups' means has the variance of the mean of this many persons.
    let persons = number * number / used.iter().map(|&group| 1.0 / sizes[group]).sum::<f64>();
    let within = persons * mean_difference * mean_difference / 2.0;
    let test =
        |effect: f64, df: f64, residual: f64| FTest::from_sums_of_squares(effect, df, residual, n - number, rows.len());
    MixedAnova {
        within: test(within, 1.0, residual_within),
        between: test(between, number - 1.0, residual_between),
        interaction: test(interaction, number - 1.0, residual_within),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Correlation {
    pub r: f64,
    pub p: f64,
    pub n: usize,
}

/// Pearson's correlation of x and y; `None` with fewer than three pairs, or without variance.
pub fn pearson(x: &[f64], y: &[f64]) -> Option<Correlation> {
    let n = x.len().min(y.len());
    if n < 3 {
        return None;
    }
    let (mx, my) = (mean_or_zero(x[..n].iter().copied()), mean_or_zero(y[..n].iter().copied()));
    let pairs = || x[..n].iter().zip(&y[..n]).map(|(x, y)| (x - mx, y - my));
    let (xx, yy, xy) = pairs().fold((0.0, 0.0, 0.0), |(xx, yy, xy), (x, y)| (xx + x * x, yy + y * y, xy + x * y));
    if xx <= 0.0 || yy <= 0.0 {
        return None;
    }
    let r = (xy / (xx * yy).sqrt()).clamp(-1.0, 1.0);
    let df = n as f64 - 2.0;
    let t = r * (df / (1.0 - r * r).max(f64::MIN_POSITIVE)).sqrt();
    let p = 2.0 * StudentsT::new(0.0, 1.0, df).ok()?.sf(t.abs());
    Some(Correlation { r, p, n })
}

/// Largest number of permutations that are enumerated; if there are more, permutations are sampled at random.
const MAX_ENUMERATED: f64 = 200_000.0;
const SAMPLED_PERMUTATIONS: u32 = 100_000;
/// Largest number of pairs of values of two samples for which the distribution of U is exact (two samples of 250). Above,
/// the normal approximation leaves out at most one difference more or less, and rounding would spoil the exact numbers.
const MAX_EXACT_PAIRS: usize = 62_500;
/// Relative tolerance within which differences count as equal.
const EQUALITY_TOLERANCE: f64 = 1e-12;

/// Two-sided permutation test of the difference between two groups' means (Fisher 1935): the share of assignments to
/// groups with at least the observed difference. Exact up to 200,000 assignments, else from 100,000 random assignments
/// and the observed one, with a random stream seeded by `seed`. `None` if a group is empty.
pub fn permutation_p(a: &[f64], b: &[f64], seed: u64) -> Option<f64> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    let mut all: Vec<f64> = a.iter().chain(b).copied().collect();
    let total: f64 = all.iter().sum();
    let (m, n) = (a.len(), all.len());
    let difference = |sum: f64| sum / m as f64 - (total - sum) / (n - m) as f64;
    let observed = difference(a.iter().sum()).abs();
    let is_extreme =
        |sum: f64| difference(sum).abs() >= observed - EQUALITY_TOLERANCE * observed.max(f64::MIN_POSITIVE);
    if binomial(n, m) <= MAX_ENUMERATED {
        let (mut extreme, mut count) = (0u64, 0u64);
        for_each_choice(n, m, |chosen| {
            count += 1;
            extreme += u64::from(is_extreme(chosen.iter().map(|&index| all[index]).sum()));
        });
        return Some(extreme as f64 / count as f64);
    }
    let mut random = stream(seed, "permutation", 0);
    let mut extreme = 1u32;
    for _ in 0..SAMPLED_PERMUTATIONS {
        shuffle(&mut all, &mut random);
        extreme += u32::from(is_extreme(all[..m].iter().sum()));
    }
    Some(f64::from(extreme) / f64::from(SAMPLED_PERMUTATIONS + 1))
}

fn binomial(n: usize, m: usize) -> f64 {
    (0..m).map(|index| (n - index) as f64 / (index + 1) as f64).product()
}

/// Calls `visit` with every subset of `m` of `n` indices, in lexical order.
fn for_each_choice(n: usize, m: usize, mut visit: impl FnMut(&[usize])) {
    let mut chosen: Vec<usize> = (0..m).collect();
    loop {
        visit(&chosen);
        let Some(at) = (0..m).rev().find(|&at| chosen[at] < n - m + at) else { return };
        chosen[at] += 1;
        for next in at + 1..m {
            chosen[next] = chosen[next - 1] + 1;
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ConfidenceInterval {
    pub estimate: f64,
    pub low: f64,
    pub high: f64,
    /// Actual coverage of the interval; it differs from the requested level where only some levels are possible.
    pub level: f64,
}

/// Hodges-Lehmann estimate of the shift from `b` to `a` (median of all differences) with the Mann-Whitney test's
/// confidence interval (distribution of U without ties; Hollander and Wolfe 1999, section 4.2). `None` if a group is
/// empty.
pub fn hodges_lehmann(a: &[f64], b: &[f64], level: f64) -> Option<ConfidenceInterval> {
    let mut differences: Vec<f64> = a.iter().flat_map(|a| b.iter().map(move |b| a - b)).collect();
    differences.sort_unstable_by(f64::total_cmp);
    let last = differences.len().checked_sub(1)?;
    let tail = (1.0 - level) / 2.0;
    let (left_out, below) = match differences.len() {
        0..=MAX_EXACT_PAIRS => omitted(exact_cdf(a.len(), b.len()).into_iter(), tail),
        _ => omitted(normal_cdf(a.len(), b.len()), tail),
    };
    let low = if left_out == 0 { f64::NEG_INFINITY } else { differences[left_out - 1] };
    let high = if left_out == 0 { f64::INFINITY } else { differences[last + 1 - left_out] };
    Some(ConfidenceInterval { estimate: median(differences)?, low, high, level: 1.0 - 2.0 * below })
}

/// Number of differences left out on each side, and the probability of each side: at most `tail`.
fn omitted(cumulated: impl Iterator<Item = f64>, tail: f64) -> (usize, f64) {
    cumulated.take_while(|p| *p <= tail).fold((0, 0.0), |(count, _), p| (count + 1, p))
}

/// P(U <= u) for u = 0, 1, …, m n / 2 by the normal approximation with continuity correction.
fn normal_cdf(m: usize, n: usize) -> impl Iterator<Item = f64> {
    let (pairs, values) = ((m * n) as f64, (m + n) as f64);
    let (mean, deviation) = (pairs / 2.0, (pairs * (values + 1.0) / 12.0).sqrt());
    let normal = Normal::standard();
    (0..=m * n / 2).map(move |u| normal.cdf((u as f64 + 0.5 - mean) / deviation))
}

/// The same probabilities, exact for samples without ties.
///
/// The numbers of ways to get U = u are the coefficients of the Gaussian binomial, the product over i = 1 to m of
/// (1 - q^(n + i)) / (1 - q^i), so that one row of numbers suffices.
fn exact_cdf(m: usize, n: usize) -> Vec<f64> {
    let (m, n, half) = (m.min(n), m.max(n), m * n / 2);
    let (mut ways, mut total) = (vec![0.0; half + 1], 1.0);
    ways[0] = 1.0;
    for i in 1..=m {
        // With i values of the smaller sample, U is at most i n.
        let top = half.min(i * n);
        for u in (n + i..=top).rev() {
            ways[u] -= ways[u - n - i];
        }
        for u in i..=top {
            ways[u] += ways[u - i];
        }
        total = total * (n + i) as f64 / i as f64;
    }
    let mut sum = 0.0;
    let cumulate = |ways: f64| {
        sum += ways;
        sum / total
    };
    ways.into_iter().map(cumulate).collect()
}

/// Hedges' g of two groups: difference of the means in pooled standard deviations, with the small-sample correction.
pub fn hedges_g(a: &[f64], b: &[f64]) -> Option<f64> {
    let df = (a.len() + b.len()) as f64 - 2.0;
    if a.is_empty() || b.is_empty() || df <= 0.0 {
        return None;
    }
    let (ma, mb) = (mean_or_zero(a.iter().copied()), mean_or_zero(b.iter().copied()));
    let squares = |values: &[f64], m: f64| values.iter().map(|value| (value - m).powi(2)).sum::<f64>();
    let pooled = ((squares(a, ma) + squares(b, mb)) / df).sqrt();
    (pooled > 0.0).then(|| (ma - mb) / pooled * (1.0 - 3.0 / (4.0 * (df + 2.0) - 9.0)))
}

/// Proportion `p` of `n` with its Wilson score interval (Wilson 1927); `n` may be the fractional number of observations
/// with the same variance. `None` if `n` is 0.
pub(crate) fn wilson(p: f64, n: f64, level: f64) -> Option<ConfidenceInterval> {
    if n <= 0.0 {
        return None;
    }
    let z = Normal::standard().inverse_cdf(0.5 + level / 2.0);
    let (centre, reach) = ((p + z * z / (2.0 * n)), z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt());
    let scale = 1.0 + z * z / n;
    Some(ConfidenceInterval { estimate: p, low: (centre - reach) / scale, high: (centre + reach) / scale, level })
}

/// Mean of the values; `None` without values.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

fn mean_or_zero(values: impl Iterator<Item = f64>) -> f64 {
    mean(values).unwrap_or(0.0)
}

/// Standard deviation of a sample; `None` with fewer than two values.
pub(crate) fn sample_sd(values: &[f64]) -> Option<f64> {
    let middle = mean(values.iter().copied()).filter(|_| values.len() > 1)?;
    let sum: f64 = values.iter().map(|value| (value - middle).powi(2)).sum();
    Some((sum / (values.len() - 1) as f64).sqrt())
}

const RESAMPLES: usize = 2000;
const SEED: u64 = 1;
const INTERVAL: [f64; 2] = [0.025, 0.975];

/// Least number of units (such as participants) for an interval: resamples of fewer units are nearly all alike.
pub(crate) const FEWEST: usize = 5;

/// The 95 % intervals of statistics of the same resamples. `seed`: of the random stream. Panics: there are no trials.
pub fn intervals<T: Copy, const N: usize>(
    trials: &[T],
    seed: u64,
    statistics: impl Fn(&[T]) -> [f64; N],
) -> [[f64; 2]; N] {
    let resamples = resamples(trials, stream(seed, "bootstrap over trials", 0));
    let resampled: Vec<[f64; N]> = resamples.map(|drawn| statistics(&drawn)).collect();
    std::array::from_fn(|index| percentiles(resampled.iter().map(|all| all[index]).collect(), INTERVAL))
}

/// The 95 % interval; `None` with fewer than five units, or if the statistic is undefined for more than half of the
/// resamples. The same units give the same interval.
pub(crate) fn interval_where_known<T: Copy>(units: &[T], statistic: impl Fn(&[T]) -> Option<f64>) -> Option<[f64; 2]> {
    if units.len() < FEWEST {
        return None;
    }
    let resamples = resamples(units, stream(SEED, "bootstrap over participants", 0));
    let resampled: Vec<f64> = resamples.filter_map(|drawn| statistic(&drawn)).collect();
    (2 * resampled.len() >= RESAMPLES).then(|| percentiles(resampled, INTERVAL))
}

fn resamples<T: Copy>(units: &[T], mut random: Stream) -> impl Iterator<Item = Vec<T>> {
    (0..RESAMPLES).map(move |_| units.iter().map(|_| units[random.random_range(0..units.len())]).collect::<Vec<T>>())
}

/// The values at these shares of the sorted values, of which there is at least one.
pub(crate) fn percentiles(mut values: Vec<f64>, shares: [f64; 2]) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    shares.map(|share| values[((values.len() - 1) as f64 * share).round() as usize])
}
