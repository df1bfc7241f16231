//! Detection of false beliefs: area under the ROC curve and calibration of any binary detector, beliefs and estimates
//! before presses, and how well the estimate detects false beliefs.

use serde::Serialize;

use super::flags::{AspectGroups, FlagPerformance, ThresholdChoice};
use super::sequences::FALSE_BELOW;
use crate::base::maths::regularized_incomplete_beta;
use crate::kitchen::{AspectId, AspectKind, ButtonId, Kitchen, State};
use crate::mind::RecordedEstimate;

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

/// The participant's belief and its estimate directly before a press of the human.
#[derive(Clone, Debug, PartialEq)]
pub struct BeliefsBeforePress {
    /// State of the kitchen before the press.
    pub state: State,
    /// The pressed button, as an index into the human's buttons.
    pub button: ButtonId,
    /// The participant's own P(truth) of each aspect; `None` where this belief is not known, as for people.
    pub held: Option<Vec<f64>>,
    /// The estimate of the participant's belief before the press, if there is one.
    pub estimate: Option<EstimateBeforePress>,
    /// For each location, whether somebody else changed the location since the human last looked at it: the input of
    /// the baseline.
    pub unseen_change: Vec<bool>,
    /// For each location, the time since somebody other than the human last changed the location, in seconds; `None` if
    /// the human changed the location later, or nobody changed it.
    pub since_change_s: Vec<Option<f64>>,
    /// The aspects about which a false belief caused the press, if the press was an error.
    pub errs_about: Vec<AspectId>,
}

/// An estimate of the human's belief before a press.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateBeforePress {
    /// For each aspect, the probability that the participant's own P(truth) is below [`FALSE_BELOW`], by the marginal
    /// of the Dirichlet: I_.5(alpha_truth, A - alpha_truth), with A the sum of the alphas. Detection, flags and
    /// calibration judge this predicted probability.
    pub p_false: Vec<f64>,
    /// The log probability of the press under the estimate, given that a button is pressed, in nats.
    pub log_p: f64,
}

impl EstimateBeforePress {
    /// The estimate before a press, from an estimate that a recording contains.
    pub fn from_witness(witness: &RecordedEstimate) -> EstimateBeforePress {
        let p_false = witness.aspects.iter().map(|aspect| {
            let [of_truth, of_others] = [aspect.p_truth, 1.0 - aspect.p_truth].map(|mean| mean * aspect.precision);
            regularized_incomplete_beta(FALSE_BELOW, of_truth, of_others)
        });
        EstimateBeforePress { p_false: p_false.collect(), log_p: witness.log_p }
    }
}

/// The presses of one trial with the human's beliefs and their estimates, in order of time.
pub type TrialBeliefs = Vec<BeliefsBeforePress>;

impl BeliefsBeforePress {
    /// Whether the participant's belief about an aspect is false; `None` where the belief is not known.
    pub fn is_wrong(&self, aspect: usize) -> Option<bool> {
        self.held.as_ref().map(|held| held[aspect] < FALSE_BELOW)
    }

    /// The predicted probability that the participant's belief about an aspect is false; `None` without an estimate.
    pub fn p_false(&self, aspect: usize) -> Option<f64> {
        self.estimate.as_ref().map(|estimate| estimate.p_false[aspect])
    }
}

// Detection of false beliefs by an estimate, compared with known beliefs: the beliefs that simulated participants
// record before each press.
//
// The unit is a press of the human, with the estimate right before the press. A belief about an aspect is false if the
// participant's own P(truth) is below 0.5. The area under the ROC curve of a group (locations, recipes) is computed
// over all pairs of a press and an aspect of the group together: the score has to distinguish an aspect that is
// believed wrong now both from the other aspects and from the same aspect at other times. The score of the estimate is
// the predicted probability of a false belief: that the participant's P(truth) is below 0.5. The macro-average is the
// mean of the two groups, so that the many pairs of one group do not hide the other group. Calibration judges the same
// probability, not the expected probability of wrong values. The mean over single aspects is reported as well; this
// mean depends much on aspects that are hardly ever wrong.

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
        let all: Vec<usize> = (0..kitchen.aspects.len()).collect();
        let pool = |of: &[usize], score: Score| auc(&scored(trials, of, score));
        let of_groups = groups.each_ref().map(|group| pool(group, &predicted));
        let predictions = scored(trials, &all, &predicted);
        let calibration = Calibration::from_predictions(predictions, CALIBRATED, CALIBRATION_BINS);
        let aspect = |&index: &usize| {
            let known: Vec<bool> = trials.iter().flatten().filter_map(|press| press.is_wrong(index)).collect();
            let wrong = known.iter().filter(|&&wrong| wrong).count() as f64 / known.len().max(1) as f64;
            AspectAuc { aspect: kitchen.aspects[index].name.clone(), auc: pool(&[index], &predicted), wrong }
        };
        let aspects: Vec<AspectAuc> = all.iter().map(aspect).collect();
        FalseBeliefDetection {
            auc: mean(of_groups.into_iter().flatten()),
            auc_locations: of_groups[0],
            auc_recipes: of_groups[1],
            auc_baseline: pool(&groups[0], &changed),
            auc_recency: pool(&groups[0], &recent),
            auc_mean_of_aspects: mean(aspects.iter().filter_map(|aspect| aspect.auc)),
            flags: thresholds
                .map_or_else(FlagPerformance::default, |choice| FlagPerformance::from_trials(trials, &groups, choice)),
            ece: calibration.ece,
            calibration,
            aspects,
        }
    }
}

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
    let is_location = |index: &usize| matches!(kitchen.aspects[*index].kind, AspectKind::Location(_));
    let (locations, recipes) = (0..kitchen.aspects.len()).partition(is_location);
    [locations, recipes]
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// Areas under the ROC curves and calibration error of one resample, in which each trial counts several times or not at
/// all; `None` where a resample has no false belief, or only false ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResampledDetection {
    /// Area under the ROC curve over the aspects that are locations.
    pub auc_locations: Option<f64>,
    /// Area under the ROC curve over the aspects that are recipes.
    pub auc_recipes: Option<f64>,
    /// Expected calibration error of the predicted probabilities of a false belief.
    pub ece: Option<f64>,
}

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
