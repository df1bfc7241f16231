//! The human model (paper, section "Human model"): the parameters of prior, perception, transition, decision and
//! signals.
//!
//! Every parameter has a default. A session file names a file with other values (`human_model = "…"`); the values in
//! use are recorded in the header of every recording.

use serde::{Deserialize, Serialize};

use super::choice_parameters::ChoiceParameters;
use super::signal_model::SignalModel;

/// All parameters of the human model, and the sample sizes of its inference.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HumanModel {
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
    /// What the estimate learns about the person in a trial.
    #[serde(skip_serializing_if = "AdaptationSettings::is_off")]
    pub adapt: AdaptationSettings,
    /// Settings of the computation that infers the belief, which are no properties of people.
    pub inference: InferenceSettings,
}

/// Which parameters the estimate adapts to the person in a trial, press by press.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct AdaptationSettings {
    /// Whether the estimate learns how often the person slips.
    pub lapse: bool,
    /// Whether the estimate learns how attentive the person is: how fast the person reads, and how often it looks. A
    /// header without the key means that it does not.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub attention: bool,
}

impl AdaptationSettings {
    /// Everything that can be adapted to the person is.
    pub const ALL: AdaptationSettings = AdaptationSettings { lapse: true, attention: true };

    /// Whether nothing is adapted to the person, in which case files and headers leave this table out.
    pub(super) fn is_off(&self) -> bool {
        *self == AdaptationSettings::default()
    }
}

/// The human's belief at the start of a trial (prior).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PriorModel {
    /// Expected probability of a location's true content; the remaining probability is spread evenly over the other
    /// contents.
    pub location_truth: f64,
    /// Precision (sum of the alphas) of the Dirichlet about a location's content.
    pub location_precision: f64,
    /// Expected probability of a dish's true recipe.
    pub recipe_truth: f64,
    /// Share of the remaining probability that goes to variants which look like the true recipe, where there are any.
    pub recipe_look_alike: f64,
    /// Precision (sum of the alphas) of the Dirichlet about a recipe: small where people are certain of one variant from
    /// the start, large where they are not before they recall it ([`TransitionModel::recall_precision`]).
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

/// Range of confidence over which the time of a gaze sample turns from unknown to known.
pub const CONFIDENCE_RAMP: f64 = 0.4;

/// Perception as a reading process: a location near the gaze is read at a rate that falls with the location's distance
/// from the gaze.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PerceptionModel {
    /// Reading rate lambda at distance 0 and full confidence, in readings per second.
    pub reading_rate_hz: f64,
    /// Time of a look, at distance 0 and full confidence, after which reading begins, in seconds: gaze that only passes
    /// reads nothing.
    pub reading_begins_s: f64,
    /// Radius r of the area around the fixation that is read, in degrees of the visual field.
    pub radius_deg: f64,
    /// Distance from the eyes to the display, in metres.
    pub viewing_distance_m: f64,
    /// Probability that a reading gives a look-alike of the true content instead of it.
    pub look_alike: f64,
    /// Probability that a reading gives any other wrong content.
    pub anything: f64,
    /// Confidence at which half of a gaze sample's time counts as known; the share that counts rises linearly over
    /// [`CONFIDENCE_RAMP`].
    pub min_confidence: f64,
    /// Length of the history of displayed states, in seconds; gaze samples taken earlier are not used.
    pub history_s: f64,
    /// Longest time that one gaze sample covers, in seconds.
    pub max_sample_s: f64,
    /// Time for which the gaze has to be elsewhere until a look at a location ends, in seconds.
    pub look_ends_s: f64,
}

impl Default for PerceptionModel {
    fn default() -> Self {
        PerceptionModel {
            reading_rate_hz: 5.0,
            reading_begins_s: 0.0,
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
    /// Radius, on the display, of the area around the fixation that is read, in metres.
    pub fn radius_m(&self) -> f64 {
        self.viewing_distance_m * self.radius_deg.to_radians().tan()
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

/// Plausible looking: where people look, in rates. The belief filter uses these rates while the gaze is unknown, the
/// planner in its rollouts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LookingModel {
    /// Looks per second at each place that the next press needs; before an item is fetched, also at the robot's hand,
    /// which may be bringing the item. Measured on unassisted simulated participants: 1.1 and 0.7.
    pub looks_hz: f64,
    /// Looks per second at each other place. Unassisted simulated participants look 0.25 to 0.4 times a second at a
    /// place that has changed more than a second ago and was not seen since.
    pub other_looks_hz: f64,
    /// Share of the changes by others that attract the gaze at once. Of simulated participants, beyond the looks above:
    /// 0.3 at the robot's hand and at places, 0.4 at orders.
    pub capture: f64,
    /// Looks per second at each place while the eye tracker does not find the display in its view, which means that the
    /// head is turned away.
    pub display_lost_looks_hz: f64,
    /// Time without known gaze that counts as a blink, in seconds: nothing is read during a blink, and its time does
    /// not count as unknown.
    pub blink_s: f64,
}

impl Default for LookingModel {
    fn default() -> Self {
        LookingModel { looks_hz: 1.0, other_looks_hz: 0.25, capture: 0.35, display_lost_looks_hz: 0.05, blink_s: 0.3 }
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

/// Transition model: how the human's belief changes without new evidence.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TransitionModel {
    /// Half-life with which a belief about a recipe decays to what is left of a forgotten one, in seconds: of how many
    /// people still hold it, or, where recipes are recalled, of its distance from that while the dish is not ordered.
    pub recipe_half_life_s: f64,
    /// Expected probability of the true recipe in what is left of a forgotten recipe: beliefs decay to it. Absent: that of
    /// the prior ([`PriorModel::recipe_truth`]), as if nothing of the instruction before the trial were forgotten.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forgotten_truth: Option<f64>,
    /// Precision with which a recipe is recalled when its dish is ordered: the belief becomes one that is drawn from a
    /// Dirichlet with the earlier belief as its mean. It is small, since people recall one version. The same happens to
    /// those who find their version wrong, as it could not be served. Absent: orders do not change what is held of
    /// recipes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recall_precision: Option<f64>,
    /// Half-life of a recalled recipe while its dish is ordered, in seconds: then the recipe is recalled anew from what is
    /// left of it. It has an effect only where `recall_precision` is set.
    pub recall_half_life_s: f64,
    /// Share of the robot's unseen presses whose consequences the human infers; the other presses leave the belief
    /// unchanged. The default is fitted to simulated participants, who mostly keep believing what they last saw.
    pub foresight: f64,
}

impl Default for TransitionModel {
    fn default() -> Self {
        TransitionModel {
            recipe_half_life_s: 200.0,
            forgotten_truth: None,
            recall_precision: None,
            recall_half_life_s: 20.0,
            foresight: 0.2,
        }
    }
}

/// Settings of the inference of the belief: from which evidence, and with which sample sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct InferenceSettings {
    /// Number of belief samples drawn from the estimate at a press.
    pub beliefs: usize,
    /// Number of worlds (state and recipes) drawn from each belief sample.
    pub states: usize,
    /// Effective sample size below which the number of belief samples is doubled.
    pub min_effective: f64,
    /// Largest number of belief samples in an update by a press.
    pub max_beliefs: usize,
    /// Number of worlds from which the effect of a robot press on the belief is predicted.
    pub predictions: usize,
}

impl Default for InferenceSettings {
    fn default() -> Self {
        InferenceSettings { beliefs: 256, states: 32, min_effective: 32.0, max_beliefs: 512, predictions: 64 }
    }
}

impl HumanModel {
    /// The first parameters that contradict each other: the path of one of these parameters in a session file, what was
    /// found, and what would be right. The ranges of single parameters are in [`crate::session::ranges`].
    pub fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let PerceptionModel { look_alike, anything, .. } = self.perception;
        let found = || format!("anything = {anything}, look_alike = {look_alike}");
        (look_alike + anything >= 1.0)
            .then(|| ("human.perception.anything", found(), "two numbers that are together below 1"))
    }
}
