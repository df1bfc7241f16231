//! Quality of a binary detector in general: area under the ROC curve, and calibration of probabilities.

use serde::Serialize;

/// Area under the ROC curve from pairs (score, is positive): the share of pairs of a positive and a negative in which the positive
/// scores higher; ties count as half (mid-ranks; Hanley and McNeil 1982). `None` without positives or without negatives.
pub fn auc(scored: &[(f64, bool)]) -> Option<f64> {
    let mut sorted = scored.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let cases = sorted.iter().filter(|(_, case)| *case).count() as f64;
    let others = sorted.len() as f64 - cases;
    if cases == 0.0 || others == 0.0 {
        return None;
    }
    // Twice the number of ordered pairs, to stay with integers.
    let (mut twice, mut below) = (0.0, 0.0);
    for tied in sorted.chunk_by(|a, b| a.0 == b.0) {
        let tied_cases = tied.iter().filter(|(_, case)| *case).count() as f64;
        let tied_others = tied.len() as f64 - tied_cases;
        twice += tied_cases * (2.0 * below + tied_others);
        below += tied_others;
    }
    Some(twice / (2.0 * cases * others))
}

/// One bin of predicted probabilities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CalibrationBin {
    /// Number of predictions.
    pub n: u64,
    /// Mean prediction.
    pub predicted: f64,
    /// Share of predicted events that happened.
    pub observed: f64,
}

/// Calibration of predicted probabilities, in bins of equal width.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// The bins, in the order of the predicted probability.
    pub bins: Vec<CalibrationBin>,
    /// Expected calibration error: mean over predictions of the difference between predicted and observed in their bin (Naeini et al.
    /// 2015). `None` without predictions.
    pub ece: Option<f64>,
}

impl Calibration {
    /// The calibration of pairs (prediction, happened) whose prediction lies within `range`.
    pub fn from_predictions(
        predictions: impl IntoIterator<Item = (f64, bool)>,
        range: [f64; 2],
        bins: usize,
    ) -> Calibration {
        let mut sums = vec![(0u64, 0.0, 0u64); bins];
        let [from, to] = range;
        for (p, came_true) in predictions {
            if (from..=to).contains(&p) {
                let bin = ((p - from) / (to - from) * bins as f64) as usize;
                let sum = &mut sums[bin.min(bins - 1)];
                *sum = (sum.0 + 1, sum.1 + p, sum.2 + u64::from(came_true));
            }
        }
        let bin = |&(n, predicted, observed): &(u64, f64, u64)| {
            let count = n.max(1) as f64;
            CalibrationBin { n, predicted: predicted / count, observed: observed as f64 / count }
        };
        let bins: Vec<CalibrationBin> = sums.iter().map(bin).collect();
        let total: u64 = bins.iter().map(|bin| bin.n).sum();
        let off: f64 = bins.iter().map(|bin| bin.n as f64 * (bin.predicted - bin.observed).abs()).sum();
        Calibration { bins, ece: (total > 0).then(|| off / total as f64) }
    }
}
