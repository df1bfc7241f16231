//! A recorded sample of the simulated arm's motion, as plain data without the physics.

use serde::{Deserialize, Serialize};

/// The number of joints of the robot arm.
pub const JOINTS: usize = 6;
/// Names of the joints in the arm's URDF, from the base on.
pub const JOINT_NAMES: [&str; JOINTS] = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
/// Joint angles of the robot arm, from the base on, in radians.
pub type JointAngles = [f64; JOINTS];

/// Phase of the arm's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmPhase {
    /// The arm rests above the buttons.
    #[default]
    Rests,
    /// The arm comes up from a button.
    Retracts,
    /// The arm moves above the buttons to its target.
    Travels,
    /// The arm stands above its button, ready to press.
    Hovers,
    /// The arm pushes its button down.
    Presses,
}

/// A sample of the robot arm's motion, as it is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmSample {
    /// The phase of the arm's motion.
    pub phase: ArmPhase,
    /// Joint angles in radians, from the base on, rounded to a ten thousandth.
    pub joints: JointAngles,
    /// The greatest contact force since the previous sample, on a button or a person, in newtons.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub force_n: f64,
    /// The centre of the human's hand, in the frame of the robot arm's base, in metres.
    pub hand_m: [f64; 3],
    /// The distance between the human's hand and the arm, in metres.
    pub hand_away_m: f64,
}

fn is_nothing(force_n: &f64) -> bool {
    *force_n == 0.0
}
