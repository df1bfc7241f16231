//! Power of the tests of a study: share of drawn studies in which a test finds an effect, with an interval that
//! includes the error due to the finite pool.
//!
//! The pool's error follows from a bootstrap over its participants: studies are drawn from resampled pools, too. The
//! variance of the shares between pools, minus the part due to the number of studies of each pool (a one-way analysis
//! of variance), is added to the binomial variance of the share; the interval is Wilson's, for the number of studies
//! that would have the total variance.

use std::ops::Range;

use serde::Serialize;

use super::arm_design::StudyArmTrial;
use super::drawn_study::{
    DrawnEffect, PowerTest, SignificanceTestMethod, SignificanceTestResult, StudySampler, results,
};
use super::effect::LEVEL;
use super::statistics::wilson;

/// Significance level of the tests in a power analysis.
pub const ALPHA: f64 = 0.05;
/// Power that a study should reach (0.8).
pub const WANTED: f64 = 0.8;
/// Number of bootstrap resamples of the pool of simulated participants.
pub const POOLS: u64 = 40;
/// Number of studies that are drawn from each resampled pool.
pub const STUDIES_OF_POOL: u64 = 25;
/// Number of studies that are drawn for each ratio of rates in the search for the least detectable effect.
pub const STUDIES_OF_RATIO: u64 = 400;
/// Number of ratios of rates that are tried in the search for the least detectable effect.
const RATIOS: u32 = 17;

/// Ratios of rates that are tried for the least detectable effect, from the weakest effect on: 0.95, 0.90, …, 0.15.
pub fn ratios() -> Vec<f64> {
    (1..=RATIOS).map(|step| f64::from(20 - step) / 20.0).collect()
}

/// Number of drawn studies in which a test rejects the null hypothesis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RejectionCount {
    /// Number of drawn studies in which the test can be computed.
    pub studies: u64,
    /// Number of studies with a corrected p value below the significance level.
    pub rejected: u64,
    /// Number of studies with an uncorrected p value below the significance level.
    pub uncorrected: u64,
    /// Number of drawn studies in which the test cannot be computed.
    pub unknown: u64,
}

impl RejectionCount {
    fn add(&mut self, result: Option<SignificanceTestResult>) {
        let Some(result) = result else {
            self.unknown += 1;
            return;
        };
        self.studies += 1;
        self.rejected += u64::from(result.p < ALPHA);
        self.uncorrected += u64::from(result.p_uncorrected < ALPHA);
    }

    /// Sum of two counts of rejections.
    pub fn plus(self, other: RejectionCount) -> RejectionCount {
        RejectionCount {
            studies: self.studies + other.studies,
            rejected: self.rejected + other.rejected,
            uncorrected: self.uncorrected + other.uncorrected,
            unknown: self.unknown + other.unknown,
        }
    }

    /// Share of studies in which the test rejects the null hypothesis; a study without a test result counts as not
    /// rejecting.
    pub fn share(&self) -> f64 {
        self.rejected as f64 / (self.studies + self.unknown).max(1) as f64
    }
}

/// Counts of rejections of each test over the studies with these numbers; the last element counts studies in which any
/// contrast of the mixed model rejects after correction.
pub fn count(
    source: &StudySampler,
    tests: &[PowerTest],
    size: usize,
    effect: DrawnEffect,
    numbers: Range<u64>,
) -> Vec<RejectionCount> {
    let mut counts = vec![RejectionCount::default(); tests.len() + 1];
    for number in numbers {
        let study: Vec<StudyArmTrial> = source.study(size, effect, number);
        let found = results(tests, &study);
        let contrasts =
            tests.iter().zip(&found).filter(|(test, _)| test.method == SignificanceTestMethod::LinearMixedModel);
        let known: Vec<SignificanceTestResult> = contrasts.filter_map(|(_, result)| *result).collect();
        let least = |p: fn(&SignificanceTestResult) -> f64| known.iter().map(p).reduce(f64::min);
        let any = least(|one| one.p).zip(least(|one| one.p_uncorrected));
        let any = any.map(|(p, p_uncorrected)| SignificanceTestResult { p, p_uncorrected });
        for (count, result) in counts.iter_mut().zip(found.into_iter().chain([any])) {
            count.add(result);
        }
    }
    counts
}

/// Share of drawn studies in which a test finds an effect: the power or, without an effect, the type I error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RejectionShare {
    /// Number of drawn studies.
    pub studies: u64,
    /// Number of studies that reject the null hypothesis by the p value corrected for the number of contrasts.
    pub rejected: u64,
    /// Number of studies that reject the null hypothesis by the uncorrected p value.
    pub rejected_uncorrected: u64,
    /// Number of studies in which the test cannot be computed; these studies count as not rejecting.
    pub unknown: u64,
    /// Share of studies that reject the null hypothesis: the power or, without an effect, the type I error.
    pub share: f64,
    /// 95 % interval of the share of rejections, including the error due to the finite pool.
    pub interval: [f64; 2],
    /// Standard deviation of the share of rejections that is due to the finite pool.
    pub pool_sd: f64,
}

impl RejectionShare {
    /// The share of rejections in studies from the pool; `of_pools` has the counts for studies from resampled pools.
    pub fn new(count: RejectionCount, of_pools: &[RejectionCount]) -> RejectionShare {
        let (share, studies) = (count.share(), count.studies + count.unknown);
        let pool_variance = variance_between(of_pools);
        let binomial = share * (1.0 - share) / studies.max(1) as f64;
        // Number of independent studies whose share would have the total variance.
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

/// Variance of the share of rejections between pools, without the part due to the finite numbers of studies; 0 with
/// fewer than two pools.
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

/// Least detectable effect: the ratio of rates closest to 1 that is found with the wanted power, interpolated between
/// the tried ratios; `None` if no ratio reaches that power. `shares` belong to [`ratios`], the weakest effect first.
pub fn least_ratio(shares: &[f64]) -> Option<f64> {
    let ratios = ratios();
    let first = shares.len() - shares.iter().rev().take_while(|share| **share >= WANTED).count();
    let (ratio, share) = (*ratios.get(first)?, *shares.get(first)?);
    let Some(weaker) = first.checked_sub(1) else { return Some(ratio) };
    let part = (share - WANTED) / (share - shares[weaker]);
    Some(ratio + part * (ratios[weaker] - ratio))
}
