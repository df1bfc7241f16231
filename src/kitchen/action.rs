//! Agents and their buttons. An action of the task is one press of one physical button by one agent.

use serde::{Deserialize, Serialize};

use super::content::ContentId;
use super::layout::LocationId;

/// Who presses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agent {
    Human,
    Robot,
}

impl Agent {
    pub const BOTH: [Agent; 2] = [Agent::Human, Agent::Robot];

    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    pub fn other(self) -> Agent {
        match self {
            Agent::Human => Agent::Robot,
            Agent::Robot => Agent::Human,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Agent::Human => "human",
            Agent::Robot => "robot",
        }
    }
}

/// An index into the buttons of one agent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ButtonId(pub u8);

impl ButtonId {
    #[inline]
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// What a press does, if it is available.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Action {
    /// Take this item from the own storage into the empty hand.
    Take(ContentId),
    /// Pick up, put down or stack at a location.
    Use(LocationId),
    /// Apply the process with this index: to the hand if it has no place, else to what lies there.
    Process(u8),
    /// Throw away what the own hand holds.
    Trash,
    /// Serve this order location from the plate.
    Serve(LocationId),
}

/// A physical button as one agent has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Button {
    /// "take rice", "cutting_board", "cut", "trash", "serve 1".
    pub name: String,
    pub action: Action,
    /// Its place on the table in metres, in the frame of the robot's base.
    pub at_m: [f64; 2],
    /// The human's key for it.
    pub key: Option<char>,
}
