//! Fitting the human model: the parameters that can be fitted, the scale on which each parameter is fitted, and the
//! likelihood of a trial's presses and answers to freeze probes.

use std::sync::Arc;

use super::dirichlet::Dirichlet;
use super::filter::BeliefFilter;
use super::model::{HumanModel, PerceptionUnit};
use super::observation::{Observation, ObservedEvidence};
use crate::base::maths::regularized_incomplete_beta;
use crate::base::text::short;
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, AspectId, Kitchen, Press};

/// Offset that is added to 1 / tau, in presses, at which the fit's scale of tau saturates.
const STRICT: f64 = 0.1;

/// A parameter of the human model that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum HumanModelParameter {
    /// Softmax rationality tau: how strictly fewer expected presses are preferred, per press.
    Tau,
    /// Share of presses that are slips.
    Lapse,
    /// Radius of the area around the fixation within which locations are read, in degrees.
    RadiusDeg,
    /// Rate at which a location near the gaze is read, in readings per second.
    ReadingRateHz,
    /// Half-life with which recipe memory decays, in seconds.
    RecipeHalfLifeS,
    /// Share of the robot's presses, unseen by the human, whose consequences the human infers.
    Foresight,
    /// Rate of looks at places that the next press needs while the gaze is unknown, per second.
    LooksHz,
    /// Rate of looks at other places while the gaze is unknown, per second.
    OtherLooksHz,
    /// Share of the changes by others (not the human) that attract the human's gaze.
    Capture,
    /// Expected probability of a dish's true recipe at the start of a trial.
    RecipeTruth,
}

impl HumanModelParameter {
    /// The parameters of the human model that are fitted by default, where the model uses them.
    pub const USUAL: [HumanModelParameter; 5] = [
        HumanModelParameter::Tau,
        HumanModelParameter::Lapse,
        HumanModelParameter::RadiusDeg,
        HumanModelParameter::ReadingRateHz,
        HumanModelParameter::RecipeHalfLifeS,
    ];

    /// Name, unit and bounds of the parameter.
    fn entry(self) -> (&'static str, &'static str, [f64; 2]) {
        match self {
            HumanModelParameter::Tau => ("tau", "1/press", [0.05, 20.0]),
            HumanModelParameter::Lapse => ("lapse", "share", [0.001, 0.5]),
            HumanModelParameter::RadiusDeg => ("radius_deg", "deg", [0.25, 16.0]),
            HumanModelParameter::ReadingRateHz => ("reading_rate_hz", "1/s", [0.2, 100.0]),
            HumanModelParameter::RecipeHalfLifeS => ("recipe_half_life_s", "s", [5.0, 20_000.0]),
            HumanModelParameter::Foresight => ("foresight", "share", [0.001, 0.999]),
            HumanModelParameter::LooksHz => ("looks_hz", "1/s", [0.01, 20.0]),
            HumanModelParameter::OtherLooksHz => ("other_looks_hz", "1/s", [0.01, 20.0]),
            HumanModelParameter::Capture => ("capture", "share", [0.001, 0.999]),
            HumanModelParameter::RecipeTruth => ("recipe_truth", "probability", [0.01, 0.999]),
        }
    }

    /// Name of the parameter in a parameter file.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// Unit of the parameter: "1/press", "share", "deg", "1/s", "s" or "probability".
    pub fn unit(self) -> &'static str {
        self.entry().1
    }

    /// Bounds of the parameter during the fit. Above tau = 20 per press the best button is chosen practically always,
    /// so that presses carry no information about tau.
    pub fn bounds(self) -> [f64; 2] {
        self.entry().2
    }

    fn of(self, model: &mut HumanModel) -> &mut f64 {
        match self {
            HumanModelParameter::Tau => &mut model.decision.tau,
            HumanModelParameter::Lapse => &mut model.decision.lapse,
            HumanModelParameter::RadiusDeg => &mut model.perception.radius_deg,
            HumanModelParameter::ReadingRateHz => &mut model.perception.reading_rate_hz,
            HumanModelParameter::RecipeHalfLifeS => &mut model.transition.recipe_half_life_s,
            HumanModelParameter::Foresight => &mut model.transition.foresight,
            HumanModelParameter::LooksHz => &mut model.looking.looks_hz,
            HumanModelParameter::OtherLooksHz => &mut model.looking.other_looks_hz,
            HumanModelParameter::Capture => &mut model.looking.capture,
            HumanModelParameter::RecipeTruth => &mut model.prior.recipe_truth,
        }
    }

    /// Value of this parameter in a human model.
    pub fn get(self, model: &HumanModel) -> f64 {
        *self.of(&mut model.clone())
    }

    /// Sets this parameter in a human model.
    pub fn set(self, model: &mut HumanModel, value: f64) {
        *self.of(model) = value;
    }

    /// Why a fit that begins with this model cannot have this parameter, and what would be right; `None` if it can. A
    /// parameter that the model does not use changes no likelihood, and one that begins outside of the bounds would be
    /// moved into them before the search, which would make another model of it.
    pub fn obstacle(self, model: &HumanModel) -> Option<(String, String)> {
        let (name, value) = (self.name(), self.get(model));
        let off = match self {
            HumanModelParameter::ReadingRateHz if model.perception.observation == PerceptionUnit::Sample => {
                Some("observation = \"sample\"")
            }
            HumanModelParameter::LooksHz | HumanModelParameter::OtherLooksHz | HumanModelParameter::Capture
                if !model.looking.marginalised =>
            {
                Some("marginalised = false")
            }
            _ => None,
        };
        if let Some(off) = off {
            return Some((format!("{name} is not used with {off}"), format!("a model without {off}")));
        }
        let [low, high] = self.bounds();
        (!(low..=high).contains(&value)).then(|| {
            let found = format!("{name} = {} is outside of {low} to {high}, in which it is searched", short(value, 4));
            (found, format!("a model with {name} in there"))
        })
    }

    /// Whether the parameter lies between 0 and 1.
    fn is_share(self) -> bool {
        matches!(self.unit(), "share" | "probability")
    }

    /// Transforms a parameter's value to the scale of the fit: the logarithm for a quantity, the log odds for a share,
    /// and ln(1 / (1 / tau + 0.1)) for tau, since the likelihood changes less and less as tau grows.
    pub fn to_scale(self, value: f64) -> f64 {
        match self {
            share if share.is_share() => {
                let p = value.clamp(1e-4, 1.0 - 1e-4);
                (p / (1.0 - p)).ln()
            }
            HumanModelParameter::Tau => (value / (1.0 + STRICT * value)).ln(),
            _ => value.ln(),
        }
    }

    /// The value of a parameter from the scale of the fit, the inverse of [`HumanModelParameter::to_scale`].
    pub fn from_scale(self, scaled: f64) -> f64 {
        match self {
            share if share.is_share() => 1.0 / (1.0 + (-scaled).exp()),
            HumanModelParameter::Tau => 1.0 / ((-scaled).exp() - STRICT),
            _ => scaled.exp(),
        }
    }

    /// Standard error of a parameter's value from its standard error on the scale of the fit (delta method).
    pub fn error_of(self, value: f64, scaled_error: f64) -> f64 {
        let slope = match self {
            share if share.is_share() => value * (1.0 - value),
            HumanModelParameter::Tau => value * (1.0 + STRICT * value),
            _ => value,
        };
        slope * scaled_error
    }
}

/// Least probability from which a value is given as the answer to a freeze probe; if no value reaches it, the answer is
/// "I don't know".
const ANSWERED_FROM: f64 = 0.5;
/// Share of answers to freeze probes that are given at random, by mistake.
pub(crate) const ANSWERS_AT_RANDOM: f64 = 0.02;

/// A participant's answer to a question of a freeze probe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProbeAnswerObservation {
    /// Number of the trial's observations up to and including the freeze.
    pub after: usize,
    /// The state aspect that the probe's question was about.
    pub aspect: AspectId,
    /// Index of the value that the participant answered; `None`: "I don't know".
    pub value: Option<usize>,
}

/// Observations of a trial for the belief filter, and the trial's answers to freeze probes in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitObservations {
    /// Random seed of the belief filter in this trial.
    pub seed: u64,
    /// The observations of the trial for the belief filter.
    pub observations: Vec<Observation>,
    /// The answers to freeze probes; empty if the answers are not used.
    pub answers: Vec<ProbeAnswerObservation>,
}

/// Log likelihoods of the human's presses and of the answers to freeze probes in one trial, with their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialLikelihood {
    /// Number of presses of the human.
    pub presses: u64,
    /// Sum over presses of ln p(press) under the estimate before each press, in nats.
    pub log_p: f64,
    /// Number of answers to probes.
    pub answers: u64,
    /// Sum over answers of ln p(answer) under the estimate at the freeze, with the share `ANSWERS_AT_RANDOM` of
    /// random answers, in nats.
    pub log_p_answers: f64,
    /// Log likelihood of each press and each answer in order of time, in nats. Which of them comes when does not depend
    /// on the human model.
    pub each: Vec<f64>,
}

impl TrialLikelihood {
    /// Log likelihood of presses and answers together, in nats.
    pub fn total(&self) -> f64 {
        self.log_p + self.log_p_answers
    }

    /// Log likelihoods of two trials together: their sums, and each press and answer of this trial, then of the other.
    pub fn plus(mut self, other: TrialLikelihood) -> TrialLikelihood {
        self.each.extend(other.each);
        TrialLikelihood {
            presses: self.presses + other.presses,
            log_p: self.log_p + other.log_p,
            answers: self.answers + other.answers,
            log_p_answers: self.log_p_answers + other.log_p_answers,
            each: self.each,
        }
    }

    /// Negative log likelihood of each press and each answer in order of time, in nats.
    pub fn losses(&self) -> Vec<f64> {
        self.each.iter().map(|log_p| -log_p).collect()
    }
}

/// Log likelihood of a trial's presses and answers under a human model. The belief filter's random stream depends on
/// the seed only, so that two models are compared on common random numbers.
pub fn likelihood(
    kitchen: &Arc<Kitchen>,
    model: &HumanModel,
    trial: &FitObservations,
    cost: &mut CostToGo,
) -> TrialLikelihood {
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), trial.seed);
    let mut found = TrialLikelihood::default();
    let mut answers = trial.answers.iter().peekable();
    for (index, observation) in trial.observations.iter().enumerate() {
        filter.observe(observation, cost);
        if answers.peek().is_some_and(|answer| answer.after == index + 1) {
            let belief = filter.at(observation.time, cost);
            while let Some(answer) = answers.next_if(|answer| answer.after == index + 1) {
                let log_p = p_answer(belief.aspect(answer.aspect), answer.value).ln();
                found.answers += 1;
                found.log_p_answers += log_p;
                found.each.push(log_p);
            }
        }
        if let (ObservedEvidence::Pressed(Press { agent: Agent::Human, .. }), Some(evidence)) =
            (observation.what, filter.evidence())
        {
            found.presses += 1;
            found.log_p += evidence.log_p;
            found.each.push(evidence.log_p);
        }
    }
    found
}

/// Probability of an answer to a probe: that the belief, drawn from the estimate, has a probability of one half or more
/// for the value, or for no value. At most one value can have one half or more, so these probabilities sum to 1.
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
