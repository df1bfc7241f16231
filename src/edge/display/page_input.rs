//! Inputs of the acting page for the session.

use std::time::Instant;

/// An input of the acting page.
#[derive(Clone, Debug, PartialEq)]
pub enum PageInput {
    /// The page is connected, with this size in pixels.
    Connected {
        width_px: u32,
        height_px: u32,
    },
    Lost,
    /// A press at this instant.
    Press {
        button: String,
        at: Instant,
    },
    /// Position of the pointer, in fractions of the display.
    Pointer {
        x: f64,
        y: f64,
    },
    /// Answer to a questionnaire item, or skipping it.
    Answer {
        item: String,
        rated: Option<u8>,
    },
    /// Return to a questionnaire item.
    Back {
        item: String,
    },
    /// Confirmation of all answers.
    Confirm,
    /// The event with this sequence number was drawn at this instant.
    Drawn {
        cue: u64,
        at: Instant,
    },
}
