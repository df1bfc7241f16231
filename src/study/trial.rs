//! What the analysis keeps of a trial: a few numbers, so that memory grows by a line a trial and not by recordings.

use serde::{Deserialize, Serialize};

use crate::session::settings::{Condition, ParticipantKind};

/// One trial as the analysis sees it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The folder's name.
    pub recording: String,
    /// The participant's code.
    pub participant: String,
    pub kind: ParticipantKind,
    /// The starting group of a plan, and the number of the trial in it, 1 the first.
    pub group: Option<String>,
    pub period: Option<u32>,
    pub condition: Condition,
    /// Why it is left out, if it is.
    pub excluded: Option<String>,
    pub human_presses: u64,
    pub robot_presses: u64,
    /// Errors of the human, races left out.
    pub errors: u64,
    /// None where it is not known what the human believed.
    pub beliefs: Option<Beliefs>,
    /// Seconds from one served order to the next, the first from the start.
    pub order_s: Vec<f64>,
    /// Seconds from one press of the human to the next.
    pub press_s: Vec<f64>,
    /// Signals that were shown.
    pub signals: u64,
    pub seconds: f64,
}

/// What false beliefs did in a trial.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Beliefs {
    /// Belief related errors.
    pub errors: u64,
    /// The number of errors of each sequence.
    pub lengths: Vec<u32>,
    /// The same by single aspects.
    pub lengths_by_aspect: Vec<u32>,
    /// Seconds from the first error of a sequence to the first correct press after its last, where there is one.
    pub recovery_s: Vec<f64>,
}

impl Trial {
    /// Presses of both agents.
    pub fn presses(&self) -> u64 {
        self.human_presses + self.robot_presses
    }

    /// Errors per press of the human; none without presses.
    pub fn error_rate(&self) -> Option<f64> {
        (self.human_presses > 0).then(|| self.errors as f64 / self.human_presses as f64)
    }

    /// Whether somebody sends signals in it.
    pub fn is_assisted(&self) -> bool {
        self.condition != Condition::None
    }
}
