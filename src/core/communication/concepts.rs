//! Creates communication concepts by their names.

use std::sync::Arc;

use super::concept::{Concept, DecisionPoint};
use super::concept_name::ConceptName;
use super::dev::DevConcept;
use super::planner::Planner;
use super::recommendation::Recommendation;
use super::settings::AssistantSpec;
use super::tom::TomConcept;
use crate::kitchen::Kitchen;
use crate::kitchen::cost_to_go::CostToGo;
use crate::mind::model::HumanModel;

/// Creates the communication concept with this name and the settings of a session. `seed` and the number of presses
/// seed the concept's random stream.
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

/// The concept that never sends a signal, used in the unassisted condition.
#[derive(Clone, Copy, Debug)]
pub struct SilentConcept;

impl Concept for SilentConcept {
    fn advise(&mut self, _: &mut CostToGo, moment: &DecisionPoint) -> Recommendation {
        Recommendation::silent(moment.seq, moment.time)
    }
}
