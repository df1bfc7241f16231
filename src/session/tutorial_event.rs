//! The events of the participant's tutorial.

use serde::{Deserialize, Serialize};

/// Who turned a page of a tutorial: participant or wizard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialPageTurner {
    /// The participant, who can turn the tutorial's page only when its step is done.
    Participant,
    /// The wizard, who may skip a step of the tutorial.
    Wizard,
}

impl TutorialPageTurner {
    /// Name of the one who turned the tutorial's page (participant or wizard) in logs.
    pub fn name(self) -> &'static str {
        match self {
            TutorialPageTurner::Participant => "participant",
            TutorialPageTurner::Wizard => "wizard",
        }
    }
}

/// An event of a tutorial. Presses in a tutorial act on a kitchen of the tutorial's own: such presses are no presses of
/// a trial, and no evidence of beliefs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum TutorialEvent {
    /// A step of the tutorial is shown.
    Shown {
        /// Identifier of the tutorial step.
        step: String,
        /// Who turned the tutorial's page.
        by: TutorialPageTurner,
    },
    /// The participant pressed a button in the shown step of the tutorial.
    Pressed {
        /// Name of the pressed button.
        button: String,
    },
    /// The set time of the tutorial's recipe cards is over: they disappear.
    CardsHidden {
        /// Identifier of the tutorial step.
        step: String,
    },
    /// The participant answered the question of the tutorial step.
    Answered {
        /// Identifier of the tutorial step.
        step: String,
        /// Number of the participant's choice, counted from 1.
        choice: u8,
    },
    /// The tutorial is over: the participant read its last step, or the wizard skipped the rest.
    Ended {
        /// Who ended the tutorial.
        by: TutorialPageTurner,
    },
}
