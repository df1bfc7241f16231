//! Receiver operating characteristics (ROC) of communication concepts in unassisted trials, and their comparison at
//! equal numbers of signals (paper, "Concept comparisons").
//!
//! The unit of the rates is the human press. True positive rate: share of the errors from false beliefs that are
//! prevented. False positive rate: useless signals per human press. [`super::prevention`] defines prevented errors and
//! useless signals. Signals are counted as interruptions: a proposal of k presses is one.

use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::prevention::{PreventionCounts, PreventionRates};
use crate::statistics::percentiles;
use tomcom_core::base::rng::stream;
use tomcom_core::communication::concept::ConceptName;

/// Smallest cost of communication in the paper, in presses. The planner is less accurate for smaller benefits.
pub(crate) const LEAST_COST: f64 = 0.5;

/// Signals per 100 human presses at which concepts are compared.
pub(crate) const EQUAL_SIGNALS: [f64; 4] = [2.0, 4.0, 6.0, 8.0];
const RESAMPLES: u32 = 1000;
/// Number of points of a confidence band over the range of false positive rates that all concepts reach.
const BAND_STEPS: usize = 40;
const COVERED: f64 = 0.95;

/// Values that are tried for a concept's parameter: cost of communication, threshold, or number of proposed presses.
/// Thresholds and numbers are the paper's, 0.4 to 0.99 and 1 to 5. Costs extend beyond the paper's 0.5 to 2.4, so that
/// ToM-Com covers the compared numbers of signals.
pub fn parameters(concept: ConceptName) -> Vec<f64> {
    match concept {
        ConceptName::TomCom => {
            let costs = (2..=24).map(|tenth| f64::from(tenth) / 10.0);
            costs.chain([2.7, 3.0, 3.5, 4.0, 5.0]).collect()
        }
        ConceptName::Tom => {
            let thresholds = (8..=19).map(|step| f64::from(step) / 20.0);
            thresholds.chain([0.97, 0.99]).collect()
        }
        ConceptName::Dev => (1..=5).map(f64::from).collect(),
        // What an external concept sends does not follow from a parameter.
        ConceptName::None | ConceptName::External => Vec::new(),
    }
}

pub(crate) const CONCEPTS: [ConceptName; 3] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev];

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RocPoint {
    pub parameter: f64,
    /// False positive rate: useless signals per press of the human.
    pub fpr: f64,
    /// True positive rate: share of the errors from false beliefs that would have been prevented.
    pub tpr: f64,
    pub signals_per_100_actions: f64,
    pub useless_per_100_actions: f64,
    /// Share of useless signals among all signals; null without signals.
    pub useless_share: Option<f64>,
    #[serde(flatten)]
    pub count: PreventionCounts,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BootstrapInterval {
    /// The statistic's value; null where it cannot be computed.
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConceptRocCurve {
    pub concept: ConceptName,
    /// Mean true positive rate over the false positive rates that all concepts reach.
    pub auc: Option<f64>,
    pub auc_low: Option<f64>,
    pub auc_high: Option<f64>,
    pub points: Vec<RocPoint>,
    /// Confidence band of the curve, as false positive rate with lower and upper true positive rate.
    pub band: Vec<[f64; 3]>,
    pub at_equal_signals: Vec<BootstrapInterval>,
    pub useless_at_equal_signals: Vec<BootstrapInterval>,
    /// True positive rate of the first concept minus this one's, at `EQUAL_SIGNALS`.
    pub behind_first: Vec<BootstrapInterval>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ConceptComparison {
    pub participants: u64,
    pub trials: u64,
    /// Largest false positive rate that all compared concepts reach.
    pub common_fpr: Option<f64>,
    pub concepts: Vec<ConceptRocCurve>,
}

/// Curves of all concepts for one bootstrap sample of participants.
struct Curves {
    /// By concept: tpr by fpr; tpr by signals, and useless signals by signals, both per 100 human presses.
    of: Vec<[Vec<(f64, f64)>; 3]>,
}

impl Curves {
    fn from_counts(sum: &[ConceptPreventionCounts]) -> Curves {
        let curve = |concept: ConceptName, point: fn(&PreventionRates) -> (f64, f64)| {
            let points = sum.iter().filter(|one| one.concept == concept).filter_map(|one| one.count.rates());
            // A concept that sends no signals is at the point (0, 0), where every ROC curve begins.
            let mut curve: Vec<(f64, f64)> = points.map(|rates| point(&rates)).chain([(0.0, 0.0)]).collect();
            curve.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            curve
        };
        let curves = |&concept: &ConceptName| {
            [
                curve(concept, |rates| (rates.fpr, rates.tpr)),
                curve(concept, |rates| (rates.signals_per_100, rates.tpr)),
                curve(concept, |rates| (rates.signals_per_100, 100.0 * rates.fpr)),
            ]
        };
        Curves { of: CONCEPTS.iter().map(curves).collect() }
    }

    /// Largest false positive rate that all concepts reach; `None` if a concept's curve has no points.
    fn common(&self) -> Option<f64> {
        let reach = |curve: &Vec<(f64, f64)>| curve.last().map(|last| last.0).filter(|_| curve.len() > 1);
        let reached: Option<Vec<f64>> = self.of.iter().map(|[curve, ..]| reach(curve)).collect();
        reached?.into_iter().reduce(f64::min).filter(|&common| common > 0.0)
    }
}

/// What is read off the curves at equal numbers of signals.
pub const INTERPOLATED: &str =
    "Values between the points of a curve, and between its sparsest point and no signals, are interpolated.";

/// Height of a curve at `x` by linear interpolation; `None` outside of the curve's range of x.
fn height(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = curve.iter().position(|point| point.0 >= x)?;
    let (x1, y1) = curve[after];
    if x1 == x {
        // If several points have the same x, the highest of them is taken.
        return curve[after..].iter().take_while(|point| point.0 == x).last().map(|point| point.1);
    }
    let (x0, y0) = *curve.get(after.checked_sub(1)?)?;
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// Mean height of a curve over x from 0 to `to`.
fn mean_height(curve: &[(f64, f64)], to: f64) -> Option<f64> {
    let end = height(curve, to)?;
    let mut points: Vec<(f64, f64)> = curve.iter().copied().filter(|point| point.0 < to).collect();
    points.push((to, end));
    let area: f64 = points.windows(2).map(|pair| (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1) / 2.0).sum();
    (to > 0.0).then(|| area / to)
}

/// Compares the communication concepts by their counts over the unassisted trials of a study. The percentile bootstrap
/// (Efron 1979) resamples participants; its random stream is seeded by `seed`.
pub fn compare(totals: &ConceptTotals, seed: u64) -> ConceptComparison {
    let sum = &totals.sum;
    if sum.is_empty() {
        return ConceptComparison::default();
    }
    let curves = Curves::from_counts(sum);
    let common = curves.common();
    let participants = totals.participants.len();
    let resampled: Vec<Curves> =
        resamples(participants, seed).map(|times| Curves::from_counts(&totals.resampled(&times))).collect();
    let roc = |(index, &concept): (usize, &ConceptName)| {
        let of_concept = sum.iter().filter(|one| one.concept == concept);
        let point = |one: &ConceptPreventionCounts| {
            let PreventionRates { fpr, tpr, signals_per_100 } = one.count.rates()?;
            Some(RocPoint {
                parameter: one.parameter,
                fpr,
                tpr,
                signals_per_100_actions: signals_per_100,
                useless_per_100_actions: 100.0 * fpr,
                useless_share: one.count.useless_share(),
                count: one.count,
            })
        };
        // Each resample is integrated over its own common range, because many resamples do not reach the full sample's
        // range.
        let area = banded(&curves, &resampled, |curves| mean_height(&curves.of[index][0], curves.common()?));
        let at = |signals: f64| move |curves: &Curves| height(&curves.of[index][1], signals);
        let useless = |signals: f64| move |curves: &Curves| Some(height(&curves.of[index][2], signals)? / signals);
        let behind = |signals: f64| {
            move |curves: &Curves| Some(height(&curves.of[0][1], signals)? - height(&curves.of[index][1], signals)?)
        };
        ConceptRocCurve {
            concept,
            auc: area.value,
            auc_low: area.low,
            auc_high: area.high,
            points: of_concept.filter_map(point).collect(),
            band: band(&curves, &resampled, index),
            at_equal_signals: EQUAL_SIGNALS.iter().map(|&s| banded(&curves, &resampled, at(s))).collect(),
            useless_at_equal_signals: EQUAL_SIGNALS.iter().map(|&s| banded(&curves, &resampled, useless(s))).collect(),
            behind_first: EQUAL_SIGNALS.iter().map(|&s| banded(&curves, &resampled, behind(s))).collect(),
        }
    };
    ConceptComparison {
        participants: participants as u64,
        trials: totals.trials,
        common_fpr: common,
        concepts: CONCEPTS.iter().enumerate().map(roc).collect(),
    }
}

/// Number of draws of each participant in each bootstrap resample; no resamples with fewer than two participants.
fn resamples(participants: usize, seed: u64) -> impl Iterator<Item = Vec<u32>> {
    let mut random = stream(seed, "bootstrap", 0);
    let number = if participants < 2 { 0 } else { RESAMPLES };
    (0..number).map(move |_| {
        let mut times = vec![0; participants];
        for _ in 0..participants {
            times[random.random_range(0..participants)] += 1;
        }
        times
    })
}

fn banded(curves: &Curves, resampled: &[Curves], of: impl Fn(&Curves) -> Option<f64>) -> BootstrapInterval {
    let value = of(curves);
    let drawn: Vec<f64> = resampled.iter().filter_map(&of).collect();
    // If fewer than half of the resamples have a value, an interval from them would be biased.
    if value.is_none() || drawn.len() * 2 < resampled.len() || drawn.is_empty() {
        return BootstrapInterval { value, low: None, high: None };
    }
    let [low, high] = percentiles(drawn, [(1.0 - COVERED) / 2.0, (1.0 + COVERED) / 2.0]);
    BootstrapInterval { value, low: Some(low), high: Some(high) }
}

fn band(curves: &Curves, resampled: &[Curves], concept: usize) -> Vec<[f64; 3]> {
    let Some(end) = curves.of[concept][0].last().map(|last| last.0) else { return Vec::new() };
    let at = |step: usize| {
        let x = end * step as f64 / BAND_STEPS as f64;
        let found = banded(curves, resampled, |curves| height(&curves.of[concept][0], x));
        Some([x, found.low?, found.high?])
    };
    (0..=BAND_STEPS).filter_map(at).collect()
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConceptPreventionCounts {
    pub concept: ConceptName,
    pub parameter: f64,
    pub count: PreventionCounts,
}

/// Prevention counts of every concept and parameter value, over all unassisted trials and for each participant, as the
/// bootstrap needs them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConceptTotals {
    trials: u64,
    sum: Vec<ConceptPreventionCounts>,
    /// For each participant, the counts in the order of `sum`.
    participants: Vec<Vec<PreventionCounts>>,
    last: Option<String>,
}

impl ConceptTotals {
    /// Adds the counts of an unassisted trial of this participant, for the same concepts and parameter values in every
    /// trial. The trials of a participant must be added one after another.
    pub fn add(&mut self, participant: &str, swept: &[ConceptPreventionCounts]) {
        if self.sum.is_empty() {
            self.sum = emptied(swept);
        }
        if self.last.as_deref() != Some(participant) {
            self.last = Some(participant.to_string());
            self.participants.push(vec![PreventionCounts::default(); self.sum.len()]);
        }
        self.trials += 1;
        let of_one = self.participants.last_mut().into_iter().flatten();
        for ((sum, own), one) in self.sum.iter_mut().zip(of_one).zip(swept) {
            sum.count = sum.count.plus(&one.count);
            *own = own.plus(&one.count);
        }
    }

    /// Each participant counts as often as `times` says.
    fn resampled(&self, times: &[u32]) -> Vec<ConceptPreventionCounts> {
        let mut sum = emptied(&self.sum);
        for (participant, &times) in self.participants.iter().zip(times) {
            for (sum, one) in sum.iter_mut().zip(participant) {
                (0..times).for_each(|_| sum.count = sum.count.plus(one));
            }
        }
        sum
    }
}

fn emptied(counts: &[ConceptPreventionCounts]) -> Vec<ConceptPreventionCounts> {
    let count = PreventionCounts { harmless: Some(0), ..PreventionCounts::default() };
    counts.iter().map(|one| ConceptPreventionCounts { count, ..*one }).collect()
}
