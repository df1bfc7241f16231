//! Who sent the signals of a simulated trial: nobody, a scripted wizard, or a concept with its parameter.

use serde::{Deserialize, Deserializer, Serialize, de};

use tomcom_core::communication::concept::ConceptName;
use tomcom_session::study_arm::StudyArm;

/// Name of the sender of a simulated trial's signals: a study arm's name, or a concept's.
pub type SignalSenderName = &'static str;

/// Sender of the signals in a simulated trial, with the parameter of the sender's concept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalSenderWithParameter {
    /// Name of the sender: `none`, `wizard` or `wizard+advice` (scripted wizard), or a concept.
    #[serde(deserialize_with = "actor")]
    pub concept: SignalSenderName,
    /// Parameter of the concept: cost of communication in presses (ToM-Com), threshold (ToM), or number of proposed
    /// presses (DEV); null for senders that are no concept.
    pub parameter: Option<f64>,
}

impl SignalSenderWithParameter {
    /// The sender of signals in trials of a study arm; `parameter` is that of the concept that acts in the arm.
    pub fn from_settings(arm: StudyArm, parameter: f64) -> SignalSenderWithParameter {
        let concept = arm.concept();
        SignalSenderWithParameter {
            concept: concept.map_or(arm.name(), ConceptName::name),
            parameter: concept.map(|_| parameter),
        }
    }

    /// Sort key of senders in tables: nobody first, then the wizard, then the concepts by parameter.
    pub(super) fn rank(&self) -> (usize, f64) {
        let rank = StudyArm::ALL.iter().position(|arm| arm.name() == self.concept).unwrap_or(StudyArm::ALL.len());
        (rank, self.parameter.unwrap_or(0.0))
    }
}

/// Reads who sent the signals, from the name of a study arm or of a concept.
fn actor<'de, D: Deserializer<'de>>(input: D) -> Result<SignalSenderName, D::Error> {
    let name = String::deserialize(input)?;
    let arms = StudyArm::ALL.into_iter().map(StudyArm::name);
    let mut known = arms.chain(ConceptName::ALL.into_iter().map(ConceptName::name));
    known.find(|known| *known == name).ok_or_else(|| de::Error::custom(format!("the unknown sender \"{name}\"")))
}
