//! The phases of a study, and the events of the study protocol around a trial.

use serde::{Deserialize, Serialize};

use super::answer_value::AnswerValue;
use super::tutorial_event::TutorialEvent;
use super::wall_display::AnswerDevice;

/// A phase of a study, such as instruction, trial or questionnaire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StudyPhase {
    /// The wizard instructs the participant.
    Instruction,
    /// The participant goes through the tutorial on the display.
    Tutorial,
    /// Practice trial (familiarisation), which does not count for the analysis.
    Familiarisation,
    /// A trial that counts for the analysis.
    Trial,
    /// The participant answers a questionnaire.
    Questionnaire,
    /// The wizard debriefs the participant after the last trial.
    Debriefing,
}

impl StudyPhase {
    /// The study phase's name in logs and tables.
    pub fn name(self) -> &'static str {
        match self {
            StudyPhase::Instruction => "instruction",
            StudyPhase::Tutorial => "tutorial",
            StudyPhase::Familiarisation => "familiarisation",
            StudyPhase::Trial => "trial",
            StudyPhase::Questionnaire => "questionnaire",
            StudyPhase::Debriefing => "debriefing",
        }
    }

    /// Whether the study phase contains a trial (practice or counted).
    pub fn has_trial(self) -> bool {
        matches!(self, StudyPhase::Trial | StudyPhase::Familiarisation)
    }
}

/// An event of the study protocol around a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ProtocolEvent {
    /// The participant consented; without consent nothing is recorded. Older recordings contain only that consent was
    /// given.
    ConsentGiven {
        /// How the participant consented: by holding a button on the display, or by telling the wizard, who confirmed
        /// it on the console.
        on: AnswerDevice,
        /// The text to which the participant consented.
        text: String,
        /// Digest of the consent text.
        digest: String,
    },
    /// The next phase of the recording begins.
    PhaseStarted {
        /// The kind of the study phase that begins.
        phase: StudyPhase,
        /// Number of the phase in the recording, counted from 1.
        number: usize,
    },
    /// The wizard ticked or unticked a step of an instruction or debriefing.
    Ticked {
        /// Number of the step in the instruction or debriefing, counted from 1.
        step: usize,
        /// Whether the step of the instruction or debriefing is done now.
        done: bool,
    },
    /// An event of the participant's tutorial.
    Tutorial(TutorialEvent),
    /// An item of the questionnaire is shown.
    ItemShown {
        /// Identifier of the questionnaire item.
        item: String,
    },
    /// All answers to the questionnaire are shown, for the participant to confirm them.
    AnswersShown,
    /// The participant answered the shown questionnaire item; a later answer replaces an earlier one. The next item
    /// follows at once, except after sliders and choices of several options.
    ItemAnswered {
        /// Identifier of the questionnaire item.
        item: String,
        /// The participant's answer to the questionnaire item.
        answer: AnswerValue,
    },
    /// The shown item of the questionnaire is skipped, and the next item follows.
    ItemSkipped {
        /// Identifier of the questionnaire item.
        item: String,
    },
    /// The participant confirms the answers to the questionnaire, which become final.
    AnswersConfirmed,
    /// Result of the practice trial, and whether it meets the criterion.
    CriterionChecked {
        /// Whether the practice trial meets the criterion.
        met: bool,
        /// Number of orders served in the practice trial.
        orders: u32,
        /// Number of the participant's presses in the practice trial.
        presses: u32,
        /// Number of errors among the participant's presses in the practice trial.
        errors: u32,
    },
    /// The wizard waives the criterion of the practice trial, for this reason.
    CriterionWaived {
        /// The wizard's reason for waiving the criterion.
        reason: String,
    },
}
