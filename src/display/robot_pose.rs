//! Where the robot's hand is over the display, as the page is told.

use serde::Serialize;

/// Where the robot's hand is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RobotPose {
    /// Fraction of the display's width.
    pub x: f64,
    /// Fraction of the display's height, downwards.
    pub y: f64,
    /// How far it is down: 0 above the places, 1 at a press.
    pub down: f64,
}

impl RobotPose {
    /// The pose to a thousandth, which nobody sees: a resting hand sends nothing.
    pub(super) fn rounded(self) -> RobotPose {
        let to_thousandth = |value: f64| (1000.0 * value).round() / 1000.0;
        RobotPose { x: to_thousandth(self.x), y: to_thousandth(self.y), down: to_thousandth(self.down) }
    }
}
