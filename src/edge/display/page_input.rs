//! Inputs of the acting page for the session.

use std::time::Instant;

use serde::Deserialize;

use crate::session::answer_value::AnswerValue;

/// An input of the acting page.
#[derive(Clone, Debug, PartialEq)]
pub enum PageInput {
    /// The page is connected, with this size in pixels.
    Connected {
        /// Width of the page in pixels.
        width_px: u32,
        /// Height of the page in pixels.
        height_px: u32,
    },
    /// The page is gone.
    Lost,
    /// A press at this instant.
    Press {
        /// The button's name.
        button: String,
        /// When, by this computer's clock.
        at: Instant,
    },
    /// Position of the pointer, in fractions of the display.
    Pointer {
        /// Fraction of the display's width.
        x: f64,
        /// Fraction of the display's height, downwards.
        y: f64,
    },
    /// What the participant does beside the task.
    Reply(PageReply),
    /// The event with this sequence number was drawn at this instant.
    Drawn {
        /// Sequence number of the event.
        cue: u64,
        /// When, by this computer's clock.
        at: Instant,
    },
}

/// What the participant does on the page beside the task: consents, answers a questionnaire or a probe, reads the tutorial.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum PageReply {
    /// Answer to a questionnaire item, or skipping it.
    Answer {
        /// The item's name.
        item: String,
        /// The answer; none: left out.
        answer: Option<AnswerValue>,
    },
    /// Going on to the next questionnaire item, or to all answers.
    Next,
    /// Return to a questionnaire item.
    Back {
        /// The item's name.
        item: String,
    },
    /// The button of the consent was held for as long as the page asks.
    Consent,
    /// Confirmation of all answers.
    Confirm,
    /// Turning the page of the tutorial from this step.
    Turn {
        /// The id of the step that is shown.
        step: String,
        /// To the next step; else to the one before.
        forward: bool,
    },
    /// Answer to the question of a tutorial's step.
    Choose {
        /// The step's id.
        step: String,
        /// The choice, counted from 1.
        choice: u8,
    },
    /// The recipe cards of a tutorial's step were shown for their time.
    CardsShown {
        /// The step's id.
        step: String,
    },
    /// Answer to the question of a probe: a choice, or items that lie on one another; neither: "I don't know".
    Believe {
        /// Number of the probe.
        probe: u32,
        /// Number of the question, from 1.
        question: u32,
        /// Number of the choice, from 1.
        choice: Option<u16>,
        /// The items of a stack, by name.
        items: Vec<String>,
        /// How sure the participant is, from 1 to 3, if that is asked.
        sure: Option<u8>,
    },
}
