//! Results of a press and of a controller cycle of the simulated arm, as plain data without the physics.

use crate::kitchen::ButtonId;
use crate::robot::RobotActivity;

/// Why the arm did not press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressFailure {
    /// The arm gave up the press: a hand was in the way for too long.
    Blocked(ButtonId),
    /// The button was pressed down and did not click.
    NoClick(ButtonId),
    /// The arm measured a contact force above the threshold (newtons); it stops, and the press is given up.
    Contact(f64),
    /// This joint (0 is the first) did not follow its command; the brakes hold the arm, and the press is given up.
    Fault(usize),
}

/// The result of a cycle for the press, and the events to record.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleNews {
    /// The button that clicked. A click counts as a press even if the arm was about to give up.
    pub clicked: Option<ButtonId>,
    /// Why the arm did not press.
    pub report: Option<PressFailure>,
    /// Events to record, in order.
    pub news: Vec<RobotActivity>,
}
