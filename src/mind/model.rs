//! The human model (paper, section "Human model"): a POMDP actor in parts, each with its parameters.
//!
//! All values have defaults and can be fitted. A session file names a file with them (`human_model = "…"`); the values in
//! force stand in the header of every recording.

use serde::{Deserialize, Serialize};

use super::decision::DecisionModel;

/// All parameters of the human model, and how finely its belief is inferred.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HumanModel {
    pub prior: PriorModel,
    pub perception: PerceptionModel,
    pub transition: TransitionModel,
    pub decision: DecisionModel,
    pub signal: SignalModel,
    pub inference: InferenceModel,
}

/// What the human believes when the trial starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PriorModel {
    /// Expected probability of what a location truly holds; the rest is spread evenly.
    pub location_truth: f64,
    /// Precision (sum of the alphas) of a location's Dirichlet.
    pub location_precision: f64,
    /// Expected probability of a true recipe.
    pub recipe_truth: f64,
    /// Share of the rest that is on variants that look like the true recipe, where there are any.
    pub recipe_look_alike: f64,
    /// Precision of a recipe's Dirichlet: small, since people hold one version for true.
    pub recipe_precision: f64,
}

impl Default for PriorModel {
    fn default() -> Self {
        PriorModel {
            location_truth: 0.9,
            location_precision: 10.0,
            recipe_truth: 0.8,
            recipe_look_alike: 0.6,
            recipe_precision: 0.6,
        }
    }
}

/// Reading: while the gaze is near a location, its content is read at a rate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PerceptionModel {
    /// Readings a second at distance 0 and full confidence: lambda.
    pub reading_rate_hz: f64,
    /// Radius of the area around the fixation, in degrees of the visual field: r.
    pub radius_deg: f64,
    /// From the eyes to the display, in metres.
    pub viewing_distance_m: f64,
    /// One reading gives a look-alike of what is there with this probability, …
    pub look_alike: f64,
    /// … and anything else with this one; else it is right.
    pub anything: f64,
    /// Samples of less confidence are dropped.
    pub min_confidence: f64,
    /// What the display showed is known for so long, in seconds; older samples are dropped.
    pub history_s: f64,
    /// A sample stands for at most so many seconds.
    pub max_sample_s: f64,
    /// A look is over when the gaze was elsewhere for so many seconds.
    pub look_ends_s: f64,
}

impl Default for PerceptionModel {
    fn default() -> Self {
        PerceptionModel {
            reading_rate_hz: 5.0,
            radius_deg: 2.0,
            viewing_distance_m: 2.0,
            look_alike: 0.04,
            anything: 0.01,
            min_confidence: 0.6,
            history_s: 0.5,
            max_sample_s: 1.0 / 15.0,
            look_ends_s: 0.1,
        }
    }
}

impl PerceptionModel {
    /// The radius on the display, in metres.
    pub fn radius_m(&self) -> f64 {
        self.viewing_distance_m * self.radius_deg.to_radians().tan()
    }

    /// How fast locations are read.
    pub fn reading_rate(&self) -> ReadingRate {
        ReadingRate { full_hz: self.reading_rate_hz, spread_m2: 2.0 * self.radius_m() * self.radius_m() }
    }
}

/// How fast locations are read, with what every gaze sample needs of the model.
#[derive(Clone, Copy, Debug)]
pub struct ReadingRate {
    /// Where the gaze is, per second.
    full_hz: f64,
    /// 2 r^2.
    spread_m2: f64,
}

impl ReadingRate {
    /// Of a location whose area is `distance_m` from the gaze, per second.
    #[inline]
    pub fn at(&self, distance_m: f64, confidence: f64) -> f64 {
        self.full_hz * (-distance_m * distance_m / self.spread_m2).exp() * confidence
    }
}

/// How beliefs change without being looked after.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TransitionModel {
    /// Half-life of what is remembered of recipes beyond the prior, in seconds.
    pub recipe_half_life_s: f64,
    /// The share of the robot's unseen presses that the human thinks through; the others leave its belief as it was.
    /// Fitted to simulated participants: people keep to what they last saw.
    pub foresight: f64,
}

impl Default for TransitionModel {
    fn default() -> Self {
        TransitionModel { recipe_half_life_s: 200.0, foresight: 0.2 }
    }
}

/// What a signal does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SignalModel {
    /// Probability that a signal is noticed; what is noticed is believed.
    pub noticed: f64,
}

impl Default for SignalModel {
    fn default() -> Self {
        SignalModel { noticed: 1.0 }
    }
}

/// How finely a belief is inferred from a press.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InferenceModel {
    /// Belief samples.
    pub beliefs: usize,
    /// States and recipes drawn from each of them.
    pub states: usize,
    /// With a smaller effective sample size the number of belief samples is doubled, …
    pub min_effective: f64,
    /// … up to this number.
    pub max_beliefs: usize,
    /// Ways the kitchen may be from which a press of the robot is predicted.
    pub predictions: usize,
}

impl Default for InferenceModel {
    fn default() -> Self {
        InferenceModel { beliefs: 256, states: 32, min_effective: 32.0, max_beliefs: 512, predictions: 64 }
    }
}

impl HumanModel {
    /// The first parameter that cannot be: its name, what it is, and what would be right.
    pub fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        const SHARE: &str = "a number from 0 to 1";
        const ABOVE: &str = "a number above 0";
        const COUNT: &str = "a whole number from 1 to 65536";
        let (prior, sight, think) = (&self.prior, &self.perception, &self.decision);
        let inside = |key, value: f64| (key, value, value > 0.0 && value < 1.0, "a number between 0 and 1");
        let share = |key, value: f64| (key, value, (0.0..=1.0).contains(&value), SHARE);
        let above = |key, value: f64| (key, value, value.is_finite() && value > 0.0, ABOVE);
        let count = |key, value: usize| (key, value as f64, (1..=65_536).contains(&value), COUNT);
        let not_below = |key, value: f64| (key, value, value.is_finite() && value >= 0.0, "a number not below 0");
        let checks = [
            inside("location_truth", prior.location_truth),
            above("location_precision", prior.location_precision),
            inside("recipe_truth", prior.recipe_truth),
            share("recipe_look_alike", prior.recipe_look_alike),
            above("recipe_precision", prior.recipe_precision),
            above("reading_rate_hz", sight.reading_rate_hz),
            (
                "radius_deg",
                sight.radius_deg,
                sight.radius_deg > 0.0 && sight.radius_deg < 45.0,
                "degrees above 0, below 45",
            ),
            above("viewing_distance_m", sight.viewing_distance_m),
            share("look_alike", sight.look_alike),
            (
                "anything",
                sight.anything,
                sight.anything >= 0.0 && sight.anything + sight.look_alike < 1.0,
                "a number from 0; with look_alike below 1",
            ),
            share("min_confidence", sight.min_confidence),
            above("history_s", sight.history_s),
            above("max_sample_s", sight.max_sample_s),
            above("look_ends_s", sight.look_ends_s),
            above("recipe_half_life_s", self.transition.recipe_half_life_s),
            share("foresight", self.transition.foresight),
            above("tau", think.tau),
            inside("lapse", think.lapse),
            (
                "lapse_anywhere",
                think.lapse_anywhere,
                think.lapse_anywhere > 0.0 && think.lapse_anywhere <= 1.0,
                "a number above 0, at most 1",
            ),
            not_below("wait_cost", think.wait_cost),
            count("cases", think.cases),
            share("noticed", self.signal.noticed),
            count("beliefs", self.inference.beliefs),
            (
                "states",
                self.inference.states as f64,
                (1..=256).contains(&self.inference.states),
                "a whole number from 1 to 256",
            ),
            above("min_effective", self.inference.min_effective),
            count("max_beliefs", self.inference.max_beliefs),
            count("predictions", self.inference.predictions),
        ];
        let wrong = checks.into_iter().find(|(_, _, is_right, _)| !is_right);
        wrong.map(|(key, value, _, remedy)| (key, format!("{key} = {value}"), remedy))
    }
}
