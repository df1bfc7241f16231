//! Fitting the human model: which of its parameters can be fitted, on which scale, and how likely presses are under them.

use serde::{Deserialize, Serialize};

use super::filter::BeliefFilter;
use super::model::HumanModel;
use super::observation::{Observation, Observed};
use crate::kitchen::cost_to_go::CostToGo;
use crate::kitchen::{Agent, Kitchen, Press};
use std::sync::Arc;

/// The scale of tau ends where 1 / tau is as small as this, in presses.
const STRICT: f64 = 0.1;

/// A parameter that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    /// How strictly fewer expected presses are preferred, per press.
    Tau,
    /// The share of presses that slip.
    Lapse,
    /// Radius of the area around the fixation, in degrees.
    RadiusDeg,
    /// Readings a second.
    ReadingRateHz,
    /// Half-life of what is remembered of recipes, in seconds.
    RecipeHalfLifeS,
    /// The share of the robot's unseen presses that the human thinks through.
    Foresight,
}

impl Parameter {
    /// Those that are fitted unless others are asked for.
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
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Parameter::Tau => "1/press",
            Parameter::Lapse | Parameter::Foresight => "share",
            Parameter::RadiusDeg => "deg",
            Parameter::ReadingRateHz => "1/s",
            Parameter::RecipeHalfLifeS => "s",
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
        }
    }

    /// The values between which it is looked for. Who is stricter than a tau of 20 presses what it holds for the best practically
    /// always, and no recording tells how strict it is.
    pub fn bounds(self) -> [f64; 2] {
        match self {
            Parameter::Tau => [0.05, 20.0],
            Parameter::Lapse => [0.001, 0.5],
            Parameter::RadiusDeg => [0.25, 16.0],
            Parameter::ReadingRateHz => [0.2, 100.0],
            Parameter::RecipeHalfLifeS => [5.0, 20_000.0],
            Parameter::Foresight => [0.001, 0.999],
        }
    }

    /// On the scale on which it is fitted: the logarithm, of a share that of its odds; of tau that of 1 / (1 / tau + 0.1), since
    /// the stricter people are, the less difference a further step makes.
    pub fn to_scale(self, value: f64) -> f64 {
        match self {
            Parameter::Lapse | Parameter::Foresight => {
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
            Parameter::Lapse | Parameter::Foresight => 1.0 / (1.0 + (-scaled).exp()),
            Parameter::Tau => 1.0 / ((-scaled).exp() - STRICT),
            _ => scaled.exp(),
        }
    }

    /// A standard error of the value, from one on the scale (first order).
    pub fn error_of(self, value: f64, scaled_error: f64) -> f64 {
        let slope = match self {
            Parameter::Lapse | Parameter::Foresight => value * (1.0 - value),
            Parameter::Tau => value * (1.0 + STRICT * value),
            _ => value,
        };
        slope * scaled_error
    }
}

/// The presses of a human in one trial: their number, and how likely they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Likelihood {
    pub presses: u64,
    /// Sum over the presses of ln p under the estimate before each, in nats.
    pub log_p: f64,
}

/// How likely the presses of a trial are under a model. The filter's random numbers follow from `seed`, the same for every
/// model, so that two models differ by themselves and not by chance.
pub fn likelihood(
    kitchen: &Arc<Kitchen>,
    model: &HumanModel,
    seed: u64,
    observations: &[Observation],
    cost: &mut CostToGo,
) -> Likelihood {
    let mut filter = BeliefFilter::new(kitchen.clone(), model.clone(), seed);
    let mut found = Likelihood::default();
    for observation in observations {
        filter.observe(observation, cost);
        if let (Observed::Pressed(Press { agent: Agent::Human, .. }), Some(evidence)) =
            (observation.what, filter.evidence())
        {
            found.presses += 1;
            found.log_p += evidence.log_p;
        }
    }
    found
}
