//! Settings of the assistant and its planner in a session file.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

use super::concept::{BenefitUnit, ConceptName};
use crate::base::settings_table;
use crate::mind::model::LookingModel;

settings_table! {
    /// Settings of the assistant, which recommends or sends signals.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    AssistantSpec {
        /// Whether the assistant computes recommendations in trials in which the assistant does not send signals.
        shadow: ShadowMode = ShadowMode::On,
        /// The communication concept by which the assistant decides which signals to send.
        concept: ConceptSpec = ConceptSpec::Own(ConceptName::TomCom),
        /// Cost of communication in presses: the expected saving of a signal must exceed this cost (1.5 in the paper).
        cost_of_communication: f64 = 1.5,
        /// Threshold of the concept ToM: expected belief deviation, a probability, above which ToM sends a signal.
        // The default threshold is equal to that in the definition of a false belief.
        belief_threshold: f64 = 0.5,
        /// Number of presses that the concept DEV proposes after an error.
        proposed_presses: usize = 1,
        /// Whether the assistant of a live session works ahead between requests for advice, which makes the answers come
        /// sooner, and changes nothing else.
        works_ahead: bool = true,
        /// Settings of the planner's rollouts: how finely the planner computes.
        rollout: RolloutSettings = RolloutSettings::default(),
    }
}

/// The choice of a communication concept: the name of one of the program's, or a program of somebody else.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ConceptSpec {
    /// A concept of the program, by its name.
    Own(ConceptName),
    /// An external concept: a program that answers over a pipe or a socket.
    External(ExternalMind),
}

/// A program that answers as a concept or as a participant: `{ external = "python my_agent.py" }`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExternalMind {
    /// Command line, which the shell runs where the program runs; or `tcp://127.0.0.1:PORT` of a program that listens on
    /// this computer.
    pub external: String,
    /// Whether a concept is told the estimate of the participant's belief.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub estimate: bool,
    /// Longest wait for an answer where nothing else goes on meanwhile, in seconds; at the console, silence from which
    /// on the wizard is told.
    #[serde(default = "usual_wait_s")]
    pub wait_s: f64,
}

fn usual_wait_s() -> f64 {
    10.0
}

impl ExternalMind {
    /// The program behind this command line or address, with the usual settings.
    pub fn new(external: impl Into<String>) -> ExternalMind {
        ExternalMind { external: external.into(), estimate: false, wait_s: usual_wait_s() }
    }
}

impl ConceptSpec {
    /// The concept in the table of concepts.
    pub fn name(&self) -> ConceptName {
        match self {
            ConceptSpec::Own(name) => *name,
            ConceptSpec::External(_) => ConceptName::External,
        }
    }

    /// What the user calls the concept: its name, or the external program's command line or address.
    pub fn label(&self) -> &str {
        match self {
            ConceptSpec::Own(name) => name.name(),
            ConceptSpec::External(mind) => &mind.external,
        }
    }
}

impl From<ConceptName> for ConceptSpec {
    fn from(name: ConceptName) -> ConceptSpec {
        ConceptSpec::Own(name)
    }
}

impl PartialEq<ConceptName> for ConceptSpec {
    fn eq(&self, name: &ConceptName) -> bool {
        self.name() == *name
    }
}

impl<'de> Deserialize<'de> for ConceptSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ConceptSpec, D::Error> {
        deserializer.deserialize_any(ConceptVisitor)
    }
}

/// Reads a concept's name or the table of an external concept, and keeps the error messages of each.
struct ConceptVisitor;

impl<'de> Visitor<'de> for ConceptVisitor {
    type Value = ConceptSpec;

    fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
        to.write_str("the name of a concept, or { external = \"COMMAND\" }")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<ConceptSpec, E> {
        if name == ConceptName::External.name() {
            return Err(E::custom("found \"external\", and no program: { external = \"COMMAND\" } names one"));
        }
        ConceptName::deserialize(StrDeserializer::<E>::new(name)).map(ConceptSpec::Own)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ConceptSpec, A::Error> {
        ExternalMind::deserialize(MapAccessDeserializer::new(map)).map(ConceptSpec::External)
    }
}

/// Whether the assistant computes recommendations in conditions in which the assistant does not send signals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ShadowMode {
    /// The assistant computes recommendations in all trials; the wizard may see them.
    #[default]
    On,
    /// The assistant computes nothing in trials in which the assistant does not send signals.
    Off,
}

settings_table! {
    /// Settings of the planner's rollouts.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields)]
    RolloutSettings {
        /// Horizon of a rollout: number of the human's decisions.
        horizon: usize = 8,
        /// Largest number of paired rollouts per signal.
        rollouts: usize = 256,
        /// Number of worlds drawn from each belief sample in a rollout.
        states: usize = 32,
        /// Time between two presses of the human in a rollout, in seconds.
        human_press_s: f64 = 2.0,
        /// Looks per second in rollouts at places that the next press needs, if not as in the human model: see
        /// [`LookingModel`].
        #[serde(skip_serializing_if = "Option::is_none")]
        looks_hz: Option<f64> = None,
        /// Looks per second in rollouts at places that the next press does not need, if the rate differs from that of the
        /// human model.
        #[serde(skip_serializing_if = "Option::is_none")]
        other_looks_hz: Option<f64> = None,
        /// Share of the changes by others that attract the gaze at once in rollouts, if the share differs from that of the
        /// human model.
        #[serde(skip_serializing_if = "Option::is_none")]
        capture: Option<f64> = None,
        /// Standard error of a signal's benefit at which its rollouts end, in presses; twice this is enough if the net
        /// benefit differs from zero by three standard errors.
        enough_error: f64 = 0.08,
        /// Least number of paired rollouts per signal.
        least_rollouts: usize = 32,
    }
}

impl RolloutSettings {
    /// The looking model of rollouts: that of the human model, with the rates that the settings of the rollouts name.
    pub fn looking(&self, human: &LookingModel) -> LookingModel {
        LookingModel {
            looks_hz: self.looks_hz.unwrap_or(human.looks_hz),
            other_looks_hz: self.other_looks_hz.unwrap_or(human.other_looks_hz),
            capture: self.capture.unwrap_or(human.capture),
            ..human.clone()
        }
    }
}

impl AssistantSpec {
    /// The value that a signal's benefit must exceed: the cost of communication in presses, or the threshold of ToM.
    pub fn price(&self) -> f64 {
        match self.concept.name().unit() {
            BenefitUnit::Deviation => self.belief_threshold,
            BenefitUnit::Presses | BenefitUnit::None => self.cost_of_communication,
        }
    }

    /// The parameter that is varied when concepts are compared: the cost of communication, the threshold of ToM, or the
    /// number of presses that DEV proposes.
    pub fn parameter(&self) -> f64 {
        match self.concept.name() {
            ConceptName::Dev => self.proposed_presses as f64,
            ConceptName::TomCom | ConceptName::Tom | ConceptName::None | ConceptName::External => self.price(),
        }
    }
}
