//! Studies drawn from a pool of simulated participants: whole persons, with replacement, each with all of its trials.
//!
//! Two kinds of study are drawn. *As simulated*: persons are drawn within their order of arms, with what they did in these arms. *With a
//! ratio*: persons are drawn from the whole pool with what they did without signals, and get the orders of the study, so that arms can be
//! exchanged within every person; then each event in an arm other than the reference is kept with the probability of the ratio (binomial
//! thinning), and presses stay. With the ratio 1 the null hypothesis holds exactly, also in a small pool.
//!
//! The random stream is named by size, pool and number of the study, not by the ratio: with a smaller ratio the same persons have the same
//! events or fewer.

use rand::RngExt;
use rand::seq::SliceRandom;
use serde::Serialize;

use super::arm_comparison::primary_contrasts;
use super::arm_design::{ArmTrial, pairs};
use super::simulation_pool::SimulationPool;
use super::statistics::mixed_anova;
use crate::base::rng::{Stream, stream};
use crate::session::plan::orders;
use crate::session::study_arm::StudyArm;

/// Least number of persons in each order of arms: from one alone a study has no differences between persons.
const FEWEST: usize = 2;

/// The effect in the studies that are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnEffect {
    /// What the arms did in the simulation.
    AsSimulated,
    /// Rate of events in every arm but the reference, as a share of the unassisted rate: above 0, at most 1.
    Ratio(f64),
}

/// How a test is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TestMethod {
    /// The paper's test of two conditions: mixed ANOVA of rates, interaction of period and starting group.
    MixedAnova,
    /// Contrast of the linear mixed model of log rates, with Holm's correction.
    LinearMixedModel,
}

/// A test of a study: of one arm against another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PowerTest {
    /// How it is computed.
    pub method: TestMethod,
    /// The arm.
    pub arm: StudyArm,
    /// The arm that it is compared with.
    pub against: StudyArm,
}

/// The result of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestResult {
    /// Two-sided p, corrected for the number of contrasts.
    pub p: f64,
    /// The same without the correction.
    pub p_uncorrected: f64,
}

/// The arm that all others are compared with: the one without signals, or else the first in the order of tables.
pub fn reference(conditions: &[StudyArm]) -> StudyArm {
    StudyArm::ALL.into_iter().find(|arm| conditions.contains(arm)).unwrap_or_default()
}

/// The tests of a study with these conditions, the primary one first: where one of two is unassisted, the paper's test, and the contrast
/// of the mixed model beside it; else the contrasts of the mixed model.
pub fn tests(conditions: &[StudyArm]) -> Vec<PowerTest> {
    let arms: Vec<StudyArm> = StudyArm::ALL.into_iter().filter(|arm| conditions.contains(arm)).collect();
    let test = |method: TestMethod| move |(arm, against): (StudyArm, StudyArm)| PowerTest { method, arm, against };
    let both = pairs(&arms);
    let papers = both.iter().copied().filter(|_| matches!(arms[..], [StudyArm::None, _]));
    papers
        .map(test(TestMethod::MixedAnova))
        .chain(both.iter().copied().map(test(TestMethod::LinearMixedModel)))
        .collect()
}

/// The results of these tests of a study; `None` where a test cannot be computed.
pub fn results(tests: &[PowerTest], study: &[ArmTrial]) -> Vec<Option<TestResult>> {
    let contrasts = primary_contrasts(study.to_vec());
    let result = |test: &PowerTest| match test.method {
        TestMethod::MixedAnova => {
            let p = papers_p(study)?;
            Some(TestResult { p, p_uncorrected: p })
        }
        TestMethod::LinearMixedModel => {
            let one = contrasts.iter().find(|one| (one.arm, one.against) == (test.arm, test.against))?;
            Some(TestResult { p: one.p_holm, p_uncorrected: one.contrast.p })
        }
    };
    tests.iter().map(result).map(|found| found.filter(|one| one.p.is_finite())).collect()
}

/// The p of the paper's test: persons have two trials, one of them unassisted.
fn papers_p(study: &[ArmTrial]) -> Option<f64> {
    let rate = |trial: &ArmTrial| trial.events as f64 / trial.presses as f64;
    let row = |trials: &[ArmTrial]| match trials {
        [first, second] => Some((usize::from(second.arm != StudyArm::None), [rate(first), rate(second)])),
        _ => None,
    };
    let rows: Option<Vec<(usize, [f64; 2])>> = study.chunk_by(|a, b| a.participant == b.participant).map(row).collect();
    mixed_anova(&rows?).interaction.map(|test| test.p)
}

/// The persons that studies are drawn from.
#[derive(Clone, Debug)]
pub struct StudySource<'a> {
    pool: &'a SimulationPool,
    /// The orders of arms of the plan's design.
    orders: Vec<Vec<StudyArm>>,
    /// Indices of persons, by order.
    by_order: Vec<Vec<usize>>,
    /// Number of the resampled pool; 0 is the pool itself.
    number: u64,
}

impl<'a> StudySource<'a> {
    /// The persons of a whole pool.
    ///
    /// # Errors
    /// An order of the conditions has too few persons: what was found.
    pub fn new(pool: &'a SimulationPool) -> Result<StudySource<'a>, String> {
        let conditions = &pool.header.conditions;
        let order = |order: &Vec<usize>| order.iter().map(|&index| conditions[index]).collect::<Vec<_>>();
        let orders: Vec<Vec<StudyArm>> = orders(conditions.len()).iter().map(order).collect();
        let has = |index: &usize, order: &[StudyArm]| {
            pool.persons[*index].trials.iter().map(|trial| trial.arm).eq(order.iter().copied())
        };
        let by_order: Vec<Vec<usize>> =
            orders.iter().map(|order| (0..pool.persons.len()).filter(|index| has(index, order)).collect()).collect();
        if let Some(index) = by_order.iter().position(|persons| persons.len() < FEWEST) {
            let names: Vec<&str> = orders[index].iter().map(|arm| arm.name()).collect();
            return Err(format!("{} in the order {}", by_order[index].len(), names.join(", ")));
        }
        Ok(StudySource { pool, orders, by_order, number: 0 })
    }

    /// A pool of as many persons drawn from this one within their orders, by which the error of the pool is found.
    pub fn resampled(&self, number: u64) -> StudySource<'a> {
        let mut random = stream(self.pool.header.seed, "resampled pool", number);
        let again = |persons: &Vec<usize>| persons.iter().map(|_| drawn(persons, &mut random)).collect();
        StudySource { by_order: self.by_order.iter().map(again).collect(), number, ..self.clone() }
    }

    /// Study `number` of so many participants: one row per trial, ordered by participant and period. Orders of arms are as equally frequent
    /// as the size allows. Empty where the pool was not simulated for this effect.
    pub fn study(&self, size: usize, effect: DrawnEffect, number: u64) -> Vec<ArmTrial> {
        let name = format!("study of {size} from pool {}", self.number);
        let mut random = stream(self.pool.header.seed, &name, number);
        let mut places: Vec<usize> = (0..self.orders.len()).collect();
        places.shuffle(&mut random);
        let all: Vec<usize> = self.by_order.iter().flatten().copied().collect();
        let mut study = Vec::with_capacity(size * self.orders[0].len());
        for participant in 0..size {
            let order = places[participant % places.len()];
            let person =
                drawn(if effect == DrawnEffect::AsSimulated { &self.by_order[order] } else { &all }, &mut random);
            for index in 0..self.orders[order].len() {
                study.extend(self.trial((participant, person), (order, index), effect, &mut random));
            }
        }
        study
    }

    /// The trial with this index of a participant who is this person, in this order of arms.
    fn trial(
        &self,
        (participant, person): (usize, usize),
        (order, index): (usize, usize),
        effect: DrawnEffect,
        random: &mut Stream,
    ) -> Option<ArmTrial> {
        let (arm, trial) = (self.orders[order][index], &self.pool.persons[person].trials[index]);
        let header = &self.pool.header;
        let counts = match effect {
            DrawnEffect::AsSimulated => trial.own.as_ref()?,
            DrawnEffect::Ratio(_) => trial.unassisted.as_ref()?,
        };
        let all = counts.events(header.aims.outcome);
        let events = match effect {
            DrawnEffect::Ratio(ratio) => {
                // Draws of the reference's events are discarded, so that all streams stay in step.
                let kept = (0..all).filter(|_| random.random::<f64>() < ratio).count() as u64;
                if arm == reference(&header.conditions) { all } else { kept }
            }
            DrawnEffect::AsSimulated => all,
        };
        Some(ArmTrial { participant, period: index as u32 + 1, arm, events, presses: counts.human_presses })
    }
}

/// One of these persons.
fn drawn(persons: &[usize], random: &mut Stream) -> usize {
    persons[random.random_range(0..persons.len())]
}
