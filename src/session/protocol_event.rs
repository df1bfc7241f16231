//! The phases of a study, and the events in them around a trial.

use serde::{Deserialize, Serialize};

use super::answer_value::AnswerValue;
use super::tutorial_event::TutorialEvent;
use super::wall_display::Answering;

/// A phase of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StudyPhase {
    /// The wizard instructs the participant.
    Instruction,
    /// The participant goes through the tutorial.
    Tutorial,
    /// Practice.
    Familiarisation,
    /// A trial that counts.
    Trial,
    /// The participant answers a questionnaire.
    Questionnaire,
    /// Debriefing of the wizard.
    Debriefing,
}

impl StudyPhase {
    /// The phase's name in logs and tables.
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

    /// Whether the phase has a trial.
    pub fn has_trial(self) -> bool {
        matches!(self, StudyPhase::Trial | StudyPhase::Familiarisation)
    }
}

/// An event of the study protocol around a trial.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum ProtocolEvent {
    /// The participant consented; without consent nothing is recorded. Older recordings say only that.
    ConsentGiven {
        /// Where: by holding a button on the display, or told to the wizard, who confirmed it on the console.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        on: Option<Answering>,
        /// The text that was agreed to.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        text: Option<String>,
        /// Digest of the text.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        digest: Option<String>,
    },
    /// The next phase of the recording begins; `number` counts from 1.
    PhaseStarted {
        /// Which phase begins.
        phase: StudyPhase,
        /// Its place in the recording, counted from 1.
        number: usize,
    },
    /// A step of an instruction or debriefing, counted from 1, was ticked or unticked.
    Ticked {
        /// The step, counted from 1.
        step: usize,
        /// Whether it is done now.
        done: bool,
    },
    /// Something happens in the tutorial.
    Tutorial(TutorialEvent),
    /// An item of a questionnaire is shown.
    ItemShown {
        /// The item's name.
        item: String,
    },
    /// All answers are shown, to be confirmed.
    AnswersShown,
    /// Answer to the shown item; a later answer replaces it. The next item follows, but for sliders and choices of several.
    ItemAnswered {
        /// The item's name.
        item: String,
        /// The answer.
        answer: AnswerValue,
    },
    /// The shown item is skipped. The next item follows.
    ItemSkipped {
        /// The item's name.
        item: String,
    },
    /// The participant confirms the answers: they hold.
    AnswersConfirmed,
    /// Result of the practice, and whether it meets the criterion.
    CriterionChecked {
        /// Whether the criterion is met.
        met: bool,
        /// Orders served in the practice.
        orders: u32,
        /// The participant's presses in the practice.
        presses: u32,
        /// Of these, errors.
        errors: u32,
    },
    /// The wizard waives the criterion, for this reason.
    CriterionWaived {
        /// Why, in the wizard's words.
        reason: String,
    },
}
