//! Settings of the robot in a session file.

use serde::{Deserialize, Serialize};

/// Kind of the robot's arm: timed (presses take a drawn duration), or simulated with physics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmKind {
    /// The timed arm: presses have a random duration; the arm's motion is only displayed.
    #[default]
    Timed,
    /// The arm in the physics simulation: a simulated UR5 presses buttons by contact; the UR5 slows near the human's
    /// hand and stops on contact with the hand.
    Physics,
}

impl ArmKind {
    /// Name of the robot's arm in files.
    pub fn name(self) -> &'static str {
        match self {
            ArmKind::Timed => "timed",
            ArmKind::Physics => "physics",
        }
    }
}

/// Settings of the robot: its arm, the duration of its presses, and its initiative.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RobotSpec {
    /// Kind of the arm.
    pub arm: ArmKind,
    /// Timed arm: median duration of a press, in seconds.
    pub press_s: f64,
    /// Timed arm: standard deviation of the logarithm of a press's duration.
    pub press_spread: f64,
    /// Time without a press of the human after which the robot takes the initiative, in seconds.
    pub initiative_s: f64,
}

impl Default for RobotSpec {
    fn default() -> Self {
        RobotSpec { arm: ArmKind::Timed, press_s: 2.4, press_spread: 0.15, initiative_s: 6.0 }
    }
}
