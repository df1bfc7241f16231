//! The human model (paper, section "Human model"): the parameters of prior, perception, transition, decision and
//! signals; and the models that the program has by name.
//!
//! A session names a model, and may set single parameters on top of it, or name a file with such parameters
//! (`human_model = "…"`); the values in use are recorded in the header of every recording.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::choice::{ChoiceParameters, GivenChoice};
use crate::kitchen::{Kitchen, LocationId, LocationKind};

// A file names a model and may give single parameters on top of it. So every table of parameters has a twin in which each
// parameter may be missing; what is missing is taken from the named model.

/// Declares a table of parameters, its twin of which a file gives some, and as its default the field of the default model.
macro_rules! model_table {
    (
        $(#[$about:meta])*
        $table:ident, $given:ident, $field:ident {
            $($(#[$meaning:meta])* $parameter:ident: $kind:ty,)*
        }
    ) => {
        $(#[$about])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize)]
        pub struct $table {
            $($(#[$meaning])* pub $parameter: $kind,)*
        }

        #[doc = concat!("The parameters that a file gives of [`", stringify!($table), "`].")]
        #[derive(Clone, Debug, Default, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $given {
            $($parameter: Option<$kind>,)*
        }

        impl $given {
            /// The table of a model with the given parameters in their places.
            pub fn on(self, model: $table) -> $table {
                $table { $($parameter: self.$parameter.unwrap_or(model.$parameter),)* }
            }
        }

        impl Default for $table {
            fn default() -> $table {
                $crate::mind::model::PLAIN.$field
            }
        }
    };
}

pub(crate) use model_table;

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
    /// The named model, which gives the parameters that the file does not give.
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
    PriorModel, GivenPrior, prior {
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
pub(crate) const CONFIDENCE_RAMP: f64 = 0.4;

model_table! {
    /// Perception: how gaze near a location becomes an observation of the location's content.
    PerceptionModel, GivenPerception, perception {
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
        /// `CONFIDENCE_RAMP`. Where samples are observations: the least confidence of a sample that is used.
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
    pub(crate) fn rate_of(&self, full_hz: f64) -> LocationReadingRate {
        LocationReadingRate { full_hz, spread_m2: 2.0 * self.radius_m() * self.radius_m() }
    }
}

model_table! {
    /// Plausible looking: where people look, in rates. The belief filter uses these rates while the gaze is unknown,
    /// the planner in its rollouts.
    LookingModel, GivenLooking, looking {
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
    TransitionModel, GivenTransition, transition {
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
    InferenceSettings, GivenInference, inference {
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

/// Upper bound of probabilities that a signal is noticed where signals take time: a signal certain to be noticed could
/// not be missed.
const MOST_NOTICED: f64 = 0.999;

model_table! {
    /// The effect of a signal on the human.
    ///
    /// With `delay_s` = 0 a signal is believed at once with the probability `noticed`. Otherwise a signal is read while
    /// it stands on the display, and may be missed.
    SignalModel, GivenSignal, signal {
        /// Probability that a signal is noticed. Where signals take time: that a signal which stands for long is
        /// noticed under unknown gaze.
        noticed: f64,
        /// Probability that a highlight is noticed, if it differs from that of a shown recipe.
        #[serde(skip_serializing_if = "Option::is_none")]
        highlight_noticed: Option<f64>,
        /// Mean time until somebody who notices a signal reads it, in seconds after its beginning; 0: signals are
        /// believed at once.
        delay_s: f64,
        /// Readings per second of a signal while the gaze is known to be at its place, at distance 0 and with full
        /// confidence.
        reading_rate_hz: f64,
        /// Probability that somebody who reads a signal takes it for any of the other values.
        misread: f64,
        /// Probability that the human presses what the display proposes because it is proposed. Nobody has measured
        /// this probability; 0.7 stands for a person who notices most proposals and makes most of them.
        follows: f64,
    }
}

impl SignalModel {
    /// Whether signals take time to be read, and can be missed; otherwise signals are believed at once.
    pub fn takes_time(&self) -> bool {
        self.delay_s > 0.0
    }

    pub(crate) fn noticed_at(&self, kind: LocationKind) -> f64 {
        match kind {
            LocationKind::Order => self.noticed,
            _ => self.highlight_noticed.unwrap_or(self.noticed),
        }
    }

    /// Hazard that a signal is read under unknown gaze between two times since its beginning, in seconds, by somebody
    /// who notices it with the probability `noticed`: over all time, 1 - exp(-hazard) = `noticed`. Hazards of parts add
    /// up.
    pub(crate) fn reading_hazard(&self, noticed: f64, from_s: f64, until_s: f64) -> f64 {
        let waits = |time_s: f64| (-time_s.max(0.0) / self.delay_s).exp();
        -(-noticed.min(MOST_NOTICED)).ln_1p() * (waits(from_s) - waits(until_s)).max(0.0)
    }

    /// Distribution over the `values` values of an aspect that a reader takes a signal about it for; `truth` is the
    /// true value.
    pub fn understood(&self, truth: usize, values: usize) -> impl Iterator<Item = f64> + use<> {
        let misread = if values > 1 { self.misread } else { 0.0 };
        let each_other = misread / values.saturating_sub(1).max(1) as f64;
        (0..values).map(move |value| if value == truth { 1.0 - misread } else { each_other })
    }
}

/// Forecast of how a signal that is shown now will be read, which the planner assumes in its rollouts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignalReadingForecast {
    /// Probability that a recipe shown now is read and understood.
    pub recipe: f64,
    /// Probability that a highlight shown now is read and understood.
    pub highlight: f64,
    /// Time from the beginning of the signal until the participant reads it, in seconds.
    pub delay_s: f64,
}

impl Default for SignalReadingForecast {
    /// By default everybody believes a signal at once.
    fn default() -> Self {
        SignalReadingForecast { recipe: 1.0, highlight: 1.0, delay_s: 0.0 }
    }
}

impl SignalReadingForecast {
    /// Probability that a signal about a location of this kind is read and understood.
    pub fn probability(&self, kind: LocationKind) -> f64 {
        match kind {
            LocationKind::Order => self.recipe,
            _ => self.highlight,
        }
    }
}

// The models by name. `plain` is the default. It is not fitted to anybody; a laboratory fits it to people of its own
// (`tomcom fit`). `paper-2021` has the equations of Buehler, Adamy and Weisswange (2021); values that the paper does not
// give are those of `plain`. `docs/paper.md` lists what differs.

/// The half-life of beliefs about recipes with which nothing is forgotten, in seconds.
pub(crate) const NEVER_FORGOTTEN_S: f64 = 1e18;

/// The model `plain`.
pub const PLAIN: HumanModel = HumanModel {
    model: HumanModelName::Plain,
    prior: PriorModel {
        location_truth: 0.9,
        location_precision: 10.0,
        recipe_truth: 0.8,
        recipe_look_alike: 0.6,
        recipe_precision: 0.6,
    },
    perception: PerceptionModel {
        observation: PerceptionUnit::Look,
        reading_rate_hz: 5.0,
        radius_deg: 2.0,
        viewing_distance_m: 2.0,
        look_alike: 0.04,
        anything: 0.01,
        min_confidence: 0.6,
        history_s: 0.5,
        max_sample_s: 1.0 / 15.0,
        look_ends_s: 0.1,
    },
    looking: LookingModel {
        marginalised: true,
        looks_hz: 1.0,
        other_looks_hz: 0.25,
        capture: 0.35,
        display_lost_looks_hz: 0.05,
        blink_s: 0.3,
    },
    transition: TransitionModel { recipe_half_life_s: 200.0, foresight: 0.2 },
    decision: ChoiceParameters { tau: 4.0, lapse: 0.03, lapse_anywhere: 0.3, wait_cost: 0.5, cases: 32 },
    signal: SignalModel {
        noticed: 0.85,
        highlight_noticed: None,
        delay_s: 1.0,
        reading_rate_hz: 3.0,
        misread: 0.0,
        follows: 0.7,
    },
    inference: InferenceSettings { beliefs: 256, states: 32, min_effective: 32.0, max_beliefs: 512, predictions: 64 },
};

/// The model `paper-2021`.
pub const PAPER_2021: HumanModel = HumanModel {
    model: HumanModelName::Paper2021,
    perception: PerceptionModel { observation: PerceptionUnit::Sample, ..PLAIN.perception },
    looking: LookingModel { marginalised: false, ..PLAIN.looking },
    transition: TransitionModel { recipe_half_life_s: NEVER_FORGOTTEN_S, foresight: 1.0 },
    decision: ChoiceParameters { lapse: 1e-6, ..PLAIN.decision },
    signal: SignalModel { noticed: 1.0, delay_s: 0.0, ..PLAIN.signal },
    ..PLAIN
};

impl HumanModelName {
    /// The model with this name.
    pub fn model(self) -> HumanModel {
        match self {
            HumanModelName::Plain => PLAIN,
            HumanModelName::Paper2021 => PAPER_2021,
        }
    }
}

impl From<GivenHumanModel> for HumanModel {
    fn from(given: GivenHumanModel) -> HumanModel {
        let model = given.model.model();
        given.on(model)
    }
}

impl HumanModel {
    /// The model's name, with what differs from the named model: `paper-2021; decision.tau = 3.0, not 4.0`.
    pub fn named(&self) -> String {
        [vec![self.model.name().to_string()], self.differences()].concat().join("; ")
    }

    /// What differs from the named model: for each such parameter a text like `decision.tau = 8.0, not 4.0`.
    pub fn differences(&self) -> Vec<String> {
        let mut found = Vec::new();
        let [own, named] = [self, &self.model.model()].map(|model| serde_json::to_value(model).unwrap_or_default());
        differ(&own, &named, "", &mut found);
        found
    }
}

fn differ(own: &Value, named: &Value, path: &str, found: &mut Vec<String>) {
    let (Value::Object(own), Value::Object(named)) = (own, named) else {
        if own != named {
            let told = |value: &Value| if value.is_null() { "nothing".to_string() } else { value.to_string() };
            found.push(format!("{path} = {}, not {}", told(own), told(named)));
        }
        return;
    };
    let only_named = named.keys().filter(|key| !own.contains_key(*key));
    for key in own.keys().chain(only_named) {
        let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let of = |table: &serde_json::Map<String, Value>| table.get(key).cloned().unwrap_or_default();
        differ(&of(own), &of(named), &inner, found);
    }
}

impl Default for HumanModel {
    fn default() -> HumanModel {
        PLAIN
    }
}
