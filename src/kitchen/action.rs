//! Agents and their buttons. An action of the task is one press of one physical button by one agent.

use serde::{Deserialize, Serialize};

use super::Kitchen;
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
pub enum ButtonAction {
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
    pub action: ButtonAction,
    /// Its place on the table in metres, in the frame of the robot's base.
    pub at_m: [f64; 2],
    /// The human's key for it.
    pub key: Option<char>,
    /// The number of the human's gamepad button for it.
    pub gamepad: Option<u8>,
}

impl Kitchen {
    /// The places whose contents decide what a press does; where items are moved, the place comes before the hand.
    pub fn involved(&self, agent: Agent, button: ButtonId) -> Vec<LocationId> {
        let hand = self.hands[agent.index()];
        match self.button(agent, button).action {
            ButtonAction::Take(_) | ButtonAction::Trash => vec![hand],
            ButtonAction::Use(location) => vec![location, hand],
            ButtonAction::Process(process) => vec![self.processes[usize::from(process)].place.unwrap_or(hand)],
            ButtonAction::Serve(order) => vec![self.plate, order],
        }
    }

    /// The agent's button nearest to another one of its buttons on the table.
    pub fn nearest_button(&self, agent: Agent, button: ButtonId) -> Option<ButtonId> {
        let buttons = &self.buttons[agent.index()];
        let own = buttons[button.index()].at_m;
        let distance = |index: usize| (buttons[index].at_m[0] - own[0]).hypot(buttons[index].at_m[1] - own[1]);
        let others = (0..buttons.len()).filter(|&index| index != button.index());
        others.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).map(|index| ButtonId(index as u8))
    }

    /// The agent's storage button whose symbol looks like that of another one.
    pub fn look_alike_button(&self, agent: Agent, button: ButtonId) -> Option<ButtonId> {
        let ButtonAction::Take(item) = self.button(agent, button).action else { return None };
        let alike = &self.content(item).look_alikes;
        let is_alike = |action| matches!(action, ButtonAction::Take(other) if alike.contains(&other));
        let buttons = &self.buttons[agent.index()];
        buttons.iter().position(|other| is_alike(other.action)).map(|index| ButtonId(index as u8))
    }
}
