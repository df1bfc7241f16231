//! Detection of false beliefs by an estimate, compared with known beliefs: the beliefs that simulated participants
//! record before each press.
//!
//! The unit is a press of the human, with the estimate right before the press. A belief about an aspect is false if the
//! participant's own P(truth) is below 0.5. The area under the ROC curve of a group (locations, recipes) is computed
//! over all pairs of a press and an aspect of the group together: the score has to distinguish an aspect that is
//! believed wrong now both from the other aspects and from the same aspect at other times. The score of the estimate is
//! the predicted probability of a false belief: that the participant's P(truth) is below 0.5. The macro-average is the
//! mean of the two groups, so that the many pairs of one group do not hide the other group. Calibration judges the same
//! probability, not the expected probability of wrong values. The mean over single aspects is reported as well; this
//! mean depends much on aspects that are hardly ever wrong.

use serde::Serialize;

use super::detection::{Calibration, auc};
use super::flags::{AspectGroups, FlagPerformance, ThresholdChoice};
pub use super::press_view::{BeliefsBeforePress, EstimateBeforePress, TrialBeliefs};
use crate::kitchen::{AspectKind, Kitchen};

/// Calibration uses only predicted probabilities within this range, since the beliefs about most aspects are obviously
/// right most of the time.
pub const CALIBRATED: [f64; 2] = [0.05, 0.95];
/// Number of calibration bins.
pub const CALIBRATION_BINS: usize = 10;

/// Area under the ROC curve of one aspect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AspectAuc {
    /// Name of the state aspect.
    pub aspect: String,
    /// Area under the ROC curve; null if the belief about the aspect was never or always false.
    pub auc: Option<f64>,
    /// Share of presses before which the belief about the aspect was false.
    pub wrong: f64,
}

/// Measures of how well an estimate detects false beliefs; values are null without an estimate or without known
/// beliefs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FalseBeliefDetection {
    /// Mean of the areas under the ROC curves of locations and recipes.
    pub auc: Option<f64>,
    /// Area under the ROC curve over the aspects that are locations.
    pub auc_locations: Option<f64>,
    /// Area under the ROC curve over the aspects that are recipes.
    pub auc_recipes: Option<f64>,
    /// Area under the ROC curve of the baseline for locations, which knows only whether somebody else changed a
    /// location since the human last looked at it.
    pub auc_baseline: Option<f64>,
    /// Area under the ROC curve of the baseline for locations, which knows only how long ago somebody else last changed
    /// a location: without gaze there is no better baseline.
    pub auc_recency: Option<f64>,
    /// Mean of the areas under the ROC curves of single aspects.
    pub auc_mean_of_aspects: Option<f64>,
    /// Measures of how well the chosen thresholds flag false belief episodes.
    #[serde(flatten)]
    pub flags: FlagPerformance,
    /// The expected calibration error of the predicted probabilities of a false belief within [`CALIBRATED`].
    pub ece: Option<f64>,
    /// Predicted probabilities of a false belief in bins, with the observed frequencies.
    pub calibration: Calibration,
    /// The area under the ROC curve of each aspect separately.
    pub aspects: Vec<AspectAuc>,
}

impl FalseBeliefDetection {
    /// Compares estimates with known beliefs. `thresholds` says how the values are chosen from which on an aspect is
    /// flagged; with `None` flags are not evaluated.
    pub fn from_trials(
        kitchen: &Kitchen,
        trials: &[TrialBeliefs],
        thresholds: Option<ThresholdChoice>,
    ) -> FalseBeliefDetection {
        let predicted = BeliefsBeforePress::p_false;
        let changed =
            |press: &BeliefsBeforePress, aspect| press.unseen_change.get(aspect).map(|&one| f64::from(u8::from(one)));
        let groups = aspect_groups(kitchen);
        let recent = |press: &BeliefsBeforePress, aspect: usize| {
            press.since_change_s.get(aspect).map(|since_s| since_s.map_or(0.0, |since_s: f64| 1.0 / (1.0 + since_s)))
        };
        let both: Vec<usize> = (0..kitchen.aspects.len()).collect();
        let pool = |of: &[usize], score: Score| auc(&scored(trials, of, score));
        let of_groups = groups.each_ref().map(|group| pool(group, &predicted));
        let predictions = scored(trials, &both, &predicted);
        let calibration = Calibration::from_predictions(predictions, CALIBRATED, CALIBRATION_BINS);
        let aspect = |&index: &usize| {
            let known: Vec<bool> = trials.iter().flatten().filter_map(|press| press.is_wrong(index)).collect();
            let wrong = known.iter().filter(|&&wrong| wrong).count() as f64 / known.len().max(1) as f64;
            AspectAuc { aspect: kitchen.aspects[index].name.clone(), auc: pool(&[index], &predicted), wrong }
        };
        FalseBeliefDetection {
            auc: mean(of_groups.into_iter().flatten()),
            auc_locations: of_groups[0],
            auc_recipes: of_groups[1],
            auc_baseline: pool(&groups[0], &changed),
            auc_recency: pool(&groups[0], &recent),
            auc_mean_of_aspects: mean(both.iter().filter_map(|&one| pool(&[one], &predicted))),
            flags: thresholds
                .map_or_else(FlagPerformance::default, |choice| FlagPerformance::from_trials(trials, &groups, choice)),
            ece: calibration.ece,
            calibration,
            aspects: both.iter().map(aspect).collect(),
        }
    }
}

/// Function that scores one aspect before a press.
pub(super) type Score<'a> = &'a dyn Fn(&BeliefsBeforePress, usize) -> Option<f64>;

/// Scores of aspects before every press, each with whether the belief about the aspect was false; pairs are included
/// only where score and belief are known.
pub(super) fn scored(trials: &[TrialBeliefs], aspects: &[usize], score: Score) -> Vec<(f64, bool)> {
    let one = |press: &BeliefsBeforePress, aspect: usize| Some((score(press, aspect)?, press.is_wrong(aspect)?));
    let presses = trials.iter().flatten();
    presses.flat_map(|press| aspects.iter().filter_map(move |&aspect| one(press, aspect))).collect()
}

/// The indices of a kitchen's aspects in two groups: locations, recipes.
pub fn aspect_groups(kitchen: &Kitchen) -> AspectGroups {
    [aspects(kitchen, false), aspects(kitchen, true)]
}

/// The indices of the aspects that are recipes, or, with `recipes` false, of the aspects that are locations.
fn aspects(kitchen: &Kitchen, recipes: bool) -> Vec<usize> {
    let is_recipe = |index: &usize| matches!(kitchen.aspects[*index].kind, AspectKind::Recipe(_));
    (0..kitchen.aspects.len()).filter(|index| is_recipe(index) == recipes).collect()
}

/// The mean of the numbers; `None` without numbers.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}
