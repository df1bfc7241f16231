//! How often the tests of drawn studies find an effect: counts of studies, and the share with an interval that includes the error of the
//! pool.
//!
//! The pool's error follows from a bootstrap over its persons: studies are drawn from resampled pools, too. The variance of their shares
//! between pools, less what comes from the number of studies of each (a one-way analysis of variance), is added to the binomial variance of
//! the share; the interval is Wilson's with as many studies as would have that variance.

use std::ops::Range;

use serde::Serialize;

use super::arm_design::ArmTrial;
use super::drawn_study::{DrawnEffect, PowerTest, StudySource, TestMethod, TestResult, results};
use super::effect::LEVEL;
use super::statistics::wilson;

/// Level of the tests.
pub const ALPHA: f64 = 0.05;
/// The power that is asked for.
pub const WANTED: f64 = 0.8;
/// Number of resampled pools.
pub const POOLS: u64 = 40;
/// Number of studies that are drawn from each of them.
pub const STUDIES_OF_POOL: u64 = 25;
/// Number of studies for each ratio when the least effect is looked for.
pub const STUDIES_OF_RATIO: u64 = 400;
/// Number of ratios that are tried.
const RATIOS: u32 = 17;

/// The ratios of rates that are tried for the least effect, the weakest effect first: 0.95, 0.90, …, 0.15.
pub fn ratios() -> Vec<f64> {
    (1..=RATIOS).map(|step| f64::from(20 - step) / 20.0).collect()
}

/// How many of some drawn studies reject the null hypothesis of a test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RejectionCount {
    /// Number of studies in which the test can be computed.
    pub studies: u64,
    /// Of these, with p below the level.
    pub rejected: u64,
    /// The same without correction for the number of contrasts.
    pub uncorrected: u64,
    /// Studies in which the test cannot be computed.
    pub unknown: u64,
}

impl RejectionCount {
    fn add(&mut self, result: Option<TestResult>) {
        let Some(result) = result else {
            self.unknown += 1;
            return;
        };
        self.studies += 1;
        self.rejected += u64::from(result.p < ALPHA);
        self.uncorrected += u64::from(result.p_uncorrected < ALPHA);
    }

    /// The sum of two counts.
    pub fn plus(self, other: RejectionCount) -> RejectionCount {
        RejectionCount {
            studies: self.studies + other.studies,
            rejected: self.rejected + other.rejected,
            uncorrected: self.uncorrected + other.uncorrected,
            unknown: self.unknown + other.unknown,
        }
    }

    /// Share of the studies that reject. A study whose test cannot be computed finds nothing.
    pub fn share(&self) -> f64 {
        self.rejected as f64 / (self.studies + self.unknown).max(1) as f64
    }
}

/// Counts of the rejections of each test in the studies with these numbers, and last the studies in which any contrast of the mixed model
/// rejects after the correction.
pub fn count(
    source: &StudySource,
    tests: &[PowerTest],
    size: usize,
    effect: DrawnEffect,
    numbers: Range<u64>,
) -> Vec<RejectionCount> {
    let mut counts = vec![RejectionCount::default(); tests.len() + 1];
    for number in numbers {
        let study: Vec<ArmTrial> = source.study(size, effect, number);
        let found = results(tests, &study);
        let contrasts = tests.iter().zip(&found).filter(|(test, _)| test.method == TestMethod::LinearMixedModel);
        let known: Vec<TestResult> = contrasts.filter_map(|(_, result)| *result).collect();
        let least = |p: fn(&TestResult) -> f64| known.iter().map(p).reduce(f64::min);
        let any = least(|one| one.p).zip(least(|one| one.p_uncorrected));
        let any = any.map(|(p, p_uncorrected)| TestResult { p, p_uncorrected });
        for (count, result) in counts.iter_mut().zip(found.into_iter().chain([any])) {
            count.add(result);
        }
    }
    counts
}

/// The share of studies that find an effect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RejectionShare {
    /// Number of studies.
    pub studies: u64,
    /// Studies that reject the null hypothesis, with p corrected for the number of contrasts.
    pub rejected: u64,
    /// The same without that correction.
    pub rejected_uncorrected: u64,
    /// Studies in which the test cannot be computed; they count as not rejecting.
    pub unknown: u64,
    /// Their share: the power, or without an effect the type I error.
    pub share: f64,
    /// Its interval of 95 %, with the error of the pool.
    pub interval: [f64; 2],
    /// Standard deviation of the share that comes from the pool.
    pub pool_sd: f64,
}

impl RejectionShare {
    /// The share in studies from the pool; `of_pools` are the counts of studies from resampled pools.
    pub fn new(count: RejectionCount, of_pools: &[RejectionCount]) -> RejectionShare {
        let (share, studies) = (count.share(), count.studies + count.unknown);
        let pool_variance = variance_between(of_pools);
        let binomial = share * (1.0 - share) / studies.max(1) as f64;
        // As many studies as would have the whole variance by themselves.
        let worth = match binomial > 0.0 {
            true => share * (1.0 - share) / (binomial + pool_variance),
            false => studies as f64,
        };
        let interval = wilson(share, worth, LEVEL).map_or([0.0, 1.0], |found| [found.low, found.high]);
        RejectionShare {
            studies,
            rejected: count.rejected,
            rejected_uncorrected: count.uncorrected,
            unknown: count.unknown,
            share,
            interval,
            pool_sd: pool_variance.sqrt(),
        }
    }
}

/// Variance of the share between pools, without what the numbers of studies bring in; 0 with fewer than two pools.
fn variance_between(pools: &[RejectionCount]) -> f64 {
    let n = pools.len() as f64;
    if pools.len() < 2 {
        return 0.0;
    }
    let mean = pools.iter().map(RejectionCount::share).sum::<f64>() / n;
    let all = pools.iter().map(|pool| (pool.share() - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let own = |pool: &RejectionCount| {
        let studies = (pool.studies + pool.unknown) as f64;
        pool.share() * (1.0 - pool.share()) / (studies - 1.0).max(1.0)
    };
    (all - pools.iter().map(own).sum::<f64>() / n).max(0.0)
}

/// The largest ratio of rates that is found with the wanted power, interpolated between the tried ones; `None` if none is. `shares` are
/// those of [`ratios`], the weakest effect first.
pub fn least_ratio(shares: &[f64]) -> Option<f64> {
    let ratios = ratios();
    let first = shares.len() - shares.iter().rev().take_while(|share| **share >= WANTED).count();
    let (ratio, share) = (*ratios.get(first)?, *shares.get(first)?);
    let Some(weaker) = first.checked_sub(1) else { return Some(ratio) };
    let part = (share - WANTED) / (share - shares[weaker]);
    Some(ratio + part * (ratios[weaker] - ratio))
}
