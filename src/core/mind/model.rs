//! The human model (paper, section "Human model"): the parameters of prior, perception, transition, decision and
//! signals.
//!
//! The program has two models by name ([`super::named_models`]). A session names one of them, and may set single
//! parameters on top of it, or name a file with such parameters (`human_model = "…"`); the values in use are recorded
//! in the header of every recording.

use serde::{Deserialize, Serialize};

use super::choice_parameters::{ChoiceParameters, GivenChoice};
use super::model_table::model_table;
use super::signal_model::{GivenSignal, SignalModel};
use crate::kitchen::{Kitchen, LocationId};

/// A human model that the program has by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum HumanModelName {
    /// The program's default.
    #[default]
    #[serde(rename = "plain")]
    Plain,
    /// The equations of Buehler, Adamy and Weisswange (2021); values that the paper does not give are those of `plain`.
    #[serde(rename = "paper-2021")]
    Paper2021,
}

impl HumanModelName {
    /// The name in settings.
    pub fn name(self) -> &'static str {
        match self {
            HumanModelName::Plain => "plain",
            HumanModelName::Paper2021 => "paper-2021",
        }
    }
}

/// All parameters of the human model, and the sample sizes of its inference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "GivenHumanModel")]
pub struct HumanModel {
    /// The named model on top of which the parameters are set.
    pub model: HumanModelName,
    /// Prior: beliefs before the human has seen anything.
    pub prior: PriorModel,
    /// How gaze near a location becomes knowledge of its content.
    pub perception: PerceptionModel,
    /// Where people look while the gaze is unknown.
    pub looking: LookingModel,
    /// How the human's beliefs change between observations.
    pub transition: TransitionModel,
    /// How the human's presses follow from beliefs.
    pub decision: ChoiceParameters,
    /// How the human notices and reads signals.
    pub signal: SignalModel,
    /// Settings of the computation that infers the belief, which are no properties of people.
    pub inference: InferenceSettings,
}

/// What a file gives of a human model: its name, and parameters on top of it.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GivenHumanModel {
    /// The named model.
    pub model: HumanModelName,
    /// Given parameters of the prior.
    pub prior: GivenPrior,
    /// Given parameters of perception.
    pub perception: GivenPerception,
    /// Given parameters of plausible looking.
    pub looking: GivenLooking,
    /// Given parameters of the transition.
    pub transition: GivenTransition,
    /// Given parameters of the choice model.
    pub decision: GivenChoice,
    /// Given parameters of the comprehension of signals.
    pub signal: GivenSignal,
    /// Given settings of the inference.
    pub inference: GivenInference,
}

impl GivenHumanModel {
    /// A model with the given parameters in their places.
    pub fn on(self, model: HumanModel) -> HumanModel {
        HumanModel {
            model: model.model,
            prior: self.prior.on(model.prior),
            perception: self.perception.on(model.perception),
            looking: self.looking.on(model.looking),
            transition: self.transition.on(model.transition),
            decision: self.decision.on(model.decision),
            signal: self.signal.on(model.signal),
            inference: self.inference.on(model.inference),
        }
    }
}

/// What a gaze sample tells about a location near the gaze.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PerceptionUnit {
    /// Reading takes time: a sample reads the location with a probability that grows with the time that the sample
    /// covers, and one look reads the location at most once.
    Look,
    /// Every sample is an observation of each location within the radius, and updates the belief by Bayes' rule.
    Sample,
}

model_table! {
    /// The human's belief at the start of a trial (prior).
    PriorModel, GivenPrior {
        /// Expected probability of a location's true content; the remaining probability is spread evenly over the other
        /// contents.
        location_truth: f64,
        /// Precision (sum of the alphas) of the Dirichlet about a location's content.
        location_precision: f64,
        /// Expected probability of a dish's true recipe.
        recipe_truth: f64,
        /// Share of the remaining probability that goes to variants which look like the true recipe, where there are
        /// any.
        recipe_look_alike: f64,
        /// Precision (sum of the alphas) of the Dirichlet about a recipe: small, since people are certain of one
        /// variant.
        recipe_precision: f64,
    }
}

/// Range of confidence over which the time of a gaze sample turns from unknown to known.
pub const CONFIDENCE_RAMP: f64 = 0.4;

model_table! {
    /// Perception: how gaze near a location becomes an observation of the location's content.
    PerceptionModel, GivenPerception {
        /// Whether a look or a gaze sample is one observation.
        observation: PerceptionUnit,
        /// Reading rate lambda at distance 0 and full confidence, in readings per second, where looks are observations.
        reading_rate_hz: f64,
        /// Radius r of the area around the fixation that is perceived, in degrees of the visual field.
        radius_deg: f64,
        /// Distance from the eyes to the display, in metres.
        viewing_distance_m: f64,
        /// Probability that an observation gives a look-alike of the true content instead of it.
        look_alike: f64,
        /// Probability that an observation gives any other wrong content.
        anything: f64,
        /// Confidence at which half of a gaze sample's time counts as known; the share that counts rises linearly over
        /// [`CONFIDENCE_RAMP`]. Where samples are observations: the least confidence of a sample that is used.
        min_confidence: f64,
        /// Length of the history of displayed states, in seconds; gaze samples taken earlier are not used.
        history_s: f64,
        /// Longest time that one gaze sample covers, in seconds.
        max_sample_s: f64,
        /// Time for which the gaze has to be elsewhere until a look at a location ends, in seconds.
        look_ends_s: f64,
    }
}

impl PerceptionModel {
    /// Radius, on the display, of the area around the fixation that is read, in metres.
    pub fn radius_m(&self) -> f64 {
        self.viewing_distance_m * self.radius_deg.to_radians().tan()
    }

    /// Probabilities of reading each value of a location's aspect, given that `value` is displayed there.
    pub fn confusion(&self, kitchen: &Kitchen, location: LocationId, value: usize) -> Vec<f64> {
        let aspect = &kitchen.aspects[location.index()];
        let alike: Vec<usize> = kitchen
            .look_alike_codes(location, aspect.values[value])
            .into_iter()
            .filter_map(|code| aspect.index_of(code))
            .collect();
        let others = aspect.values.len() - 1 - alike.len();
        let to_alike = if alike.is_empty() { 0.0 } else { self.look_alike };
        let to_others = if others == 0 { 0.0 } else { self.anything };
        let each_alike = to_alike / alike.len().max(1) as f64;
        let each_other = to_others / others.max(1) as f64;
        let chance = |other: usize| match other {
            _ if other == value => 1.0 - to_alike - to_others,
            _ if alike.contains(&other) => each_alike,
            _ => each_other,
        };
        (0..aspect.values.len()).map(chance).collect()
    }

    /// Share of a gaze sample's time in which the gaze is known: v = clamp((c - 0.4) / 0.4) for confidence c and
    /// `min_confidence` = 0.6. 0 for NaN.
    pub fn known_share(&self, confidence: f64) -> f64 {
        let share = (confidence - self.min_confidence) / CONFIDENCE_RAMP + 0.5;
        if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
    }

    /// The rate of reading a location as a function of distance and confidence.
    pub fn reading_rate(&self) -> LocationReadingRate {
        self.rate_of(self.reading_rate_hz)
    }

    /// The rate of reading something that is read `full_hz` times a second at distance 0.
    pub fn rate_of(&self, full_hz: f64) -> LocationReadingRate {
        LocationReadingRate { full_hz, spread_m2: 2.0 * self.radius_m() * self.radius_m() }
    }
}

model_table! {
    /// Plausible looking: where people look, in rates. The belief filter uses these rates while the gaze is unknown,
    /// the planner in its rollouts.
    LookingModel, GivenLooking {
        /// Whether the belief filter marginalises over plausible looks while the gaze is unknown; otherwise it assumes
        /// that nothing is seen then.
        marginalised: bool,
        /// Looks per second at each place that the next press needs; before an item is fetched, also at the robot's
        /// hand, which may be bringing the item.
        looks_hz: f64,
        /// Looks per second at each other place.
        other_looks_hz: f64,
        /// Share of the changes by others that attract the gaze at once.
        capture: f64,
        /// Looks per second at each place while the eye tracker does not find the display in its view, which means that
        /// the head is turned away.
        display_lost_looks_hz: f64,
        /// Time without known gaze that counts as a blink, in seconds: nothing is read during a blink, and its time
        /// does not count as unknown.
        blink_s: f64,
    }
}

/// The rate of reading a location, with precomputed constants, because every gaze sample needs the rate.
#[derive(Clone, Copy, Debug)]
pub struct LocationReadingRate {
    /// Readings per second at distance 0 and with full confidence.
    full_hz: f64,
    /// 2 r^2 with the reading radius r, in square metres.
    spread_m2: f64,
}

impl LocationReadingRate {
    /// Times per second that a person reads the content of a location whose area is `distance_m` metres away from the
    /// point of gaze.
    #[inline]
    pub fn at(&self, distance_m: f64, confidence: f64) -> f64 {
        self.full_hz * (-distance_m * distance_m / self.spread_m2).exp() * confidence
    }
}

model_table! {
    /// Transition model: how the human's belief changes without new evidence.
    TransitionModel, GivenTransition {
        /// Half-life with which beliefs about a recipe decay to the prior, in seconds: of how many people still hold
        /// what they have learned.
        recipe_half_life_s: f64,
        /// Share of the robot's unseen presses whose consequences the human infers; the other presses leave the belief
        /// unchanged.
        foresight: f64,
    }
}

model_table! {
    /// Sample sizes of the inference of the belief.
    InferenceSettings, GivenInference {
        /// Number of belief samples drawn from the estimate at a press.
        beliefs: usize,
        /// Number of worlds (state and recipes) drawn from each belief sample.
        states: usize,
        /// Effective sample size below which the number of belief samples is doubled.
        min_effective: f64,
        /// Largest number of belief samples in an update by a press.
        max_beliefs: usize,
        /// Number of worlds from which the effect of a robot press on the belief is predicted.
        predictions: usize,
    }
}

impl HumanModel {
    /// The first parameters that contradict each other: the path of one of these parameters in a session file, what was
    /// found, and what would be right. The program checks the ranges of single parameters.
    pub fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let PerceptionModel { look_alike, anything, .. } = self.perception;
        let found = || format!("anything = {anything}, look_alike = {look_alike}");
        (look_alike + anything >= 1.0)
            .then(|| ("human.perception.anything", found(), "two numbers that are together below 1"))
    }
}
