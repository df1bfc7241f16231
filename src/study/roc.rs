//! How much communication concepts would have prevented in unassisted trials, and at what price: receiver operating
//! characteristics and comparison at equal interruptions (paper, "Concept comparisons").
//!
//! The unit is the press of the human. True positive rate: belief related errors prevented, of all. False positive rate: that of
//! the presses outside of episodes with at least one false signal before them. What is prevented and what is false says
//! [`super::prevention`].

use rand::RngExt;
use serde::Serialize;

use super::prevention::PreventionCounts;
use crate::base::rng::stream;
use crate::communication::concept::ConceptName;

/// The least cost of communication of the paper. Benefits below are estimated less carefully.
pub const LEAST_COST: f64 = 0.5;

/// Signals per 100 presses of the human at which concepts are compared.
pub const EQUAL_SIGNALS: [f64; 4] = [2.0, 4.0, 6.0, 8.0];
/// How often participants are drawn anew for a band.
const RESAMPLES: u32 = 1000;
/// A band is told at so many places of the common range.
const BAND_STEPS: usize = 40;
/// The share that a band covers.
const COVERED: f64 = 0.95;

/// The parameter of a concept that is swept: cost of communication, threshold, presses proposed. Beyond the paper's 0.5 to 2.4
/// and 0.4 to 0.99 there are some more values, so that the concepts can be compared where they say equally much.
pub fn parameters(concept: ConceptName) -> Vec<f64> {
    match concept {
        ConceptName::TomCom => {
            let costs = (2..=24).map(|tenth| f64::from(tenth) / 10.0);
            costs.chain([2.7, 3.0, 3.5, 4.0, 5.0]).collect()
        }
        ConceptName::Tom => {
            let thresholds = (8..=19).map(|step| f64::from(step) / 20.0);
            thresholds.chain([0.97, 0.99, 0.995, 0.998, 0.999, 0.9995]).collect()
        }
        ConceptName::Dev => (1..=5).map(f64::from).collect(),
        ConceptName::None => Vec::new(),
    }
}

/// The concepts that are compared.
pub const CONCEPTS: [ConceptName; 3] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev];

/// What a concept with one value of its parameter would have done in a trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweptTrial {
    pub concept: ConceptName,
    pub parameter: f64,
    pub count: PreventionCounts,
}

/// A point of a receiver operating characteristic.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RocPoint {
    pub parameter: f64,
    pub fpr: f64,
    pub tpr: f64,
    pub signals_per_100_actions: f64,
    #[serde(flatten)]
    pub count: PreventionCounts,
}

/// A value with the interval that the bootstrap over participants gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct BootstrapInterval {
    pub value: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// The receiver operating characteristic of a concept.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Roc {
    pub concept: ConceptName,
    /// The mean true positive rate over the false positive rates that all concepts reach: partial area by width of the range.
    pub auc: Option<f64>,
    pub auc_low: Option<f64>,
    pub auc_high: Option<f64>,
    pub points: Vec<RocPoint>,
    /// False positive rate, and the band of the true positive rate there.
    pub band: Vec<[f64; 3]>,
    /// True positive rates at [`EQUAL_SIGNALS`].
    pub at_equal_signals: Vec<BootstrapInterval>,
    /// By how much that of the first concept is higher.
    pub behind_first: Vec<BootstrapInterval>,
}

/// The comparison of concepts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ConceptComparison {
    /// Participants, and their unassisted trials.
    pub participants: u64,
    pub trials: u64,
    /// The largest false positive rate that all concepts reach.
    pub common_fpr: Option<f64>,
    pub concepts: Vec<Roc>,
}

/// One way of putting participants together: curves of each concept.
struct Curves {
    /// False positive rate against true positive rate, signals against true positive rate.
    of: Vec<[Vec<(f64, f64)>; 2]>,
}

/// The sum over participants of what each concept did, each counted so often.
fn summed(participants: &[Vec<SweptTrial>], times: &[u32]) -> Vec<SweptTrial> {
    let Some(first) = participants.first() else { return Vec::new() };
    let mut sum: Vec<SweptTrial> =
        first.iter().map(|one| SweptTrial { count: PreventionCounts::default(), ..*one }).collect();
    for (participant, &times) in participants.iter().zip(times) {
        for (sum, one) in sum.iter_mut().zip(participant) {
            for _ in 0..times {
                sum.count = sum.count.plus(&one.count);
            }
        }
    }
    sum
}

impl Curves {
    fn from_counts(sum: &[SweptTrial]) -> Curves {
        let curve = |concept: ConceptName, x: usize| {
            let points = sum.iter().filter(|one| one.concept == concept).filter_map(|one| one.count.point());
            // Saying nothing is always possible.
            let mut curve: Vec<(f64, f64)> = points.map(|point| (point[x], point[1])).chain([(0.0, 0.0)]).collect();
            curve.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
            curve
        };
        Curves { of: CONCEPTS.iter().map(|&concept| [curve(concept, 0), curve(concept, 2)]).collect() }
    }

    /// The largest false positive rate that all reach; none if one of them was never tried.
    fn common(&self) -> Option<f64> {
        let reach = |curve: &Vec<(f64, f64)>| curve.last().map(|last| last.0).filter(|_| curve.len() > 1);
        let reached: Option<Vec<f64>> = self.of.iter().map(|[curve, _]| reach(curve)).collect();
        reached?.into_iter().reduce(f64::min).filter(|&common| common > 0.0)
    }

    fn area(&self, concept: usize, to: f64) -> Option<f64> {
        area(&self.of[concept][0], to)
    }
}

/// The height of a curve at `x`, by straight lines between its points; none outside of them.
fn height(curve: &[(f64, f64)], x: f64) -> Option<f64> {
    let after = curve.iter().position(|point| point.0 >= x)?;
    let (x1, y1) = curve[after];
    if x1 == x {
        // Of several points above each other the highest.
        return curve[after..].iter().take_while(|point| point.0 == x).last().map(|point| point.1);
    }
    let (x0, y0) = *curve.get(after.checked_sub(1)?)?;
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// The mean height of a curve from 0 to `to`.
fn area(curve: &[(f64, f64)], to: f64) -> Option<f64> {
    let end = height(curve, to)?;
    let mut points: Vec<(f64, f64)> = curve.iter().copied().filter(|point| point.0 < to).collect();
    points.push((to, end));
    let area: f64 = points.windows(2).map(|pair| (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1) / 2.0).sum();
    (to > 0.0).then(|| area / to)
}

/// Compares the concepts; of each participant what every concept with every value of its parameter did in its trials, in the
/// same order for all. The bootstrap (Efron 1979; percentiles) draws participants, and follows from `seed`.
pub fn compare(participants: &[Vec<SweptTrial>], trials: u64, seed: u64) -> ConceptComparison {
    let once = vec![1; participants.len()];
    let sum = summed(participants, &once);
    if sum.is_empty() {
        return ConceptComparison::default();
    }
    let curves = Curves::from_counts(&sum);
    let common = curves.common();
    let resampled: Vec<Curves> =
        resamples(participants.len(), seed).map(|times| Curves::from_counts(&summed(participants, &times))).collect();
    let roc = |(index, &concept): (usize, &ConceptName)| {
        let of_concept = sum.iter().filter(|one| one.concept == concept);
        let point = |one: &SweptTrial| {
            let [fpr, tpr, signals_per_100_actions] = one.count.point()?;
            Some(RocPoint { parameter: one.parameter, fpr, tpr, signals_per_100_actions, count: one.count })
        };
        // Of those who are drawn over the range that they reach: none of theirs is as wide as that of all, in half of the draws.
        let area = banded(&curves, &resampled, |curves| curves.area(index, curves.common()?));
        let at = |signals: f64| move |curves: &Curves| height(&curves.of[index][1], signals);
        let behind = |signals: f64| {
            move |curves: &Curves| Some(height(&curves.of[0][1], signals)? - height(&curves.of[index][1], signals)?)
        };
        Roc {
            concept,
            auc: area.value,
            auc_low: area.low,
            auc_high: area.high,
            points: of_concept.filter_map(point).collect(),
            band: band(&curves, &resampled, index),
            at_equal_signals: EQUAL_SIGNALS.iter().map(|&s| banded(&curves, &resampled, at(s))).collect(),
            behind_first: EQUAL_SIGNALS.iter().map(|&s| banded(&curves, &resampled, behind(s))).collect(),
        }
    };
    ConceptComparison {
        participants: participants.len() as u64,
        trials,
        common_fpr: common,
        concepts: CONCEPTS.iter().enumerate().map(roc).collect(),
    }
}

/// How often each participant is drawn, again and again; never, of less than two.
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

/// A value of the curves, with the middle of what it is on those that were drawn.
fn banded(curves: &Curves, resampled: &[Curves], of: impl Fn(&Curves) -> Option<f64>) -> BootstrapInterval {
    let value = of(curves);
    let mut drawn: Vec<f64> = resampled.iter().filter_map(&of).collect();
    // Where many of them do not reach, the others say nothing about the rest.
    if value.is_none() || drawn.len() * 2 < resampled.len() || drawn.is_empty() {
        return BootstrapInterval { value, low: None, high: None };
    }
    drawn.sort_by(f64::total_cmp);
    let at = |share: f64| drawn[((drawn.len() - 1) as f64 * share).round() as usize];
    BootstrapInterval { value, low: Some(at((1.0 - COVERED) / 2.0)), high: Some(at((1.0 + COVERED) / 2.0)) }
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
