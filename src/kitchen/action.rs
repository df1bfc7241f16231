//! Buttons: an action of the task is one press of one physical button by one agent.

use serde::{Deserialize, Serialize};

use super::content::ContentId;
use super::location::LocationId;

/// An index into the buttons of one agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ButtonId(pub u8);

impl ButtonId {
    /// The button's place in its agent's list of [`Kitchen::buttons`](super::Kitchen::buttons).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// Action of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ButtonAction {
    /// Take this item from the own storage into the empty hand.
    Take(ContentId),
    /// Pick up, put down or stack at a location.
    Use(LocationId),
    /// Apply the process with this index: to the hand if it has no place, else to what lies there.
    Process(u8),
    /// Throw away the content of the own hand.
    Trash,
    /// Serve this order location from the plate.
    Serve(LocationId),
}

/// A physical button as one agent has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Button {
    /// "take rice", "cutting_board", "cut", "trash", "serve 1".
    pub name: String,
    /// What a press of it does.
    pub action: ButtonAction,
    /// Its place on the table in metres, in the frame of the robot's base.
    pub at_m: [f64; 2],
    /// The human's key for it.
    pub key: Option<char>,
    /// The number of the human's gamepad button for it.
    pub gamepad: Option<u8>,
    /// The colour of its cap, which the display shows, too.
    pub colour: Option<ButtonColour>,
    /// The name of its area on the table; buttons of one area stand together, as on the display.
    pub area: Option<String>,
}

/// Colour of a button's cap: those in which arcade buttons are sold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ButtonColour {
    /// Red.
    Red,
    /// Yellow.
    Yellow,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// White.
    White,
    /// Black.
    Black,
}
