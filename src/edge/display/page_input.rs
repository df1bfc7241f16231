//! Inputs to the session from the participant page that takes part.

use std::time::Instant;

use serde::Deserialize;

use tomcom_session::questionnaire::AnswerValue;

/// An input to the session from the participant page that takes part.
#[derive(Clone, Debug, PartialEq)]
pub enum PageInput {
    /// A participant page is connected and takes part.
    Connected {
        /// Width of the participant's page in pixels.
        width_px: u32,
        /// Height of the participant's page in pixels.
        height_px: u32,
    },
    /// The participant's page is disconnected.
    Lost,
    /// A press of a kitchen button on the participant's page.
    Press {
        /// Name of the pressed kitchen button.
        button: String,
        /// Time of the press, on this computer's clock.
        at: Instant,
    },
    /// Position of the mouse pointer, in fractions of the display.
    Pointer {
        /// Horizontal position of the pointer, as a fraction of the display's width.
        x: f64,
        /// Vertical position of the pointer, as a fraction of the display's height, downwards.
        y: f64,
    },
    /// What the participant does on the page apart from the task: consent, answers, tutorial pages.
    Reply(ParticipantResponse),
    /// Report that the page has drawn a frame with an event such as a signal.
    Drawn {
        /// Sequence number of the event that was drawn.
        cue: u64,
        /// Time of the drawing, on this computer's clock.
        at: Instant,
    },
}

/// What the participant does on the page apart from the task: consents, answers a questionnaire or a freeze probe,
/// reads the tutorial.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ParticipantResponse {
    /// Answer to a questionnaire item, or leaving it unanswered.
    Answer {
        /// Name of the questionnaire item.
        item: String,
        /// The answer to the questionnaire item; `None` leaves the item unanswered.
        answer: Option<AnswerValue>,
    },
    /// Going on to the next questionnaire item, or to the list of all answers.
    Next,
    /// Return to an earlier questionnaire item.
    Back {
        /// Name of the questionnaire item.
        item: String,
    },
    /// The participant presses or releases the consent button.
    Hold {
        /// Whether the button is held from now on.
        held: bool,
    },
    /// Consent of the participant, who held the consent button for as long as the page asks. It counts if the program
    /// was told of the hold, and it lasted that long.
    Consent,
    /// Confirmation of all questionnaire answers.
    Confirm,
    /// Turning the tutorial's page forward or back.
    Turn {
        /// Id of the tutorial step that is shown.
        step: String,
        /// Whether the participant turns to the next tutorial step; false: to the previous one.
        forward: bool,
    },
    /// Answer to the question of a tutorial step.
    Choose {
        /// Id of the tutorial step.
        step: String,
        /// Number of the chosen answer to the tutorial's question, counted from 1.
        choice: u8,
    },
    /// The recipe cards of a tutorial step have been shown for their set time.
    CardsShown {
        /// Id of the tutorial step.
        step: String,
    },
    /// Answer to a freeze probe's question: a choice, or a stack of items; with neither, "I don't know".
    Believe {
        /// Number of the freeze probe.
        probe: u32,
        /// Number of the question in the freeze probe, counted from 1.
        question: u32,
        /// Number of the chosen answer to the probe's question, counted from 1.
        choice: Option<u16>,
        /// Names of the items of which the answered stack consists.
        items: Vec<String>,
        /// How sure the participant is of the answer, from 1 to 3; `None` if that is not asked.
        sure: Option<u8>,
    },
}
