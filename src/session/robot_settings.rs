//! What a session file says about the robot.

use serde::{Deserialize, Serialize};

/// How the robot's presses come about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// They take a while by chance; the arm is only shown.
    #[default]
    Timed,
    /// A simulated arm makes them, in the physics: it slows near the human's hand, and stops when it touches it.
    Physics,
}

impl ArmKind {
    /// As it stands in files.
    pub fn name(self) -> &'static str {
        match self {
            ArmKind::Timed => "timed",
            ArmKind::Physics => "physics",
        }
    }

    fn is_timed(&self) -> bool {
        *self == ArmKind::Timed
    }
}

/// The robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSpec {
    /// Its arm; where nothing is said, and in recordings of before there was another one, it is timed.
    #[serde(skip_serializing_if = "ArmKind::is_timed")]
    pub arm: ArmKind,
    /// Of the timed arm: median duration of a press in seconds.
    pub press_s: f64,
    /// Of the timed arm: the standard deviation of the logarithm of the duration.
    pub press_spread: f64,
}

impl Default for RobotSpec {
    fn default() -> Self {
        RobotSpec { arm: ArmKind::Timed, press_s: 2.4, press_spread: 0.15 }
    }
}
