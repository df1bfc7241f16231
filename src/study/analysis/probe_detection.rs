//! Accuracy of the belief estimate measured by answers to freeze probes, as an estimate for all state aspects at all
//! probes. Each question is weighted by the inverse of the probability with which it was drawn, so that using the
//! estimate to draw questions does not make the estimate look better.

use serde::Serialize;

use super::probe_record::{ProbeQuestionKind, ProbedQuestion, weighted_share};
use tomcom_core::measures::detection::{CALIBRATED, CALIBRATION_BINS, FalseBeliefDetection};
use tomcom_core::measures::detection::{Calibration, weighted_auc};

/// A probe question with its weight, and whether the participant's belief about the asked aspect is false.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedProbeBelief<'a> {
    /// The probe question, with truth, estimate and answer.
    pub question: &'a ProbedQuestion,
    /// Whether the participant's belief about the asked aspect is false.
    pub is_wrong: bool,
    /// Weight of the probe question: the inverse of its inclusion probability, or 1.
    pub weight: f64,
}

impl<'a> WeightedProbeBelief<'a> {
    /// A probe question of the main results; whether the belief is false is judged by the participant's answer.
    pub fn by_answer(question: &'a ProbedQuestion) -> Option<WeightedProbeBelief<'a>> {
        question.is_counted().then_some(())?;
        Some(WeightedProbeBelief { question, is_wrong: question.is_wrong()?, weight: question.weight() })
    }

    /// This probe question; whether the belief is false is judged by what the simulated participant believed.
    pub fn by_true_belief(self) -> Option<WeightedProbeBelief<'a>> {
        let believed = self.question.frozen.as_ref()?.believed.as_ref()?;
        Some(WeightedProbeBelief { is_wrong: believed.is_wrong(), ..self })
    }

    /// This probe question with weight 1 instead of its own weight.
    pub fn unweighted(self) -> WeightedProbeBelief<'a> {
        WeightedProbeBelief { weight: 1.0, ..self }
    }
}

/// How well the estimate finds false beliefs, over weighted probe questions. Values are null where all beliefs, or
/// none, are false.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeDetection {
    /// Weighted share of the beliefs that are false.
    pub wrong: Option<f64>,
    /// Mean of the areas under the ROC curves of locations and of recipes.
    pub auc: Option<f64>,
    /// Area under the ROC curve over questions about locations.
    pub auc_locations: Option<f64>,
    /// Area under the ROC curve over questions about recipes.
    pub auc_recipes: Option<f64>,
    /// Area under the ROC curve of a baseline on locations, which knows only whether somebody else changed the location
    /// since the participant last looked at it.
    pub auc_baseline: Option<f64>,
    /// Expected calibration error of the predicted probabilities of a false belief, within the range [`CALIBRATED`].
    pub ece: Option<f64>,
    /// Predicted probabilities of a false belief in bins, beside the share of false beliefs in each bin.
    pub calibration: Calibration,
}

impl ProbeDetection {
    /// Adds the results from probes to the result of a belief check without known beliefs.
    pub fn in_place_of(&self, unknown: FalseBeliefDetection) -> FalseBeliefDetection {
        FalseBeliefDetection {
            auc: self.auc,
            auc_locations: self.auc_locations,
            auc_recipes: self.auc_recipes,
            auc_baseline: self.auc_baseline,
            ece: self.ece,
            calibration: self.calibration.clone(),
            ..unknown
        }
    }

    /// Compares the estimate with probe questions for which it is known whether the belief is false.
    pub fn from_beliefs(beliefs: &[WeightedProbeBelief]) -> ProbeDetection {
        let p_false = |one: &WeightedProbeBelief| Some(one.question.frozen.as_ref()?.estimate_p_false);
        let changed = |one: &WeightedProbeBelief| {
            one.question.frozen.as_ref()?.changed_unseen.map(|changed| f64::from(u8::from(changed)))
        };
        let is_recipe = |one: &WeightedProbeBelief| one.question.kind == ProbeQuestionKind::Recipe;
        let area = |recipes: bool, score: &dyn Fn(&WeightedProbeBelief) -> Option<f64>| {
            let of_group = beliefs.iter().filter(|one| is_recipe(one) == recipes);
            let scored: Vec<(f64, bool, f64)> =
                of_group.filter_map(|one| Some((score(one)?, one.is_wrong, one.weight))).collect();
            weighted_auc(&scored)
        };
        let of_groups = [area(false, &p_false), area(true, &p_false)];
        let known: Vec<f64> = of_groups.into_iter().flatten().collect();
        let predictions = beliefs.iter().filter_map(|one| Some((p_false(one)?, one.is_wrong, one.weight)));
        let calibration = Calibration::from_weighted(predictions, CALIBRATED, CALIBRATION_BINS);
        ProbeDetection {
            wrong: weighted_share(beliefs.iter().map(|one| (one.weight, one.is_wrong))),
            auc: (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64),
            auc_locations: of_groups[0],
            auc_recipes: of_groups[1],
            auc_baseline: area(false, &changed),
            ece: calibration.ece,
            calibration,
        }
    }
}
