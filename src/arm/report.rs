//! Results of a press and of a controller cycle of the simulated robot arm, as plain data without the physics.

use tomcom_core::kitchen::ButtonId;
use tomcom_core::robot::RobotEvent;

/// Why the robot arm failed to press a button.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressFailure {
    /// A hand was in the way for too long, so the arm abandoned the press of this button.
    Blocked(ButtonId),
    /// The arm pushed this button down, but the button did not click.
    NoClick(ButtonId),
    /// The arm measured a contact force (newtons) above the threshold; it stops and abandons the press.
    Contact(f64),
    /// This joint (number 0 is the first) did not follow its command; the brakes hold the arm, and the press is
    /// abandoned.
    Fault(usize),
}

/// The result of a controller cycle for the arm's press, and the events of the cycle to record.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmCycleReport {
    /// The button that clicked. A click counts as a press even if the arm was about to abandon the press.
    pub clicked: Option<ButtonId>,
    /// Why the arm failed to press; `None` if the arm did not fail.
    pub report: Option<PressFailure>,
    /// The robot activities to record, in the order of their times.
    pub news: Vec<RobotEvent>,
}
