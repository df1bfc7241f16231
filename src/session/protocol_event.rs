//! The phases of a study, and the events in them around a trial.

use serde::{Deserialize, Serialize};

/// A phase of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StudyPhase {
    Instruction,
    /// Practice.
    Familiarisation,
    Trial,
    Questionnaire,
    /// Debriefing of the wizard.
    Debriefing,
}

impl StudyPhase {
    pub fn name(self) -> &'static str {
        match self {
            StudyPhase::Instruction => "instruction",
            StudyPhase::Familiarisation => "familiarisation",
            StudyPhase::Trial => "trial",
            StudyPhase::Questionnaire => "questionnaire",
            StudyPhase::Debriefing => "debriefing",
        }
    }

    /// Whether the phase has a trial.
    pub fn has_trial(self) -> bool {
        matches!(self, StudyPhase::Trial | StudyPhase::Familiarisation)
    }
}

/// An event of the study protocol around a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ProtocolEvent {
    /// The participant consented; without consent nothing is recorded.
    ConsentGiven,
    /// The next phase of the recording begins; `number` counts from 1.
    PhaseStarted {
        phase: StudyPhase,
        number: usize,
    },
    /// A step of an instruction or debriefing, counted from 1, was ticked or unticked.
    Ticked {
        step: usize,
        done: bool,
    },
    /// An item of a questionnaire is shown.
    ItemShown {
        item: String,
    },
    /// All answers are shown, to be confirmed.
    AnswersShown,
    /// Answer to the shown item, from 1 to the points of the scale; a later answer replaces it. The next item follows.
    ItemAnswered {
        item: String,
        answer: u8,
    },
    /// The shown item is skipped. The next item follows.
    ItemSkipped {
        item: String,
    },
    AnswersConfirmed,
    /// Result of the practice, and whether it meets the criterion.
    CriterionChecked {
        met: bool,
        orders: u32,
        presses: u32,
        errors: u32,
    },
    /// The wizard waives the criterion, for this reason.
    CriterionWaived {
        reason: String,
    },
}
