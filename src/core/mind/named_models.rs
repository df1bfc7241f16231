//! The human models that the program has by name, with all their values.
//!
//! `plain` is the default. It is not fitted to anybody; a laboratory fits it to people of its own (`tomcom fit`).
//! `paper-2021` has the equations of Buehler, Adamy and Weisswange (2021); values that the paper does not give are those
//! of `plain`. `docs/paper.md` lists what differs.

use serde_json::Value;

use super::choice_parameters::ChoiceParameters;
use super::model::{
    GivenHumanModel, HumanModel, HumanModelName, InferenceSettings, LookingModel, PerceptionModel, PerceptionUnit,
    PriorModel, TransitionModel,
};
use super::signal_model::SignalModel;

/// The half-life of beliefs about recipes with which nothing is forgotten, in seconds.
pub const NEVER_FORGOTTEN_S: f64 = 1e18;

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

/// Collects the paths at which two values differ.
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

/// The default of each table is that of the default model.
macro_rules! defaults {
    ($($table:ident: $field:ident,)*) => {
        $(impl Default for $table {
            fn default() -> $table {
                PLAIN.$field
            }
        })*
    };
}

defaults! {
    PriorModel: prior,
    PerceptionModel: perception,
    LookingModel: looking,
    TransitionModel: transition,
    ChoiceParameters: decision,
    SignalModel: signal,
    InferenceSettings: inference,
}

impl Default for HumanModel {
    fn default() -> HumanModel {
        PLAIN
    }
}
