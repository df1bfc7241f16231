//! What the page that acts tells the session.

use std::time::Instant;

/// What the page that acts tells.
#[derive(Clone, Debug, PartialEq)]
pub enum PageInput {
    /// It is there, of this size in pixels.
    Connected {
        width_px: u32,
        height_px: u32,
    },
    Lost,
    /// A button went down at this moment.
    Press {
        button: String,
        at: Instant,
    },
    /// The pointer was at this point of the display, in fractions.
    Pointer {
        x: f64,
        y: f64,
    },
    /// An item of a questionnaire was rated, or left out.
    Answer {
        item: String,
        rated: Option<u8>,
    },
    /// Back to this item.
    Back {
        item: String,
    },
    /// The answers are as they were meant.
    Confirm,
    /// What the event of this number brought was drawn at this moment.
    Drawn {
        cue: u64,
        at: Instant,
    },
}
