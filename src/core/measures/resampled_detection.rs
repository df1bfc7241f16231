//! Detection of false beliefs in resampled trials: areas under the ROC curves and calibration error where each trial
//! counts several times or not at all, as a bootstrap over trials needs it.

use super::belief_detection::{
    BeliefsBeforePress, CALIBRATED, CALIBRATION_BINS, Score, TrialBeliefs, aspect_groups, scored,
};
use super::detection::{Calibration, weighted_auc};
use crate::kitchen::Kitchen;

/// Areas under the ROC curves and calibration error of one resample; `None` where a resample has no false belief, or
/// only false ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResampledDetection {
    /// Area under the ROC curve over the aspects that are locations.
    pub auc_locations: Option<f64>,
    /// Area under the ROC curve over the aspects that are recipes.
    pub auc_recipes: Option<f64>,
    /// Expected calibration error of the predicted probabilities of a false belief.
    pub ece: Option<f64>,
}

/// Equal scores or predictions of one trial.
#[derive(Clone, Copy, Debug)]
struct EqualScores {
    score: f64,
    is_wrong: bool,
    trial: usize,
    count: f64,
}

/// Scores and predictions of trials, sorted once for all resamples.
#[derive(Clone, Debug)]
pub struct DetectionScores {
    groups: [Vec<EqualScores>; 2],
    predictions: Vec<EqualScores>,
}

impl DetectionScores {
    /// Scores and predictions before every press of these trials whose beliefs and estimates are known.
    pub fn from_trials(kitchen: &Kitchen, trials: &[TrialBeliefs]) -> DetectionScores {
        let predicted = BeliefsBeforePress::p_false;
        let all: Vec<usize> = (0..kitchen.aspects.len()).collect();
        let mut predictions = equal_scores(trials, &all, &predicted);
        predictions.retain(|one| (CALIBRATED[0]..=CALIBRATED[1]).contains(&one.score));
        let groups = aspect_groups(kitchen).map(|group| equal_scores(trials, &group, &predicted));
        DetectionScores { groups, predictions }
    }

    /// The measures where the trial with index i occurs `times[i]` times.
    pub fn resampled(&self, times: &[f64]) -> ResampledDetection {
        let weigh = |one: &EqualScores| {
            let weight = one.count * times[one.trial];
            (weight > 0.0).then_some((one.score, one.is_wrong, weight))
        };
        let area = |group: &[EqualScores]| {
            let weighted: Vec<(f64, bool, f64)> = group.iter().filter_map(weigh).collect();
            weighted_auc(&weighted)
        };
        let predictions = self.predictions.iter().filter_map(weigh);
        ResampledDetection {
            auc_locations: area(&self.groups[0]),
            auc_recipes: area(&self.groups[1]),
            ece: Calibration::from_weighted(predictions, CALIBRATED, CALIBRATION_BINS).ece,
        }
    }
}

/// The scores of these aspects before every press, with equal scores of a trial counted, in ascending order.
fn equal_scores(trials: &[TrialBeliefs], aspects: &[usize], score: Score) -> Vec<EqualScores> {
    let mut all = Vec::new();
    for (trial, presses) in trials.iter().enumerate() {
        let mut own = scored(std::slice::from_ref(presses), aspects, score);
        own.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.extend(own.chunk_by(|a, b| a == b).map(|alike| {
            let (score, is_wrong) = alike[0];
            EqualScores { score, is_wrong, trial, count: alike.len() as f64 }
        }));
    }
    all.sort_by(|a, b| a.score.total_cmp(&b.score));
    all
}
