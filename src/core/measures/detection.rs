//! Quality of a binary detector: area under the ROC curve, and calibration of probabilities.

use serde::Serialize;

/// Area under the ROC curve from pairs (score, is positive): the share of pairs of a positive and a negative in which
/// the positive scores higher; a tie of the scores counts as half (mid-ranks; Hanley and McNeil 1982). `None` without
/// positives or without negatives.
pub fn auc(scored: &[(f64, bool)]) -> Option<f64> {
    let alike: Vec<(f64, bool, f64)> = scored.iter().map(|&(score, case)| (score, case, 1.0)).collect();
    weighted_auc(&alike)
}

/// Area under the ROC curve from triples (score, is positive, weight), where a pair of a positive and a negative weighs
/// the product of both weights.
pub fn weighted_auc(scored: &[(f64, bool, f64)]) -> Option<f64> {
    let mut sorted = scored.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let weights = |of: &[(f64, bool, f64)], is_case: bool| -> f64 {
        of.iter().filter(|one| one.1 == is_case).map(|one| one.2).sum()
    };
    let (cases, others) = (weights(&sorted, true), weights(&sorted, false));
    if cases == 0.0 || others == 0.0 {
        return None;
    }
    // Twice the weight of correctly ordered pairs, so that without weights the number is an integer.
    let (mut twice, mut below) = (0.0, 0.0);
    for tied in sorted.chunk_by(|a, b| a.0 == b.0) {
        let tied_others = weights(tied, false);
        twice += weights(tied, true) * (2.0 * below + tied_others);
        below += tied_others;
    }
    Some(twice / (2.0 * cases * others))
}

/// One bin of predicted probabilities, compared with the observed frequency.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CalibrationBin {
    /// Number of predictions in the calibration bin.
    pub n: u64,
    /// Mean predicted probability of the predictions in the bin.
    pub predicted: f64,
    /// Share of the bin's predicted events that happened.
    pub observed: f64,
}

/// Calibration of predicted probabilities, in bins of equal width.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// The calibration bins, in the order of the predicted probability.
    pub bins: Vec<CalibrationBin>,
    /// Expected calibration error: mean over all predictions of the difference between predicted and observed frequency
    /// in the prediction's bin (Naeini et al. 2015). `None` without predictions.
    pub ece: Option<f64>,
}

impl Calibration {
    /// The calibration of pairs (prediction, happened) whose prediction lies within `range`.
    pub fn from_predictions(
        predictions: impl IntoIterator<Item = (f64, bool)>,
        range: [f64; 2],
        bins: usize,
    ) -> Calibration {
        let alike = predictions.into_iter().map(|(p, came_true)| (p, came_true, 1.0));
        Calibration::from_weighted(alike, range, bins)
    }

    /// The calibration of triples (prediction, happened, weight): means and shares of a bin, and the mean over bins,
    /// are weighted.
    pub fn from_weighted(
        predictions: impl IntoIterator<Item = (f64, bool, f64)>,
        range: [f64; 2],
        bins: usize,
    ) -> Calibration {
        #[derive(Clone, Copy, Default)]
        struct Sum {
            n: u64,
            weight: f64,
            predicted: f64,
            came_true: f64,
        }
        let mut sums = vec![Sum::default(); bins];
        let [from, to] = range;
        for (p, came_true, weight) in predictions {
            if (from..=to).contains(&p) {
                let bin = ((p - from) / (to - from) * bins as f64) as usize;
                let sum = &mut sums[bin.min(bins - 1)];
                sum.n += 1;
                sum.weight += weight;
                sum.predicted += weight * p;
                sum.came_true += if came_true { weight } else { 0.0 };
            }
        }
        let bin = |sum: &Sum| {
            let whole = if sum.n == 0 { 1.0 } else { sum.weight };
            CalibrationBin { n: sum.n, predicted: sum.predicted / whole, observed: sum.came_true / whole }
        };
        let bins: Vec<CalibrationBin> = sums.iter().map(bin).collect();
        let total: f64 = sums.iter().map(|sum| sum.weight).sum();
        let off = sums.iter().zip(&bins).map(|(sum, bin)| sum.weight * (bin.predicted - bin.observed).abs());
        let off: f64 = off.sum();
        Calibration { bins, ece: (total > 0.0).then(|| off / total) }
    }
}
