//! The two agents of the task: human and robot.

use serde::{Deserialize, Serialize};

/// An agent: human or robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agent {
    /// The human participant.
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

    /// The other agent: the robot for the human, the human for the robot.
    pub fn other(self) -> Agent {
        match self {
            Agent::Human => Agent::Robot,
            Agent::Robot => Agent::Human,
        }
    }

    /// The agent's name in logs and tables: "human" or "robot".
    pub fn name(self) -> &'static str {
        match self {
            Agent::Human => "human",
            Agent::Robot => "robot",
        }
    }
}
