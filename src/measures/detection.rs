//! How well a score tells cases from others: the area under the ROC, thresholds, and how well probabilities are
//! calibrated. Nothing here knows what the cases are.

use serde::Serialize;

/// The area under the ROC curve of a score over (score, is a case): the share of pairs of a case and another one in which
/// the case scores higher; equal scores count as half (mid-ranks; Hanley and McNeil 1982). `None` if there are no cases,
/// or nothing else.
pub fn auc(scored: &[(f64, bool)]) -> Option<f64> {
    let mut sorted = scored.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let cases = sorted.iter().filter(|(_, case)| *case).count() as f64;
    let others = sorted.len() as f64 - cases;
    if cases == 0.0 || others == 0.0 {
        return None;
    }
    // Twice the number of pairs that are in order, so that it is a whole number.
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
    /// Predictions in it.
    pub n: u64,
    /// Their mean.
    pub predicted: f64,
    /// The share of them that came true.
    pub observed: f64,
}

/// Predicted probabilities against what came true, in bins of equal width.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    pub bins: Vec<CalibrationBin>,
    /// Expected calibration error: the mean over the predictions of what their bin's mean is off (Naeini et al. 2015).
    /// `None` without predictions.
    pub ece: Option<f64>,
}

impl Calibration {
    /// Of those (prediction, came true) whose prediction is within `range`, in so many bins.
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
