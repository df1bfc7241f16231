//! Fitting the human model: the parameters that can be fitted, the scale on which each is fitted, and the likelihood of a
//! trial's presses and answers to probes.

use serde::{Deserialize, Serialize};

use super::dirichlet::Dirichlet;
use super::filter::BeliefFilter;
use super::model::HumanModel;
use super::observation::{Observation, Observed};
use crate::base::incomplete_beta::regularized_incomplete_beta;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, Kitchen, Press};
use std::sync::Arc;

/// Offset of 1 / tau, in presses, at which the scale of tau saturates.
const STRICT: f64 = 0.1;

/// A parameter that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// How strictly fewer expected presses are preferred, per press.
    Tau,
    /// Share of presses that are slips.
    Lapse,
    /// Radius of the area around the fixation, in degrees.
    RadiusDeg,
    /// Readings a second.
    ReadingRateHz,
    /// Half-life of recipe memory, in seconds.
    RecipeHalfLifeS,
    /// Share of the robot's unseen presses whose consequences the human infers.
    Foresight,
    /// Looks a second at what the next press needs.
    LooksHz,
    /// Looks a second at other places.
    OtherLooksHz,
    /// Share of the changes by others that draw the eye.
    Capture,
    /// Expected probability of a true recipe at the start of a trial.
    RecipeTruth,
}

impl Parameter {
    /// The parameters that are fitted by default.
    pub const USUAL: [Parameter; 5] =
        [Parameter::Tau, Parameter::Lapse, Parameter::RadiusDeg, Parameter::ReadingRateHz, Parameter::RecipeHalfLifeS];

    /// Its name in a parameter file.
    pub fn name(self) -> &'static str {
        match self {
            Parameter::Tau => "tau",
            Parameter::Lapse => "lapse",
            Parameter::RadiusDeg => "radius_deg",
            Parameter::ReadingRateHz => "reading_rate_hz",
            Parameter::RecipeHalfLifeS => "recipe_half_life_s",
            Parameter::Foresight => "foresight",
            Parameter::LooksHz => "looks_hz",
            Parameter::OtherLooksHz => "other_looks_hz",
            Parameter::Capture => "capture",
            Parameter::RecipeTruth => "recipe_truth",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Tau => "1/press",
            Parameter::Lapse | Parameter::Foresight | Parameter::Capture => "share",
            Parameter::RadiusDeg => "deg",
            Parameter::ReadingRateHz | Parameter::LooksHz | Parameter::OtherLooksHz => "1/s",
            Parameter::RecipeHalfLifeS => "s",
            Parameter::RecipeTruth => "probability",
        }
    }

    /// Its value.
    pub fn get(self, model: &HumanModel) -> f64 {
        match self {
            Parameter::Tau => model.decision.tau,
            Parameter::Lapse => model.decision.lapse,
            Parameter::RadiusDeg => model.perception.radius_deg,
            Parameter::ReadingRateHz => model.perception.reading_rate_hz,
            Parameter::RecipeHalfLifeS => model.transition.recipe_half_life_s,
            Parameter::Foresight => model.transition.foresight,
            Parameter::LooksHz => model.looking.looks_hz,
            Parameter::OtherLooksHz => model.looking.other_looks_hz,
            Parameter::Capture => model.looking.capture,
            Parameter::RecipeTruth => model.prior.recipe_truth,
        }
    }

    /// Gives it a value.
    pub fn set(self, model: &mut HumanModel, value: f64) {
        match self {
            Parameter::Tau => model.decision.tau = value,
            Parameter::Lapse => model.decision.lapse = value,
            Parameter::RadiusDeg => model.perception.radius_deg = value,
            Parameter::ReadingRateHz => model.perception.reading_rate_hz = value,
            Parameter::RecipeHalfLifeS => model.transition.recipe_half_life_s = value,
            Parameter::Foresight => model.transition.foresight = value,
            Parameter::LooksHz => model.looking.looks_hz = value,
            Parameter::OtherLooksHz => model.looking.other_looks_hz = value,
            Parameter::Capture => model.looking.capture = value,
            Parameter::RecipeTruth => model.prior.recipe_truth = value,
        }
    }

    /// Bounds of the search. Above tau = 20 per press the best button is chosen practically always, and presses carry no
    /// information about tau.
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Parameter::Tau => [0.05, 20.0],
            Parameter::Lapse => [0.001, 0.5],
            Parameter::RadiusDeg => [0.25, 16.0],
            Parameter::ReadingRateHz => [0.2, 100.0],
            Parameter::RecipeHalfLifeS => [5.0, 20_000.0],
            Parameter::Foresight | Parameter::Capture => [0.001, 0.999],
            Parameter::LooksHz | Parameter::OtherLooksHz => [0.01, 20.0],
            Parameter::RecipeTruth => [0.01, 0.999],
        }
    }

    /// Transforms a value to the scale of the fit: the logarithm for a quantity, the log odds for a share, and
    /// ln(1 / (1 / tau + 0.1)) for tau, since the likelihood changes less and less as tau grows.
    pub fn to_scale(self, value: f64) -> f64 {
        match self {
            Parameter::Lapse | Parameter::Foresight | Parameter::Capture | Parameter::RecipeTruth => {
                let p = value.clamp(1e-4, 1.0 - 1e-4);
                (p / (1.0 - p)).ln()
            }
            Parameter::Tau => (value / (1.0 + STRICT * value)).ln(),
            _ => value.ln(),
        }
    }

    /// The inverse of [`Parameter::to_scale`].
    pub fn from_scale(self, scaled: f64) -> f64 {
        match self {
            Parameter::Lapse | Parameter::Foresight | Parameter::Capture | Parameter::RecipeTruth => {
                1.0 / (1.0 + (-scaled).exp())
            }
            Parameter::Tau => 1.0 / ((-scaled).exp() - STRICT),
            _ => scaled.exp(),
        }
    }

    /// Standard error of a value from its standard error on the scale of the fit (delta method).
    pub fn error_of(self, value: f64, scaled_error: f64) -> f64 {
        let slope = match self {
            Parameter::Lapse | Parameter::Foresight | Parameter::Capture | Parameter::RecipeTruth => {
                value * (1.0 - value)
            }
            Parameter::Tau => value * (1.0 + STRICT * value),
            _ => value,
        };
        slope * scaled_error
    }
}

/// Probability from which on a belief's value is answered; below it for all values the answer is "I don't know".
const ANSWERED_FROM: f64 = 0.5;
/// Share of answers to probes that are any answer, by mistake.
pub const ANSWERS_AT_RANDOM: f64 = 0.02;

/// An answer to a probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbedValue {
    /// Number of observations up to the freeze, that of the freeze included.
    pub after: usize,
    /// The aspect that was asked about.
    pub aspect: AspectId,
    /// Index of the answered value; `None`: "I don't know".
    pub value: Option<usize>,
}

/// Observations of a trial, and its answers to probes in their order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitObservations {
    /// Seed of the filter.
    pub seed: u64,
    /// What the filter observes.
    pub observations: Vec<Observation>,
    /// The answers; none, if they are not to be used.
    pub answers: Vec<ProbedValue>,
}

/// Number of the human's presses and answers in one trial, and their log likelihoods.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Likelihood {
    /// Number of presses.
    pub presses: u64,
    /// Sum over presses of ln p under the estimate before each press, in nats.
    pub log_p: f64,
    /// Number of answers.
    pub answers: u64,
    /// Sum over answers of ln p under the estimate at the freeze, with [`ANSWERS_AT_RANDOM`], in nats.
    pub log_p_answers: f64,
}

impl Likelihood {
    /// Log likelihood of presses and answers.
    pub fn total(&self) -> f64 {
        self.log_p + self.log_p_answers
    }

    /// Sum over two trials.
    pub fn plus(self, other: Likelihood) -> Likelihood {
        Likelihood {
            presses: self.presses + other.presses,
            log_p: self.log_p + other.log_p,
            answers: self.answers + other.answers,
            log_p_answers: self.log_p_answers + other.log_p_answers,
        }
    }
}

/// Log likelihood of a trial's presses and answers under a human model. The filter's random stream depends on the seed only, so that
/// two models are compared on common random numbers.
pub fn likelihood(
    kitchen: &Arc<Kitchen>,
    model: &HumanModel,
    trial: &FitObservations,
    cost: &mut CostToGo,
) -> Likelihood {
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), trial.seed);
    let mut found = Likelihood::default();
    let mut answers = trial.answers.iter().peekable();
    for (index, observation) in trial.observations.iter().enumerate() {
        filter.observe(observation, cost);
        if answers.peek().is_some_and(|answer| answer.after == index + 1) {
            let belief = filter.at(observation.time, cost);
            while let Some(answer) = answers.next_if(|answer| answer.after == index + 1) {
                found.answers += 1;
                found.log_p_answers += p_answer(belief.aspect(answer.aspect), answer.value).ln();
            }
        }
        if let (Observed::Pressed(Press { agent: Agent::Human, .. }), Some(evidence)) =
            (observation.what, filter.evidence())
        {
            found.presses += 1;
            found.log_p += evidence.log_p;
        }
    }
    found
}

/// Probability of an answer: that the belief, which is drawn from the estimate, has one half or more on the value, or on none. At most one
/// value has, so these probabilities sum to 1.
pub fn p_answer(estimate: &Dirichlet, value: Option<usize>) -> f64 {
    let values = estimate.mean().len();
    let is_surest = |value: usize| {
        let alpha = estimate.alpha(value);
        1.0 - regularized_incomplete_beta(ANSWERED_FROM, alpha, estimate.precision() - alpha)
    };
    let believed = match value {
        Some(value) => is_surest(value),
        None => (1.0 - (0..values).map(is_surest).sum::<f64>()).max(0.0),
    };
    (1.0 - ANSWERS_AT_RANDOM) * believed + ANSWERS_AT_RANDOM / (values + 1) as f64
}
