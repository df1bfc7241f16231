//! Buttons of the kitchen: an action of the task is one press of one physical button by one agent.

use serde::{Deserialize, Serialize};

use super::content::ContentId;
use super::location::LocationId;

/// Identifies a button, as an index into the list of one agent's buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ButtonId(pub u8);

impl ButtonId {
    /// The button's place in its agent's list of [`Kitchen::buttons`](super::Kitchen::buttons).
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// The action that a press of a button performs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ButtonAction {
    /// Take this item from the agent's own storage into the agent's empty hand.
    Take(ContentId),
    /// Pick up, put down or stack: exchange contents between the agent's hand and this location.
    Use(LocationId),
    /// Apply the processing step with this index: to the content of the hand if the step has no place of its own, else
    /// to the content of the step's place.
    Process(u8),
    /// Throw away the content of the agent's hand.
    Trash,
    /// Serve the order at this location from the plate.
    Serve(LocationId),
}

/// A physical button of one agent.
#[derive(Clone, Debug, PartialEq)]
pub struct Button {
    /// Name of the button: "take rice", "cutting_board", "cut", "trash", "serve 1".
    pub name: String,
    /// What a press of the button does.
    pub action: ButtonAction,
    /// Position of the button on the table in metres, in the frame of the robot's base.
    pub at_m: [f64; 2],
    /// The key on the human's keyboard that presses this button.
    pub key: Option<char>,
    /// Number of the button on the human's gamepad that presses this button.
    pub gamepad: Option<u8>,
    /// The colour of the button's cap, which the participant's display shows, too.
    pub colour: Option<ButtonColour>,
    /// The name of the button's area on the table; buttons of one area stand together, as on the display.
    pub area: Option<String>,
}

/// Colour of a button's cap: one of the colours in which arcade buttons are sold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ButtonColour {
    /// The button has a red cap.
    Red,
    /// The button has a yellow cap.
    Yellow,
    /// The button has a green cap.
    Green,
    /// The button has a blue cap.
    Blue,
    /// The button has a white cap.
    White,
    /// The button has a black cap.
    Black,
}
