//! A recorded sample of the simulated arm, as plain data without the physics.

use serde::{Deserialize, Serialize};

/// The number of joints that move.
pub const JOINTS: usize = 6;
/// The joints in the arm's URDF, from the base on.
pub const JOINT_NAMES: [&str; JOINTS] = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];
/// Angles of the joints, from the base on, in radians.
pub type JointAngles = [f64; JOINTS];

/// Phase of the arm's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ArmPhase {
    /// Nothing: it stands above the buttons.
    #[default]
    Rests,
    /// Comes up from a button.
    Retracts,
    /// On its way over the buttons.
    Travels,
    /// Above its button, ready to press.
    Hovers,
    /// Down on its button.
    Presses,
}

/// A sample of the arm's motion, as it is recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArmSample {
    /// What the arm was doing.
    pub phase: ArmPhase,
    /// Joint angles in radians, from the base on, to a ten thousandth.
    pub joints: JointAngles,
    /// The greatest force that it felt since it was told last, from a button or from somebody, in newtons.
    #[serde(default, skip_serializing_if = "is_nothing")]
    pub force_n: f64,
    /// The middle of the human's hand, in the frame of the arm's base, in metres.
    pub hand_m: [f64; 3],
    /// The distance of the human's hand from the arm, in metres.
    pub hand_away_m: f64,
}

fn is_nothing(force_n: &f64) -> bool {
    *force_n == 0.0
}
