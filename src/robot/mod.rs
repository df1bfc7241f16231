//! The robot: its task policy, and the arm that carries it out.

pub mod arm;
pub mod clearance;
pub mod inverse;
pub mod kinematics;
pub mod motion;
pub mod physics;
pub mod policy;
pub mod reach;
pub mod safety;
pub mod timed;
pub mod trajectory;
pub mod urdf;

use serde::{Deserialize, Serialize};

/// Why the robot gave up a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AbortReason {
    /// When the arm was about to touch the button, pressing it was no longer useful.
    NoLongerUseful,
    /// The wizard stopped the robot.
    Stopped,
    /// The wizard skipped this press.
    Skipped,
    /// The wizard chose another press.
    Driven,
}

/// Why the robot does nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IdleReason {
    /// No order is present.
    NoOrder,
    /// Only the human can go on.
    HumanTurn,
    /// The wizard skipped the only press that would help, a moment ago.
    Skipped,
}
