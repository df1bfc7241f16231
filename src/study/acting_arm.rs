//! Who sent the signals of a trial without a person: nobody, a script, or a concept with its parameter.

use serde::Serialize;

use crate::communication::concept::ConceptName;
use crate::session::settings::Condition;

/// Who sent the signals of a trial by itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ActingArm {
    /// `none`, `wizard` (a script), or the name of a concept.
    pub concept: &'static str,
    /// The concept's parameter: cost of communication in presses, or threshold; null for the others.
    pub parameter: Option<f64>,
}

impl ActingArm {
    /// The arm of a trial with this condition, and the assistant's concept and parameter. `None` for DEV, whose proposals are not
    /// shown to participants.
    pub fn from_settings(condition: Condition, concept: ConceptName, parameter: f64) -> Option<ActingArm> {
        match (condition, concept) {
            (Condition::Assistant, ConceptName::Dev) => None,
            (Condition::Assistant, ConceptName::TomCom | ConceptName::Tom) => {
                Some(ActingArm { concept: concept.name(), parameter: Some(parameter) })
            }
            (Condition::Wizard, _) => Some(ActingArm { concept: "wizard", parameter: None }),
            (Condition::None, _) | (Condition::Assistant, ConceptName::None) => {
                Some(ActingArm { concept: ConceptName::None.name(), parameter: None })
            }
        }
    }

    /// Order of arms in tables: without signals, wizard, then the concepts by parameter.
    pub(super) fn rank(&self) -> (usize, f64) {
        let names = ["none", "wizard", ConceptName::TomCom.name(), ConceptName::Tom.name()];
        let rank = names.iter().position(|name| *name == self.concept).unwrap_or(names.len());
        (rank, self.parameter.unwrap_or(0.0))
    }
}
