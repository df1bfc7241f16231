//! The events of a tutorial.

use serde::{Deserialize, Serialize};

/// Who turns a page of a tutorial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TutorialReader {
    /// The participant, who goes on only when a step is done.
    Participant,
    /// The wizard, who may leave out a step.
    Wizard,
}

impl TutorialReader {
    /// Name in logs.
    pub fn name(self) -> &'static str {
        match self {
            TutorialReader::Participant => "participant",
            TutorialReader::Wizard => "wizard",
        }
    }
}

/// What happens in a tutorial. Its presses act on a kitchen of its own: they are no presses of a trial, and no evidence of beliefs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "did", rename_all = "snake_case")]
pub enum TutorialEvent {
    /// A step is shown.
    Shown {
        /// The step's id.
        step: String,
        /// Who turned the page.
        by: TutorialReader,
    },
    /// The participant pressed a button in it.
    Pressed {
        /// The button's name.
        button: String,
    },
    /// The set time of the recipe cards is over: they vanish.
    CardsHidden {
        /// The step's id.
        step: String,
    },
    /// The participant answered the question of the step.
    Answered {
        /// The step's id.
        step: String,
        /// The choice, counted from 1.
        choice: u8,
    },
    /// The tutorial is over: the participant read its last step, or the wizard skipped the rest.
    Ended {
        /// Who ended it.
        by: TutorialReader,
    },
}
