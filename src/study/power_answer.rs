//! Output of `tomcom power`: the power of each test and the least effect that each test detects, for each number of
//! participants, and the number of participants needed.

use serde::Serialize;

use super::drawn_study::{DrawnEffect, PowerTest, SignificanceTestMethod, reference, tests};
use super::power::{RejectionCount, RejectionShare, WANTED, least_ratio};
use super::simulation_pool::PoolHeader;
use tomcom_core::base::text::count;
use tomcom_session::plan::PrimaryOutcome;
use tomcom_session::study_arm::StudyArm;

/// Counts of rejections for one number of participants; each list has an entry per test and a last entry for any of the
/// contrasts.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleSizeRejections {
    /// Number of participants of the drawn studies.
    pub participants: usize,
    /// Counts of rejections over studies drawn from the pool.
    pub counts: Vec<RejectionCount>,
    /// Counts of rejections over studies drawn from each resampled pool.
    pub of_pools: Vec<Vec<RejectionCount>>,
    /// Counts of rejections over studies with each tried ratio of rates, the weakest effect first; empty if the least
    /// effect was not searched for.
    pub of_ratios: Vec<Vec<RejectionCount>>,
}

/// Power of a study for several numbers of participants: the output of `tomcom power`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PowerSummary {
    /// Name of the study plan.
    pub plan: String,
    /// Checksum of study plan and settings with the pool's seed.
    pub digest: String,
    /// Version of the program that simulated the pool.
    pub program: String,
    /// Seed of the pool's simulation and of the drawn studies.
    pub seed: u64,
    /// Number of simulated participants in the pool.
    pub pool: u32,
    /// Primary outcome whose rates are compared.
    pub outcome: PrimaryOutcome,
    /// The conditions (study arms) of the plan.
    pub conditions: Vec<StudyArm>,
    /// Ratio of rates that was imposed on the drawn studies; null if the effect is that of the simulated arms.
    pub ratio: Option<f64>,
    /// Power of the tests for each number of participants.
    pub sizes: Vec<SampleSizePower>,
    /// Number of participants that each test needs.
    pub needed: Vec<RequiredSampleSize>,
}

/// Power of all tests for one number of participants.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleSizePower {
    /// Number of participants of the drawn studies.
    pub participants: usize,
    /// Power of each test; the primary test is the first.
    pub tests: Vec<TestPower>,
    /// Share of studies in which at least one contrast rejects after correction; null if there is only one contrast.
    pub any: Option<RejectionShare>,
}

/// Power of one statistical test for one number of participants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TestPower {
    /// Statistical test whose power is given.
    #[serde(flatten)]
    pub test: PowerTest,
    /// Share of drawn studies in which the test finds an effect.
    #[serde(flatten)]
    pub found: RejectionShare,
    /// Least detectable effect: the ratio of rates closest to 1 that is found with a power of 0.8; null where it was
    /// not searched for, or no ratio is found with that power.
    pub least_ratio: Option<f64>,
}

/// Number of participants that a test needs for a power of 0.8.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RequiredSampleSize {
    /// Statistical test that needs this number of participants.
    #[serde(flatten)]
    pub test: PowerTest,
    /// Least of the tried numbers of participants from which on the power is at least 0.8; null if the power is not
    /// reached.
    pub participants: Option<usize>,
    /// Least of the tried numbers of participants from which on the lower end of the power's interval is at least 0.8;
    /// null if that is not reached.
    pub surely: Option<usize>,
}

impl PowerSummary {
    /// The summary of power from the counts for each number of participants, the least number first.
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
    /// The statistical test as text: "wizard to none, mixed ANOVA (the paper's test)".
    pub fn title(&self) -> String {
        let method = match self.method {
            SignificanceTestMethod::MixedAnova => "mixed ANOVA (the paper's test)",
            SignificanceTestMethod::LinearMixedModel => "linear mixed model",
        };
        format!("{} to {}, {method}", self.arm.name(), self.against.name())
    }
}

/// The power of a study as text, with a table for each test.
pub fn describe(found: &PowerSummary) -> String {
    let effect = match found.ratio {
        None => "the effect is that of the simulated conditions".to_string(),
        Some(1.0) => "no effect: all trials are unassisted, and conditions are exchanged within persons".to_string(),
        Some(ratio) => format!("the effect is put into unassisted trials: rates are {ratio} times as high"),
    };
    let studies = found.sizes.first().and_then(|size| size.tests.first()).map_or(0, |one| one.found.studies);
    let mut text = format!(
        "plan {} ({}), outcome: {} per press of the participant; {} for each number of participants, drawn from {} (seed \
         {}); {effect}\n",
        found.plan,
        found.digest,
        found.outcome.title(),
        count(studies, "study", "studies"),
        count(found.pool, "simulated participant", "simulated participants"),
        found.seed,
    );
    for (index, needed) in found.needed.iter().enumerate() {
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
    let mut text = format!("{}: {what} (interval of 95 % with the pool's error)\n", found.needed[index].test.title());
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

/// Sentences on how many participants are needed, and on the effect that the middle one of the tried numbers of
/// participants detects.
fn power_in_words(found: &PowerSummary, needed: &RequiredSampleSize, index: usize) -> String {
    let largest = found.sizes.last().map_or(0, |size| size.participants);
    let mut text = match (needed.participants, needed.surely) {
        (Some(enough), Some(surely)) if surely > enough => {
            format!(
                "  {enough} participants are needed for a power of {WANTED}; {surely} to be sure of it, as the pool is finite."
            )
        }
        (Some(enough), Some(_)) => format!("  {enough} participants are needed for a power of {WANTED}."),
        (Some(enough), None) => {
            format!(
                "  {enough} participants are needed for a power of {WANTED}; the pool is too small to be sure of it."
            )
        }
        (None, _) if found.sizes.last().is_some_and(|size| size.tests[index].found.interval[1] >= WANTED) => {
            format!(
                "  The pool is too small to tell whether {largest} participants are enough for a power of {WANTED}."
            )
        }
        (None, _) => format!("  {largest} participants are not enough for a power of {WANTED}."),
    };
    let middle = found.sizes.get(found.sizes.len() / 2);
    if let Some((size, ratio)) = middle.and_then(|size| Some((size, size.tests[index].least_ratio?))) {
        text += &format!(
            " With {} participants, four of five studies find an effect that takes away {:.0} % of the {} or more.",
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
