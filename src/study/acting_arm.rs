//! Who sent the signals of a simulated trial: nobody, a scripted wizard, or a concept with its parameter.

use serde::Serialize;

use crate::communication::concept::ConceptName;
use crate::session::study_arm::StudyArm;

/// Sender of the signals in a simulated trial, with the parameter of its concept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ActingArm {
    /// Name of the sender: `none`, `wizard` or `wizard+advice` (scripted wizard), or a concept.
    pub concept: &'static str,
    /// Parameter of the concept: cost of communication in presses (ToM-Com), threshold (ToM), or number of proposed
    /// presses (DEV); null for other senders.
    pub parameter: Option<f64>,
}

impl ActingArm {
    /// The sender in trials of a study arm; `parameter` is that of the concept that acts in the arm.
    pub fn from_settings(arm: StudyArm, parameter: f64) -> ActingArm {
        let concept = arm.concept();
        ActingArm { concept: concept.map_or(arm.name(), ConceptName::name), parameter: concept.map(|_| parameter) }
    }

    /// Sort key of senders in tables: without signals, wizard, then the concepts by parameter.
    pub(super) fn rank(&self) -> (usize, f64) {
        let rank = StudyArm::ALL.iter().position(|arm| arm.name() == self.concept).unwrap_or(StudyArm::ALL.len());
        (rank, self.parameter.unwrap_or(0.0))
    }
}
