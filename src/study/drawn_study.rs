//! Studies drawn from a pool of simulated participants: each participant is drawn with replacement, with all trials of
//! that participant.
//!
//! Two kinds of study are drawn. *As simulated*: participants are drawn within their order of arms, with what they did
//! in these arms. *With a ratio*: participants are drawn from the whole pool with what they did without signals, and
//! are assigned to the study's orders, so that arms are exchangeable within every participant; each event in an arm
//! other than the reference is then kept with a probability equal to the ratio (binomial thinning), and presses are not
//! changed. With the ratio 1, the null hypothesis holds exactly, even in a small pool.
//!
//! The random stream is named by size, pool and number of the study, not by the ratio: with a smaller ratio, the same
//! participants have a subset of the same events.

use rand::RngExt;
use serde::Serialize;

use crate::arm_comparison::{StudyArmTrial, arm_pairs, primary_contrasts};
use crate::pool::SimulationPool;
use crate::statistics::mixed_anova;
use tomcom_core::base::rng::{Stream, shuffle, stream};
use tomcom_session::plan::orders;
use tomcom_session::study_arm::StudyArm;

/// Drawing from a single participant would give no variance between participants.
const FEWEST: usize = 2;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnEffect {
    AsSimulated,
    /// Rate of events in every arm but the reference, relative to the unassisted rate: above 0, at most 1.
    Ratio(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum SignificanceTestMethod {
    /// The paper's test of two conditions: the interaction of period and starting group in a mixed ANOVA of rates.
    MixedAnova,
    /// Contrast of the linear mixed model of log rates, with Holm's correction.
    LinearMixedModel,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PowerTest {
    pub method: SignificanceTestMethod,
    pub arm: StudyArm,
    pub against: StudyArm,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignificanceTestResult {
    pub p: f64,
    /// Two-sided p value without the correction for several contrasts.
    pub p_uncorrected: f64,
}

/// The arm without signals, or else the first in the order of tables.
pub fn reference(conditions: &[StudyArm]) -> StudyArm {
    StudyArm::ALL.into_iter().find(|arm| conditions.contains(arm)).unwrap_or_default()
}

/// Tests of a study with these conditions, the primary test first. With two conditions of which one is unassisted: the
/// paper's test, then the contrast of the mixed model; otherwise the contrasts of the mixed model.
pub fn tests(conditions: &[StudyArm]) -> Vec<PowerTest> {
    let arms: Vec<StudyArm> = StudyArm::ALL.into_iter().filter(|arm| conditions.contains(arm)).collect();
    let test =
        |method: SignificanceTestMethod| move |(arm, against): (StudyArm, StudyArm)| PowerTest { method, arm, against };
    let both = arm_pairs(&arms);
    let papers = both.iter().copied().filter(|_| matches!(arms[..], [StudyArm::None, _]));
    papers
        .map(test(SignificanceTestMethod::MixedAnova))
        .chain(both.iter().copied().map(test(SignificanceTestMethod::LinearMixedModel)))
        .collect()
}

/// Results of these tests for one drawn study; `None` where a test cannot be computed.
pub fn results(tests: &[PowerTest], study: &[StudyArmTrial]) -> Vec<Option<SignificanceTestResult>> {
    let contrasts = primary_contrasts(study.to_vec());
    let result = |test: &PowerTest| match test.method {
        SignificanceTestMethod::MixedAnova => {
            let p = papers_p(study)?;
            Some(SignificanceTestResult { p, p_uncorrected: p })
        }
        SignificanceTestMethod::LinearMixedModel => {
            let one = contrasts.iter().find(|one| (one.arm, one.against) == (test.arm, test.against))?;
            Some(SignificanceTestResult { p: one.p_holm, p_uncorrected: one.contrast.p })
        }
    };
    tests.iter().map(result).map(|found| found.filter(|one| one.p.is_finite())).collect()
}

fn papers_p(study: &[StudyArmTrial]) -> Option<f64> {
    let rate = |trial: &StudyArmTrial| trial.events as f64 / trial.presses as f64;
    let row = |trials: &[StudyArmTrial]| match trials {
        [first, second] => Some((usize::from(second.arm != StudyArm::None), [rate(first), rate(second)])),
        _ => None,
    };
    let rows: Option<Vec<(usize, [f64; 2])>> = study.chunk_by(|a, b| a.participant == b.participant).map(row).collect();
    mixed_anova(&rows?).interaction.map(|test| test.p)
}

#[derive(Clone, Debug)]
pub struct StudySampler<'a> {
    pool: &'a SimulationPool,
    orders: Vec<Vec<StudyArm>>,
    by_order: Vec<Vec<usize>>,
    /// Number of the bootstrap resample of the pool; 0 is the pool itself.
    number: u64,
}

impl<'a> StudySampler<'a> {
    /// Errors: an order of the conditions has too few participants; the error says how many.
    pub fn new(pool: &'a SimulationPool) -> Result<StudySampler<'a>, String> {
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
        Ok(StudySampler { pool, orders, by_order, number: 0 })
    }

    /// Resample within the orders of arms, which shows the uncertainty due to the size of the pool.
    pub fn resampled(&self, number: u64) -> StudySampler<'a> {
        let mut random = stream(self.pool.header.seed, "resampled pool", number);
        let again = |persons: &Vec<usize>| persons.iter().map(|_| drawn(persons, &mut random)).collect();
        StudySampler { by_order: self.by_order.iter().map(again).collect(), number, ..self.clone() }
    }

    /// Study with the number `number` and `size` participants: one row per trial, ordered by participant and period.
    /// Orders of arms are as equally frequent as the size allows. Empty if the pool was not simulated for this effect.
    pub fn study(&self, size: usize, effect: DrawnEffect, number: u64) -> Vec<StudyArmTrial> {
        let name = format!("study of {size} from pool {}", self.number);
        let mut random = stream(self.pool.header.seed, &name, number);
        let mut places: Vec<usize> = (0..self.orders.len()).collect();
        shuffle(&mut places, &mut random);
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

    fn trial(
        &self,
        (participant, person): (usize, usize),
        (order, index): (usize, usize),
        effect: DrawnEffect,
        random: &mut Stream,
    ) -> Option<StudyArmTrial> {
        let (arm, trial) = (self.orders[order][index], &self.pool.persons[person].trials[index]);
        let header = &self.pool.header;
        let counts = match effect {
            DrawnEffect::AsSimulated => trial.own.as_ref()?,
            DrawnEffect::Ratio(_) => trial.unassisted.as_ref()?,
        };
        let all = counts.events(header.aims.outcome);
        let events = match effect {
            DrawnEffect::Ratio(ratio) => {
                // Random numbers are drawn for the reference arm too and discarded, so that all random streams stay in
                // step.
                let kept = (0..all).filter(|_| random.random::<f64>() < ratio).count() as u64;
                if arm == reference(&header.conditions) { all } else { kept }
            }
            DrawnEffect::AsSimulated => all,
        };
        Some(StudyArmTrial { participant, period: index as u32 + 1, arm, events, presses: counts.human_presses })
    }
}

fn drawn(persons: &[usize], random: &mut Stream) -> usize {
    persons[random.random_range(0..persons.len())]
}
