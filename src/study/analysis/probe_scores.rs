//! How well answers to freeze probes are predicted: by the belief estimate, and by three baselines that use no gaze
//! model, no memory and no presses. The baselines predict the usual content, the content last seen, and the true
//! content.

use serde::Serialize;

use super::probe_record::{AspectAtFreeze, ProbeQuestionKind, ProbedQuestion};
use tomcom_core::mind::dirichlet::LEAST_MEAN;

/// Weighted mean log probability of the answered values, in nats, for several predictors of answers; higher is better.
/// The answer "I don't know" names no value and is left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProbeLogScores {
    /// Number of answers to freeze probes that name a value.
    pub n: u64,
    /// Score of the belief estimate, which predicts beliefs and expects no mistaken answers.
    pub estimate: Option<f64>,
    /// Score of the belief estimate mixed with a share of random answers; the share is fitted to the other
    /// participants.
    pub estimate_with_slips: Option<f64>,
    /// Score of predicting the content that the location had for the longest time so far.
    pub usual: Option<f64>,
    /// Score of predicting the content that the participant last saw, which is wrong if the content changed since.
    pub last_seen: Option<f64>,
    /// Score of predicting the true content of the location.
    pub truth: Option<f64>,
}

/// An answer to a freeze probe that names a value, with what each predictor says about it.
#[derive(Clone, Copy, Debug)]
struct NamedAnswer<'a> {
    /// Index of the participant who answered.
    participant: usize,
    is_recipe: bool,
    weight: f64,
    answer: &'a str,
    truth: &'a str,
    frozen: &'a AspectAtFreeze,
}

/// Values that are tried for the share of random answers.
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
    /// Scores the predictors on the questions of the main results, each given with the index of its participant. How
    /// often a baseline is right is learnt from the other participants.
    pub fn from_questions(questions: &[(usize, &ProbedQuestion)]) -> ProbeLogScores {
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

/// Share of random answers that has the highest likelihood for the other participants.
fn share_of_slips(named: &[NamedAnswer], without: usize) -> f64 {
    let others = || named.iter().filter(|one| one.participant != without);
    let score = |share: f64| others().map(|one| one.with_slips(share).ln()).sum::<f64>();
    SLIPS.into_iter().fold(SLIPS[0], |best, share| if score(share) > score(best) { share } else { best })
}
