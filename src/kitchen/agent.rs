//! The two agents.

use serde::{Deserialize, Serialize};

/// An agent: human or robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agent {
    /// The participant.
    Human,
    /// The robot that cooks with the participant.
    Robot,
}

impl Agent {
    /// Both agents, in the order of [`Agent::index`].
    pub const BOTH: [Agent; 2] = [Agent::Human, Agent::Robot];

    /// The agent's place in arrays of both agents: 0 for the human, 1 for the robot.
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }

    /// The agent's partner.
    pub fn other(self) -> Agent {
        match self {
            Agent::Human => Agent::Robot,
            Agent::Robot => Agent::Human,
        }
    }

    /// "human" or "robot", as logs and tables write it.
    pub fn name(self) -> &'static str {
        match self {
            Agent::Human => "human",
            Agent::Robot => "robot",
        }
    }
}
