//! Command `tomcom power`: draws studies from a pool of simulated participants on all processors, and counts in how
//! many of them the tests find an effect. The same pool gives the same result on any number of processors.
//!
//! Power is the share of drawn studies in which a test finds an effect, with an interval that includes the error due to
//! the finite pool. That error follows from a bootstrap over the pool's participants: studies are drawn from resampled
//! pools, too. The variance of the shares between pools, minus the part due to the number of studies of each pool (a
//! one-way analysis of variance), is added to the binomial variance of the share; the interval is Wilson's, for the
//! number of studies that would have the total variance.

use std::ops::Range;
use std::path::Path;

use serde::Serialize;

use crate::arm_comparison::StudyArmTrial;
use crate::drawn_study::{
    DrawnEffect, PowerTest, SignificanceTestMethod, SignificanceTestResult, StudySampler, reference, results, tests,
};
use crate::effect::LEVEL;
use crate::parallel;
use crate::pool::{PoolHeader, SimulationPool};
use crate::statistics::wilson;
use tomcom_core::base::text::count;
use tomcom_session::files::file_error::{FileError, FileResult};
use tomcom_session::plan::PrimaryOutcome;
use tomcom_session::study_arm::StudyArm;

pub(crate) const ALPHA: f64 = 0.05;
/// Power that a study should reach (0.8).
pub(crate) const WANTED: f64 = 0.8;
pub(crate) const POOLS: u64 = 40;
pub(crate) const STUDIES_OF_POOL: u64 = 25;
/// Number of studies that are drawn for each ratio of rates in the search for the least detectable effect.
pub(crate) const STUDIES_OF_RATIO: u64 = 400;
const RATIOS: u32 = 17;

/// Ratios of rates that are tried for the least detectable effect, from the weakest effect on: 0.95, 0.90, …, 0.15.
pub fn ratios() -> Vec<f64> {
    (1..=RATIOS).map(|step| f64::from(20 - step) / 20.0).collect()
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RejectionCount {
    pub studies: u64,
    pub rejected: u64,
    pub uncorrected: u64,
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

    pub fn plus(self, other: RejectionCount) -> RejectionCount {
        RejectionCount {
            studies: self.studies + other.studies,
            rejected: self.rejected + other.rejected,
            uncorrected: self.uncorrected + other.uncorrected,
            unknown: self.unknown + other.unknown,
        }
    }

    /// A study without a test result counts as not rejecting.
    pub fn share(&self) -> f64 {
        self.rejected as f64 / (self.studies + self.unknown).max(1) as f64
    }
}

/// The last element counts studies in which any contrast of the mixed model rejects after correction.
pub(crate) fn count_rejections(
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
    pub studies: u64,
    /// Number of studies that reject the null hypothesis by the p value corrected for the number of contrasts.
    pub rejected: u64,
    /// Number of studies that reject the null hypothesis by the uncorrected p value.
    pub rejected_uncorrected: u64,
    /// Number of studies in which the test cannot be computed; these studies count as not rejecting.
    pub unknown: u64,
    pub share: f64,
    /// 95 % interval of the share of rejections, including the error due to the finite pool.
    pub interval: [f64; 2],
    /// Standard deviation of the share of rejections that is due to the finite pool.
    pub pool_sd: f64,
}

impl RejectionShare {
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

/// Of the shares, without the part due to the finite numbers of studies; 0 with fewer than two pools.
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

/// Each list has an entry per test and a last entry for any of the contrasts.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleSizeRejections {
    pub participants: usize,
    pub counts: Vec<RejectionCount>,
    pub of_pools: Vec<Vec<RejectionCount>>,
    /// With each tried ratio, the weakest effect first; empty if the least effect was not searched for.
    pub of_ratios: Vec<Vec<RejectionCount>>,
}

/// Power of a study for several numbers of participants: the output of `tomcom power`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PowerSummary {
    pub plan: String,
    /// Checksum of study plan and settings with the pool's seed.
    pub digest: String,
    pub program: String,
    pub seed: u64,
    pub pool: u32,
    pub outcome: PrimaryOutcome,
    pub conditions: Vec<StudyArm>,
    /// Ratio of rates that was imposed on the drawn studies; null if the effect is that of the simulated arms.
    pub ratio: Option<f64>,
    pub sizes: Vec<SampleSizePower>,
    pub needed: Vec<RequiredSampleSize>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleSizePower {
    pub participants: usize,
    pub tests: Vec<TestPower>,
    /// Share of studies in which at least one contrast rejects after correction; null if there is only one contrast.
    pub any: Option<RejectionShare>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TestPower {
    #[serde(flatten)]
    pub test: PowerTest,
    #[serde(flatten)]
    pub found: RejectionShare,
    /// Least detectable effect: the ratio of rates closest to 1 that is found with a power of 0.8; null where it was
    /// not searched for, or no ratio is found with that power.
    pub least_ratio: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RequiredSampleSize {
    #[serde(flatten)]
    pub test: PowerTest,
    /// Least tried number from which on the power is at least 0.8; null if it is not reached.
    pub participants: Option<usize>,
    /// Least tried number from which on the lower end of the interval is at least 0.8; null likewise.
    pub surely: Option<usize>,
}

impl PowerSummary {
    pub fn new(header: &PoolHeader, effect: DrawnEffect, sizes: &[SampleSizeRejections]) -> PowerSummary {
        let tests = tests(&header.conditions);
        let sizes: Vec<SampleSizePower> =
            sizes.iter().map(|size| SampleSizePower::new(size, &tests, &header.conditions)).collect();
        let needed = |(index, test): (usize, &PowerTest)| {
            let from = |value: fn(&RejectionShare) -> f64| {
                let holds = sizes.iter().rev().take_while(|size| value(&size.tests[index].found) >= WANTED);
                holds.last().map(|size| size.participants)
            };
            RequiredSampleSize {
                test: *test,
                participants: from(|found| found.share),
                surely: from(|found| found.interval[0]),
            }
        };
        PowerSummary {
            plan: header.plan.clone(),
            digest: header.digest.clone(),
            program: header.program.clone(),
            seed: header.seed,
            pool: header.participants,
            outcome: header.aims.outcome,
            conditions: header.conditions.clone(),
            ratio: match effect {
                DrawnEffect::AsSimulated => None,
                DrawnEffect::Ratio(ratio) => Some(ratio),
            },
            needed: tests.iter().enumerate().map(needed).collect(),
            sizes,
        }
    }

    /// Whether the simulated effect is zero, so that each rejection of the null hypothesis is a type I error.
    pub fn is_null(&self) -> bool {
        self.ratio == Some(1.0)
    }
}

impl SampleSizePower {
    fn new(size: &SampleSizeRejections, tests: &[PowerTest], conditions: &[StudyArm]) -> SampleSizePower {
        let share = |index: usize| {
            let of_pools: Vec<RejectionCount> = size.of_pools.iter().map(|pool| pool[index]).collect();
            RejectionShare::new(size.counts[index], &of_pools)
        };
        let test_power = |(index, test): (usize, &PowerTest)| {
            let shares: Vec<f64> = size.of_ratios.iter().map(|counts| counts[index].share()).collect();
            // The ratio of rates is imposed between each arm and the reference arm, not between other arms.
            let is_put_in = test.against == reference(conditions) && !shares.is_empty();
            TestPower {
                test: *test,
                found: share(index),
                least_ratio: is_put_in.then(|| least_ratio(&shares)).flatten(),
            }
        };
        let contrasts = tests.iter().filter(|test| test.method == SignificanceTestMethod::LinearMixedModel).count();
        SampleSizePower {
            participants: size.participants,
            tests: tests.iter().enumerate().map(test_power).collect(),
            any: (contrasts > 1).then(|| share(tests.len())),
        }
    }
}

impl PowerTest {
    /// The statistical test as text: "wizard to unassisted, mixed ANOVA (the paper's test, secondary)".
    pub fn title(&self) -> String {
        let method = match self.method {
            SignificanceTestMethod::MixedAnova => "mixed ANOVA (the paper's test, secondary)",
            SignificanceTestMethod::LinearMixedModel => "linear mixed model (the plan's main comparison)",
        };
        format!("{} to {}, {method}", self.arm.title(), self.against.title())
    }
}

pub fn describe(found: &PowerSummary) -> String {
    let effect = match found.ratio {
        None => "the effect is that of the simulated conditions".to_string(),
        Some(1.0) => "no effect: all trials are unassisted, and conditions are exchanged within persons".to_string(),
        Some(ratio) => format!("the effect is put into unassisted trials: rates are {ratio} times as high"),
    };
    let studies = found.sizes.first().and_then(|size| size.tests.first()).map_or(0, |one| one.found.studies);
    let mut text = format!(
        "plan {} ({}), outcome: {} per press of the human; {} for each number of participants, drawn from {} (seed \
         {}); {effect}\n",
        found.plan,
        found.digest,
        found.outcome.title(),
        count(studies, "study", "studies"),
        count(found.pool, "simulated participant", "simulated participants"),
        found.seed,
    );
    // The plan's main comparison comes first.
    let mut in_order: Vec<(usize, &RequiredSampleSize)> = found.needed.iter().enumerate().collect();
    in_order.sort_by_key(|(_, needed)| needed.test.method == SignificanceTestMethod::MixedAnova);
    for (index, needed) in in_order {
        text += &describe_test(found, index);
        text += &if found.is_null() { error_in_words(found, index) } else { power_in_words(found, needed, index) };
    }
    if found.sizes.iter().any(|size| size.any.is_some()) {
        text += "at least one contrast of the linear mixed model, corrected for their number (Holm)\n";
        for size in &found.sizes {
            let Some(any) = size.any else { continue };
            text += &format!("  {:>3} participants {}\n", size.participants, in_numbers(&any));
        }
    }
    text += "Power is that of finding a difference, in either direction; that of showing a concept to be not worse than the wizard is not worked out.\n";
    text + "Participants are simulated: the answer is about them, and about people as far as they are like them.\n"
}

fn in_numbers(found: &RejectionShare) -> String {
    let [low, high] = found.interval;
    format!("{:.3} ({low:.3} to {high:.3})", found.share)
}

fn describe_test(found: &PowerSummary, index: usize) -> String {
    let what = if found.is_null() { "type I error" } else { "power" };
    let needed = &found.needed;
    let test = needed[index].test;
    let contrasts = needed.iter().filter(|other| other.test.method == SignificanceTestMethod::LinearMixedModel).count();
    let is_corrected = test.method == SignificanceTestMethod::LinearMixedModel && contrasts > 1;
    let corrected = if is_corrected { ", corrected for the number of contrasts (Holm)" } else { "" };
    let mut text = format!("{}{corrected}: {what} (interval of 95 % with the pool's error)\n", test.title());
    for size in &found.sizes {
        let one = &size.tests[index];
        let least = one.least_ratio.map_or(String::new(), |ratio| format!(", least effect: ratio {ratio:.2}"));
        let unknown = match one.found.unknown {
            0 => String::new(),
            unknown => format!(", {} could not be tested", count(unknown, "study", "studies")),
        };
        text += &format!("  {:>3} participants {}{least}{unknown}\n", size.participants, in_numbers(&one.found));
    }
    text
}

/// How many participants are needed, and which effect the middle one of the tried numbers detects.
fn power_in_words(found: &PowerSummary, needed: &RequiredSampleSize, index: usize) -> String {
    let largest = found.sizes.last().map_or(0, |size| size.participants);
    let mut text = match needed.participants {
        Some(enough) => {
            let sure = match needed.surely {
                Some(surely) if surely > enough => format!("; {surely} to be sure of it, as the pool is finite"),
                Some(_) => String::new(),
                None => "; the pool is too small to be sure of it".to_string(),
            };
            format!("  Of the numbers tried, {enough} is the least with a power of {WANTED}{sure}.")
        }
        None if found.sizes.last().is_some_and(|size| size.tests[index].found.interval[1] >= WANTED) => format!(
            "  The pool is too small to tell whether {largest} participants are enough for a power of {WANTED}."
        ),
        None => format!("  {largest} participants are not enough for a power of {WANTED}."),
    };
    let middle = found.sizes.get(found.sizes.len() / 2);
    if let Some((size, ratio)) = middle.and_then(|size| Some((size, size.tests[index].least_ratio?))) {
        text += &format!(
            " With {} participants, four of five studies find an effect that takes away {:.0} % of the {} or more (interpolated between \
             the effects tried).",
            size.participants,
            100.0 * (1.0 - ratio),
            found.outcome.title(),
        );
    }
    text + "\n"
}

fn error_in_words(found: &PowerSummary, index: usize) -> String {
    let shares = || found.sizes.iter().map(|size| size.tests[index].found.share);
    let [least, most] = [shares().fold(f64::INFINITY, f64::min), shares().fold(0.0, f64::max)];
    format!("  Without an effect the test finds one in {:.1} to {:.1} % of the studies.\n", 100.0 * least, 100.0 * most)
}

const BLOCK: u64 = 25;

#[derive(Clone, Debug, PartialEq)]
pub struct PowerRequest {
    pub sizes: Vec<usize>,
    pub studies: u64,
    pub effect: DrawnEffect,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Drawn {
    Pool,
    /// Studies are drawn from the bootstrap resample of the pool with this number, from 1.
    Resampled(u64),
    /// Studies are drawn from the pool, with the ratio of rates at this index.
    Ratio(usize),
}

#[derive(Clone, Debug)]
struct Block {
    size: usize,
    drawn: Drawn,
    numbers: Range<u64>,
}

/// Number of blocks of studies; [`measure`] calls `done` once for each block.
pub fn blocks(request: &PowerRequest, pool: &SimulationPool) -> u64 {
    all_blocks(request, pool).len() as u64
}

/// The least effect is searched for only with unassisted twins, which alone can have an effect of any size.
fn all_blocks(request: &PowerRequest, pool: &SimulationPool) -> Vec<Block> {
    let split =
        |studies: u64| (0..studies.div_ceil(BLOCK)).map(move |block| block * BLOCK..((block + 1) * BLOCK).min(studies));
    let tried = if pool.header.unassisted && request.effect != DrawnEffect::Ratio(1.0) { ratios().len() } else { 0 };
    let mut blocks = Vec::new();
    for &size in &request.sizes {
        let mut add = |drawn: Drawn, studies: u64| {
            blocks.extend(split(studies).map(|numbers| Block { size, drawn, numbers }));
        };
        add(Drawn::Pool, request.studies);
        (1..=POOLS).for_each(|number| add(Drawn::Resampled(number), STUDIES_OF_POOL));
        (0..tried).for_each(|index| add(Drawn::Ratio(index), STUDIES_OF_RATIO.min(request.studies)));
    }
    blocks
}

/// Draws the studies and computes the power. `path`: file of the pool, for messages; `done` is called after each block.
/// Errors: the pool has too few participants for an order of the conditions, or lacks the trials that the effect needs.
pub fn measure(
    request: &PowerRequest,
    pool: &SimulationPool,
    path: &Path,
    done: impl Fn() + Sync,
) -> FileResult<PowerSummary> {
    let header = &pool.header;
    let wrong = |found: String, remedy: &str| Err(FileError::from_finding(path, found, remedy.to_string()));
    match request.effect {
        DrawnEffect::AsSimulated if !header.arms => {
            return wrong(
                "a pool that has only unassisted trials".to_string(),
                "--effect RATIO, or a pool made without --null",
            );
        }
        DrawnEffect::Ratio(_) if !header.unassisted => {
            return wrong(
                "a pool without unassisted twins".to_string(),
                "a pool that tomcom power wrote, not tomcom arms",
            );
        }
        _ => {}
    }
    let source = match StudySampler::new(pool) {
        Ok(source) => source,
        Err(found) => return wrong(found, "a larger pool: two persons or more in every order of the conditions"),
    };
    let (tests, ratios) = (tests(&header.conditions), ratios());
    let blocks = all_blocks(request, pool);
    let counts = |block: &Block| {
        let count = |source: &StudySampler, effect: DrawnEffect| {
            count_rejections(source, &tests, block.size, effect, block.numbers.clone())
        };
        match block.drawn {
            Drawn::Pool => count(&source, request.effect),
            Drawn::Resampled(number) => count(&source.resampled(number), request.effect),
            Drawn::Ratio(index) => count(&source, DrawnEffect::Ratio(ratios[index])),
        }
    };
    let counted = parallel::each(&blocks, counts, done);
    let of_size = |&size: &usize| {
        let sum = |drawn: Drawn| {
            let own = blocks.iter().zip(&counted).filter(|(block, _)| block.size == size && block.drawn == drawn);
            own.fold(vec![RejectionCount::default(); tests.len() + 1], |sum, (_, counts)| {
                sum.into_iter().zip(counts).map(|(sum, one)| sum.plus(*one)).collect()
            })
        };
        let tried = blocks.iter().filter(|block| block.size == size);
        let tried = tried.filter_map(|block| match block.drawn {
            Drawn::Ratio(index) => Some(index + 1),
            _ => None,
        });
        SampleSizeRejections {
            participants: size,
            counts: sum(Drawn::Pool),
            of_pools: (1..=POOLS).map(|number| sum(Drawn::Resampled(number))).collect(),
            of_ratios: (0..tried.max().unwrap_or(0)).map(|index| sum(Drawn::Ratio(index))).collect(),
        }
    };
    let sizes: Vec<SampleSizeRejections> = request.sizes.iter().map(of_size).collect();
    Ok(PowerSummary::new(header, request.effect, &sizes))
}
