//! The estimate of beliefs against answers to probes, over all aspects at all probes: each question weighs the inverse of the
//! probability with which it was drawn, so that the choice of questions by the estimate does not flatter the estimate.

use serde::Serialize;

use super::probe_record::{ProbedKind, ProbedQuestion, weighted_share};
use crate::measures::belief_detection::{CALIBRATED, CALIBRATION_BINS, Detection};
use crate::measures::detection::{Calibration, weighted_auc};

/// A question with a verdict on the belief, and what weighs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeighedBelief<'a> {
    /// The question.
    pub question: &'a ProbedQuestion,
    /// Whether the belief is false.
    pub is_wrong: bool,
    /// Its weight.
    pub weight: f64,
}

impl<'a> WeighedBelief<'a> {
    /// A question of the main results, judged by its answer.
    pub fn by_answer(question: &'a ProbedQuestion) -> Option<WeighedBelief<'a>> {
        question.is_counted().then_some(())?;
        Some(WeighedBelief { question, is_wrong: question.is_wrong()?, weight: question.weight() })
    }

    /// The same question, judged by what a simulated participant really believed.
    pub fn by_true_belief(self) -> Option<WeighedBelief<'a>> {
        let believed = self.question.frozen.as_ref()?.believed.as_ref()?;
        Some(WeighedBelief { is_wrong: believed.is_wrong(), ..self })
    }

    /// The same question with weight 1.
    pub fn unweighted(self) -> WeighedBelief<'a> {
        WeighedBelief { weight: 1.0, ..self }
    }
}

/// How well the estimate finds false beliefs, weighted. Null where all beliefs, or none, are false.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeDetection {
    /// Weighted share of false beliefs.
    pub wrong: Option<f64>,
    /// Mean of the areas under the ROC of locations and recipes.
    pub auc: Option<f64>,
    /// Area over the locations.
    pub auc_locations: Option<f64>,
    /// Area over the recipes.
    pub auc_recipes: Option<f64>,
    /// Area of the baseline on locations, which knows only whether somebody else changed a location since the participant last looked
    /// at it.
    pub auc_baseline: Option<f64>,
    /// Expected calibration error of the predicted probabilities of a false belief within [`CALIBRATED`].
    pub ece: Option<f64>,
    /// The predictions in bins, against the share of false beliefs.
    pub calibration: Calibration,
}

impl ProbeDetection {
    /// A detection without known beliefs, with what probes tell in place of what is not known.
    pub fn in_place_of(&self, unknown: Detection) -> Detection {
        Detection {
            auc: self.auc,
            auc_locations: self.auc_locations,
            auc_recipes: self.auc_recipes,
            auc_baseline: self.auc_baseline,
            ece: self.ece,
            calibration: self.calibration.clone(),
            ..unknown
        }
    }

    /// Compares the estimate with judged questions.
    pub fn from_beliefs(beliefs: &[WeighedBelief]) -> ProbeDetection {
        let p_wrong = |one: &WeighedBelief| Some(1.0 - one.question.frozen.as_ref()?.estimate_p_truth);
        let changed = |one: &WeighedBelief| {
            one.question.frozen.as_ref()?.changed_unseen.map(|changed| f64::from(u8::from(changed)))
        };
        let is_recipe = |one: &WeighedBelief| one.question.kind == ProbedKind::Recipe;
        let area = |recipes: bool, score: &dyn Fn(&WeighedBelief) -> Option<f64>| {
            let of_group = beliefs.iter().filter(|one| is_recipe(one) == recipes);
            let scored: Vec<(f64, bool, f64)> =
                of_group.filter_map(|one| Some((score(one)?, one.is_wrong, one.weight))).collect();
            weighted_auc(&scored)
        };
        let of_groups = [area(false, &p_wrong), area(true, &p_wrong)];
        let known: Vec<f64> = of_groups.into_iter().flatten().collect();
        let predictions = beliefs
            .iter()
            .filter_map(|one| Some((one.question.frozen.as_ref()?.estimate_p_false, one.is_wrong, one.weight)));
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
