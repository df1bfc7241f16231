//! The arms of a study: who sends signals by which concept, and whether the wizard sees advice.

use serde::{Deserialize, Serialize};

use crate::settings::Condition;
use tomcom_core::communication::concept::ConceptName;

/// An arm of a study. A wizard who sees the assistant's recommendations is another arm than a wizard who does not.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, strum::IntoStaticStr,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum StudyArm {
    /// Nobody sends signals.
    #[default]
    None,
    /// The wizard does not see recommendations, as in the paper.
    Wizard,
    /// The wizard sees the estimated belief and the recommendations.
    #[serde(rename = "wizard+advice")]
    #[strum(serialize = "wizard+advice")]
    WizardWithAdvice,
    /// The assistant sends signals by theory of mind with communication planning.
    TomCom,
    /// The assistant sends signals by theory of mind without planning.
    Tom,
    /// The assistant proposes the next presses after an error.
    Dev,
    /// The assistant sends the signals of an external concept.
    External,
}

named!(StudyArm);

impl StudyArm {
    /// In the order of tables.
    pub const ALL: [StudyArm; 7] = [
        StudyArm::None,
        StudyArm::Wizard,
        StudyArm::WizardWithAdvice,
        StudyArm::TomCom,
        StudyArm::Tom,
        StudyArm::Dev,
        StudyArm::External,
    ];

    /// In texts.
    pub fn title(self) -> &'static str {
        match (self.concept(), self) {
            (Some(concept), _) => concept.title(),
            (None, StudyArm::Wizard) => "wizard",
            (None, StudyArm::WizardWithAdvice) => "wizard with advice",
            (None, _) => "unassisted",
        }
    }

    pub fn condition(self) -> Condition {
        match (self.concept(), self) {
            (Some(_), _) => Condition::Assistant,
            (None, StudyArm::Wizard | StudyArm::WizardWithAdvice) => Condition::Wizard,
            (None, _) => Condition::None,
        }
    }

    /// The concept by which the assistant sends signals: title and condition of such an arm follow. `None` without an
    /// assistant.
    pub fn concept(self) -> Option<ConceptName> {
        match self {
            StudyArm::None | StudyArm::Wizard | StudyArm::WizardWithAdvice => None,
            StudyArm::TomCom => Some(ConceptName::TomCom),
            StudyArm::Tom => Some(ConceptName::Tom),
            StudyArm::Dev => Some(ConceptName::Dev),
            StudyArm::External => Some(ConceptName::External),
        }
    }

    /// `saw_advice`: whether the wizard saw recommendations.
    pub fn from_settings(condition: Condition, concept: ConceptName, saw_advice: bool) -> StudyArm {
        match condition {
            Condition::None => StudyArm::None,
            Condition::Wizard if saw_advice => StudyArm::WizardWithAdvice,
            Condition::Wizard => StudyArm::Wizard,
            // The concept that sends nothing has no arm of its own.
            Condition::Assistant => {
                StudyArm::ALL.into_iter().find(|arm| arm.concept() == Some(concept)).unwrap_or_default()
            }
        }
    }
}
