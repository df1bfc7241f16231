//! The communication concepts behind one interface: each advises beside a wizard, answers for a recording, or acts by itself.
//!
//! The wizard is what they are compared with, and no concept: what a person did stands in the log.

use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::Signal;
use super::dev::DevConcept;
use super::planner::Planner;
use super::recommendation::Recommendation;
use super::settings::AssistantSpec;
use super::situation::Situation;
use super::tom::TomConcept;
use crate::base::time::SessionTime;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::model::HumanModel;

/// What decides what the assistant says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConceptName {
    /// Theory of mind with communication planning: what saves more presses than a signal costs.
    #[default]
    TomCom,
    /// Theory of mind alone: what is believed wrong surely enough.
    Tom,
    /// Deviation based: after an error, the next good presses.
    Dev,
    /// Nothing is said.
    None,
}

impl ConceptName {
    /// All of them.
    pub const ALL: [ConceptName; 4] = [ConceptName::TomCom, ConceptName::Tom, ConceptName::Dev, ConceptName::None];

    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            ConceptName::TomCom => "tom-com",
            ConceptName::Tom => "tom",
            ConceptName::Dev => "dev",
            ConceptName::None => "none",
        }
    }

    /// As it is written in texts.
    pub fn title(self) -> &'static str {
        match self {
            ConceptName::TomCom => "ToM-Com",
            ConceptName::Tom => "ToM",
            ConceptName::Dev => "DEV",
            ConceptName::None => "no concept",
        }
    }
}

/// A moment at which something could be said.
#[derive(Clone, Copy, Debug)]
pub struct DecisionPoint<'a> {
    /// The number and the time of the event that brought it about.
    pub seq: u64,
    pub time: SessionTime,
    /// Presses of both agents so far. Chance follows from their number, so that nothing else that is recorded changes it.
    pub presses: u32,
    pub situation: Situation<'a>,
    /// What may be said; what is no use saying again is not among it.
    pub signals: &'a [Signal],
    /// The number of the human's last press, if that was an error.
    pub error: Option<u64>,
}

/// A way to decide what to say and when. The answer follows from the moment and the settings alone; what is remembered from
/// one moment to the next changes the time that it takes, and nothing else.
pub trait Concept: fmt::Debug + Send {
    /// What to say now, if anything, what else could be said, and why.
    fn advise(&mut self, cost: &mut CostToGo, moment: &DecisionPoint) -> Recommendation;
}

/// The concept of this name with the settings of a session. Chance follows from `seed` and the moment's presses.
pub fn concept(
    name: ConceptName,
    kitchen: Arc<Kitchen>,
    human: &HumanModel,
    spec: &AssistantSpec,
    seed: u64,
) -> Box<dyn Concept> {
    match name {
        ConceptName::TomCom => Box::new(Planner::new(kitchen, human, spec.clone(), seed)),
        ConceptName::Tom => Box::new(TomConcept::new(kitchen, spec.belief_threshold)),
        ConceptName::Dev => Box::new(DevConcept::new(kitchen, spec.proposed_presses)),
        ConceptName::None => Box::new(SilentConcept),
    }
}

/// Says nothing: the unassisted condition as a concept.
#[derive(Clone, Copy, Debug)]
pub struct SilentConcept;

impl Concept for SilentConcept {
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        Recommendation::silent(moment.seq, moment.time)
    }
}
