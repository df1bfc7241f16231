//! Confidence intervals of statistics over trials, by a percentile bootstrap that draws trials with replacement (Efron
//! and Tibshirani 1993).

use rand::RngExt;

use tomcom_core::base::rng::stream;

/// Number of bootstrap resamples from which an interval is computed.
const RESAMPLES: usize = 2000;
/// Quantiles of the bootstrap distribution that bound the 95 % interval.
const INTERVAL: [f64; 2] = [0.025, 0.975];

/// Least number of units (such as participants) for an interval: resamples of fewer units are nearly all alike.
const FEWEST: usize = 5;

/// The 95 % interval of a statistic over these trials. `seed` seeds the random stream of the bootstrap.
///
/// # Panics
/// There are no trials.
pub fn interval<T: Copy>(trials: &[T], seed: u64, statistic: impl Fn(&[T]) -> f64) -> [f64; 2] {
    let [interval] = intervals(trials, seed, |drawn| [statistic(drawn)]);
    interval
}

/// The 95 % intervals of several statistics of the same resamples of these trials. `seed` seeds the random stream of
/// the bootstrap.
///
/// # Panics
/// There are no trials.
pub fn intervals<T: Copy, const N: usize>(
    trials: &[T],
    seed: u64,
    statistics: impl Fn(&[T]) -> [f64; N],
) -> [[f64; 2]; N] {
    let mut random = stream(seed, "bootstrap over trials", 0);
    let resampled: Vec<[f64; N]> = (0..RESAMPLES)
        .map(|_| {
            let drawn: Vec<T> = trials.iter().map(|_| trials[random.random_range(0..trials.len())]).collect();
            statistics(&drawn)
        })
        .collect();
    std::array::from_fn(|index| percentiles(resampled.iter().map(|all| all[index]).collect(), INTERVAL))
}

/// The 95 % interval of a statistic that is undefined for some resamples, which are left out. `None` with fewer than
/// five units, or if the statistic is undefined for more than half of the resamples.
pub(crate) fn interval_where_known<T: Copy>(
    units: &[T],
    seed: u64,
    statistic: impl Fn(&[T]) -> Option<f64>,
) -> Option<[f64; 2]> {
    if units.len() < FEWEST {
        return None;
    }
    let mut random = stream(seed, "bootstrap over participants", 0);
    let resampled: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            let drawn: Vec<T> = units.iter().map(|_| units[random.random_range(0..units.len())]).collect();
            statistic(&drawn)
        })
        .collect();
    (2 * resampled.len() >= RESAMPLES).then(|| percentiles(resampled, INTERVAL))
}

/// The values at these shares of the sorted values, of which there is at least one.
pub(crate) fn percentiles(mut values: Vec<f64>, shares: [f64; 2]) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    shares.map(|share| values[((values.len() - 1) as f64 * share).round() as usize])
}
