//! Accuracy of the belief estimate measured by answers to freeze probes, as an estimate for all state aspects at all
//! probes. Each question is weighted by the inverse of the probability with which it was drawn, so that using the
//! estimate to draw questions does not make the estimate look better.
//!
//! The answers are also predicted by three baselines that use no gaze model, no memory and no presses: the usual
//! content, the content last seen, and the true content.

use serde::Serialize;

use crate::analysis::probe_record::{AspectAtFreeze, ProbeQuestionKind, ProbedQuestion, weighted_share};
use crate::statistics::mean;
use tomcom_core::measures::detection::{CALIBRATED, CALIBRATION_BINS, Calibration, FalseBeliefDetection, weighted_auc};
use tomcom_core::mind::dirichlet::LEAST_MEAN;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedProbeBelief<'a> {
    pub question: &'a ProbedQuestion,
    pub is_wrong: bool,
    /// Weight of the probe question: the inverse of its inclusion probability, or 1.
    pub weight: f64,
}

impl<'a> WeightedProbeBelief<'a> {
    pub fn by_answer(question: &'a ProbedQuestion) -> Option<WeightedProbeBelief<'a>> {
        question.is_counted().then_some(())?;
        Some(WeightedProbeBelief { question, is_wrong: question.is_wrong()?, weight: question.weight() })
    }

    /// This probe question; whether the belief is false is judged by what the simulated participant believed.
    pub(crate) fn by_true_belief(self) -> Option<WeightedProbeBelief<'a>> {
        let believed = self.question.frozen.as_ref()?.believed.as_ref()?;
        Some(WeightedProbeBelief { is_wrong: believed.is_wrong(), ..self })
    }

    pub fn unweighted(self) -> WeightedProbeBelief<'a> {
        WeightedProbeBelief { weight: 1.0, ..self }
    }
}

/// Over weighted probe questions. Values are null where all beliefs, or none, are false.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeDetection {
    pub wrong: Option<f64>,
    /// Mean of the areas under the ROC curves of locations and of recipes.
    pub auc: Option<f64>,
    pub auc_locations: Option<f64>,
    pub auc_recipes: Option<f64>,
    /// Of a baseline on locations: whether somebody else changed it since the participant last looked.
    pub auc_baseline: Option<f64>,
    /// Expected calibration error of the predicted probabilities of a false belief, within the range [`CALIBRATED`].
    pub ece: Option<f64>,
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
        let predictions = beliefs.iter().filter_map(|one| Some((p_false(one)?, one.is_wrong, one.weight)));
        let calibration = Calibration::from_weighted(predictions, CALIBRATED, CALIBRATION_BINS);
        ProbeDetection {
            wrong: weighted_share(beliefs.iter().map(|one| (one.weight, one.is_wrong))),
            auc: mean(of_groups.into_iter().flatten()),
            auc_locations: of_groups[0],
            auc_recipes: of_groups[1],
            auc_baseline: area(false, &changed),
            ece: calibration.ece,
            calibration,
        }
    }
}

/// Weighted mean log probability of the answered values, in nats. "I don't know" is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProbeLogScores {
    pub n: u64,
    /// Score of the belief estimate, which predicts beliefs and expects no mistaken answers.
    pub estimate: Option<f64>,
    /// With a share of random answers, which is fitted to the other participants.
    pub estimate_with_slips: Option<f64>,
    pub usual: Option<f64>,
    /// Score of predicting the content that the participant last saw, which is wrong if the content changed since.
    pub last_seen: Option<f64>,
    pub truth: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
struct NamedAnswer<'a> {
    participant: usize,
    is_recipe: bool,
    weight: f64,
    answer: &'a str,
    truth: &'a str,
    frozen: &'a AspectAtFreeze,
}

const SLIPS: [f64; 9] = [0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3];

impl NamedAnswer<'_> {
    fn estimated(&self) -> f64 {
        self.frozen.estimate_p.get(self.answer).copied().unwrap_or(LEAST_MEAN)
    }

    fn with_slips(&self, share: f64) -> f64 {
        (1.0 - share) * self.estimated() + share / self.frozen.values.max(1) as f64
    }
}

impl ProbeLogScores {
    /// `questions`: with the index of the participant. How often a baseline is right is learnt from the others.
    pub(crate) fn from_questions(questions: &[(usize, &ProbedQuestion)]) -> ProbeLogScores {
        let named: Vec<NamedAnswer> = questions.iter().filter_map(|&(of, question)| named(of, question)).collect();
        let mean = |log_p: &dyn Fn(&NamedAnswer) -> f64| {
            let (weights, sum) = named
                .iter()
                .fold((0.0, 0.0), |(weights, sum), one| (weights + one.weight, sum + one.weight * log_p(one)));
            (weights > 0.0).then(|| sum / weights)
        };
        let participants = named.iter().map(|one| one.participant + 1).max().unwrap_or(0);
        let slips: Vec<f64> = (0..participants).map(|without| share_of_slips(&named, without)).collect();
        let point = |of: for<'a> fn(&NamedAnswer<'a>) -> &'a str| {
            let rates: Vec<[f64; 2]> =
                (0..participants).map(|without| [false, true].map(|group| rate(&named, without, group, of))).collect();
            mean(&|one| {
                let right = rates[one.participant][usize::from(one.is_recipe)];
                let others = (one.frozen.values.max(2) - 1) as f64;
                if of(one) == one.answer { right.ln() } else { ((1.0 - right) / others).ln() }
            })
        };
        ProbeLogScores {
            n: named.len() as u64,
            estimate: mean(&|one| one.estimated().ln()),
            estimate_with_slips: mean(&|one| one.with_slips(slips[one.participant]).ln()),
            usual: point(|one| &one.frozen.usual),
            last_seen: point(|one| &one.frozen.last_seen),
            truth: point(|one| one.truth),
        }
    }
}

fn named(participant: usize, question: &ProbedQuestion) -> Option<NamedAnswer<'_>> {
    question.is_counted().then_some(())?;
    Some(NamedAnswer {
        participant,
        is_recipe: question.kind == ProbeQuestionKind::Recipe,
        weight: question.weight(),
        answer: question.answer()?,
        truth: question.truth.as_deref()?,
        frozen: question.frozen.as_ref()?,
    })
}

/// How often predicting one value is right for the other participants, by Laplace's rule of succession.
fn rate<'a>(named: &[NamedAnswer<'a>], without: usize, is_recipe: bool, of: fn(&NamedAnswer<'a>) -> &'a str) -> f64 {
    let others = named.iter().filter(|one| one.participant != without && one.is_recipe == is_recipe);
    let (n, right) = others.fold((0u32, 0u32), |(n, right), one| (n + 1, right + u32::from(of(one) == one.answer)));
    f64::from(right + 1) / f64::from(n + 2)
}

fn share_of_slips(named: &[NamedAnswer], without: usize) -> f64 {
    let others = || named.iter().filter(|one| one.participant != without);
    let score = |share: f64| others().map(|one| one.with_slips(share).ln()).sum::<f64>();
    SLIPS.into_iter().fold(SLIPS[0], |best, share| if score(share) > score(best) { share } else { best })
}
