//! Pose of the robot's hand on the participant's display.

use serde::Serialize;

/// Pose of the robot's hand on the participant's display.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RobotHandPose {
    /// Horizontal position of the hand, as a fraction of the display's width.
    pub x: f64,
    /// Vertical position of the hand, as a fraction of the display's height, downwards.
    pub y: f64,
    /// How far the hand is lowered: 0 above the display, 1 at a press.
    pub down: f64,
}

impl RobotHandPose {
    /// The pose rounded to thousandths, which nobody can see, so that a resting hand causes no messages.
    pub(super) fn rounded(self) -> RobotHandPose {
        let to_thousandth = |value: f64| (1000.0 * value).round() / 1000.0;
        RobotHandPose { x: to_thousandth(self.x), y: to_thousandth(self.y), down: to_thousandth(self.down) }
    }
}
