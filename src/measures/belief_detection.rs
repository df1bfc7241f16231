//! Detection of false beliefs by an estimate, compared with known beliefs: those that simulated participants record before each
//! press.
//!
//! The unit is a press of the human, and what was estimated right before it. An aspect is believed wrong if the
//! participant's own P(truth) is below 0.5. The area under the ROC of a group (locations, recipes) is that of all its pairs
//! of a press and an aspect in one pot: the score has to tell an aspect that is believed wrong now both from the others and
//! from itself at other times. The macro-average is the mean of the two groups, so that the many pairs of one do not hide
//! the other. Calibration judges the predicted probability of a false belief, which is that of a belief in the truth below one half,
//! not the expected share of the belief beside the truth. The mean over single aspects is given beside it; it depends much on aspects that are hardly ever wrong.

use serde::Serialize;

use super::detection::{Calibration, auc};
use super::flags::{AspectGroups, Flags, Thresholds};
pub use super::press_view::{EstimateView, PressView, TrialView};
use crate::kitchen::{AspectKind, Kitchen};

/// Calibration uses predictions within this range, since most aspects are obviously right most of the time.
pub const CALIBRATED: [f64; 2] = [0.05, 0.95];
/// Number of calibration bins.
pub const CALIBRATION_BINS: usize = 10;

/// Area under the ROC curve of one aspect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AspectAuc {
    /// The aspect's name.
    pub aspect: String,
    /// Null if its belief was never or always false.
    pub auc: Option<f64>,
    /// Share of presses before which its belief was false.
    pub wrong: f64,
}

/// Detection of false beliefs; null without an estimate or without known beliefs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Detection {
    /// Mean of the areas of locations and recipes.
    pub auc: Option<f64>,
    /// Area under the ROC curve over the locations.
    pub auc_locations: Option<f64>,
    /// Area under the ROC curve over the recipes.
    pub auc_recipes: Option<f64>,
    /// Area of the baseline on locations, which knows only whether somebody else changed a location since the human last looked at it.
    pub auc_baseline: Option<f64>,
    /// Area of the baseline on locations, which knows only how long ago somebody else last changed a location: without gaze
    /// there is no better one.
    pub auc_recency: Option<f64>,
    /// Mean of the areas of single aspects.
    pub auc_mean_of_aspects: Option<f64>,
    /// How well episodes are flagged at the chosen thresholds.
    #[serde(flatten)]
    pub flags: Flags,
    /// The expected calibration error of the predicted probabilities of a false belief within [`CALIBRATED`].
    pub ece: Option<f64>,
    /// The predictions in bins, against what was true.
    pub calibration: Calibration,
    /// The area under the ROC curve of each aspect by itself.
    pub aspects: Vec<AspectAuc>,
}

impl Detection {
    /// Compares estimates with beliefs. `thresholds` are the probabilities from which an aspect is flagged; with `None` they are
    /// chosen on other trials than they are judged on (see [`Flags`]).
    pub fn from_trials(kitchen: &Kitchen, trials: &[TrialView], thresholds: Option<Thresholds>) -> Detection {
        let estimated = |press: &PressView, aspect| press.estimate.as_ref().map(|one| one.p_wrong[aspect]);
        let changed = |press: &PressView, aspect| press.unseen_change.get(aspect).map(|&one| f64::from(u8::from(one)));
        let groups = aspect_groups(kitchen);
        let recent = |press: &PressView, aspect: usize| {
            press.since_change_s.get(aspect).map(|since_s| since_s.map_or(0.0, |since_s: f64| 1.0 / (1.0 + since_s)))
        };
        let both: Vec<usize> = (0..kitchen.aspects.len()).collect();
        let pool = |of: &[usize], score: Score| auc(&scored(trials, of, score));
        let of_groups = groups.each_ref().map(|group| pool(group, &estimated));
        let predicted = |press: &PressView, aspect| press.estimate.as_ref().map(|one| one.p_false[aspect]);
        let predictions = scored(trials, &both, &predicted);
        let calibration = Calibration::from_predictions(predictions, CALIBRATED, CALIBRATION_BINS);
        let aspect = |&index: &usize| {
            let known: Vec<bool> = trials.iter().flatten().filter_map(|press| press.is_wrong(index)).collect();
            let wrong = known.iter().filter(|&&wrong| wrong).count() as f64 / known.len().max(1) as f64;
            AspectAuc { aspect: kitchen.aspects[index].name.clone(), auc: pool(&[index], &estimated), wrong }
        };
        Detection {
            auc: mean(of_groups.into_iter().flatten()),
            auc_locations: of_groups[0],
            auc_recipes: of_groups[1],
            auc_baseline: pool(&groups[0], &changed),
            auc_recency: pool(&groups[0], &recent),
            auc_mean_of_aspects: mean(both.iter().filter_map(|&one| pool(&[one], &estimated))),
            flags: Flags::from_trials(trials, &groups, thresholds),
            ece: calibration.ece,
            calibration,
            aspects: both.iter().map(aspect).collect(),
        }
    }
}

/// Score of one aspect before a press.
type Score<'a> = &'a dyn Fn(&PressView, usize) -> Option<f64>;

/// Scores of aspects before every press with whether their belief was false; only where both are known.
fn scored(trials: &[TrialView], aspects: &[usize], score: Score) -> Vec<(f64, bool)> {
    let one = |press: &PressView, aspect: usize| Some((score(press, aspect)?, press.is_wrong(aspect)?));
    let presses = trials.iter().flatten();
    presses.flat_map(|press| aspects.iter().filter_map(move |&aspect| one(press, aspect))).collect()
}

/// The aspects of a kitchen by group: locations, recipes.
pub fn aspect_groups(kitchen: &Kitchen) -> AspectGroups {
    [aspects(kitchen, false), aspects(kitchen, true)]
}

/// The indices of the aspects that are recipes, or that are not.
fn aspects(kitchen: &Kitchen, recipes: bool) -> Vec<usize> {
    let is_recipe = |index: &usize| matches!(kitchen.aspects[*index].kind, AspectKind::Recipe(_));
    (0..kitchen.aspects.len()).filter(|index| is_recipe(index) == recipes).collect()
}

/// The mean; `None` for an empty list.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}
