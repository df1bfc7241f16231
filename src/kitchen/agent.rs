//! The two agents.

use serde::{Deserialize, Serialize};

/// An agent: human or robot.
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
