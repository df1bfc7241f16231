//! The phases of a study, and what happens in them around a trial.

use serde::{Deserialize, Serialize};

/// A phase of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StudyPhase {
    Instruction,
    /// A trial for practice.
    Familiarisation,
    Trial,
    Questionnaire,
    /// Of the wizard.
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

    /// Whether the kitchen is worked in.
    pub fn has_trial(self) -> bool {
        matches!(self, StudyPhase::Trial | StudyPhase::Familiarisation)
    }
}

/// Something that happens around a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ProtocolEvent {
    /// The participant agreed to what the plan asks; without it, there is no recording.
    ConsentGiven,
    /// The next phase of the recording begins; `number` counts from 1.
    PhaseStarted {
        phase: StudyPhase,
        number: usize,
    },
    /// A step of an instruction or debriefing, counted from 1, was done, or was not after all.
    Ticked {
        step: usize,
        done: bool,
    },
    /// An item is in front of the participant.
    ItemShown {
        item: String,
    },
    /// All answers are, to be confirmed.
    AnswersShown,
    /// The shown item, from 1 to the points of the scale; a later answer replaces it. The next item is shown then.
    ItemAnswered {
        item: String,
        answer: u8,
    },
    /// The participant gives no answer to the shown item. The next item is shown then.
    ItemSkipped {
        item: String,
    },
    AnswersConfirmed,
    /// The practice is over: how it went, and whether that meets the criterion.
    CriterionChecked {
        met: bool,
        orders: u32,
        presses: u32,
        errors: u32,
    },
    /// The wizard lets the participant go on all the same.
    CriterionWaived {
        reason: String,
    },
}
