//! Fitting the human model: the parameters that can be fitted, the scale on which each is fitted, and the likelihood of
//! a trial's presses and answers to freeze probes.

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

/// A parameter of the human model that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// Softmax rationality tau: how strictly fewer expected presses are preferred, per press.
    Tau,
    /// Share of presses that are slips.
    Lapse,
    /// Radius of the area around the fixation, in degrees.
    RadiusDeg,
    /// Rate at which a location near the gaze is read, in readings per second.
    ReadingRateHz,
    /// Half-life of recipe memory, in seconds.
    RecipeHalfLifeS,
    /// Share of the robot's unseen presses whose consequences the human infers.
    Foresight,
    /// Rate of looks at what the next press needs while the gaze is unknown, per second.
    LooksHz,
    /// Rate of looks at other places while the gaze is unknown, per second.
    OtherLooksHz,
    /// Share of the changes by others that attract the gaze.
    Capture,
    /// Expected probability of a true recipe at the start of a trial.
    RecipeTruth,
}

impl Parameter {
    /// The parameters that are fitted by default.
    pub const USUAL: [Parameter; 5] =
        [Parameter::Tau, Parameter::Lapse, Parameter::RadiusDeg, Parameter::ReadingRateHz, Parameter::RecipeHalfLifeS];

    /// Name of the parameter in a parameter file.
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

    /// Unit of the human model's parameter.
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

    /// Value of the parameter in a human model.
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

    /// Sets the parameter in a human model.
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

    /// Bounds of the parameter in the fit. Above tau = 20 per press the best button is chosen practically always, and
    /// presses carry no information about tau.
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

    /// The value of a parameter from the scale of the fit, the inverse of [`Parameter::to_scale`].
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

/// Least probability of a value with which it is given as the answer to a probe; if no value reaches it, the answer is
/// "I don't know".
const ANSWERED_FROM: f64 = 0.5;
/// Share of answers to probes that are given at random, by mistake.
pub const ANSWERS_AT_RANDOM: f64 = 0.02;

/// A participant's answer to a question of a freeze probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbedValue {
    /// Number of observations up to and including the freeze.
    pub after: usize,
    /// The aspect that the question was about.
    pub aspect: AspectId,
    /// Index of the answered value; `None`: "I don't know".
    pub value: Option<usize>,
}

/// Observations of a trial, and its answers to freeze probes in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitObservations {
    /// Random seed of the belief filter.
    pub seed: u64,
    /// The observations of the trial for the belief filter.
    pub observations: Vec<Observation>,
    /// The answers to freeze probes; empty if they are not used.
    pub answers: Vec<ProbedValue>,
}

/// Log likelihoods of the human's presses and answers to probes in one trial, and their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Likelihood {
    /// Number of presses of the human.
    pub presses: u64,
    /// Sum over presses of ln p under the estimate before each press, in nats.
    pub log_p: f64,
    /// Number of answers to probes.
    pub answers: u64,
    /// Sum over answers of ln p under the estimate at the freeze, with the share [`ANSWERS_AT_RANDOM`] of random
    /// answers, in nats.
    pub log_p_answers: f64,
}

impl Likelihood {
    /// Log likelihood of presses and answers together.
    pub fn total(&self) -> f64 {
        self.log_p + self.log_p_answers
    }

    /// Sum of the likelihoods of two trials.
    pub fn plus(self, other: Likelihood) -> Likelihood {
        Likelihood {
            presses: self.presses + other.presses,
            log_p: self.log_p + other.log_p,
            answers: self.answers + other.answers,
            log_p_answers: self.log_p_answers + other.log_p_answers,
        }
    }
}

/// Log likelihood of a trial's presses and answers under a human model. The filter's random stream depends on the seed
/// only, so that two models are compared on common random numbers.
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

/// Probability of an answer: that the belief, drawn from the estimate, has a probability of one half or more for the
/// value, or for none. At most one value has, so these probabilities sum to 1.
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
