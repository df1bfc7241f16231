//! What the arm in the physics reports of a press, and of a cycle of its controller: plain data, without the physics.

use crate::kitchen::ButtonId;
use crate::robot::RobotActivity;

/// Why the arm did not press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PressFailure {
    /// The arm gave up the press: a hand was in the way for too long.
    Blocked(ButtonId),
    /// It was down on the button, which did not click.
    NoClick(ButtonId),
    /// It felt somebody, with this force in newtons, and stops; the press is given up.
    Contact(f64),
    /// This joint, 0 the first, did not follow; the brakes hold, the press is given up.
    Fault(usize),
}

/// What came of a cycle for the press, and what is to be recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct CycleNews {
    /// This button clicked: it is pressed, also where the arm was about to give that up.
    pub clicked: Option<ButtonId>,
    /// Why the arm did not press.
    pub report: Option<PressFailure>,
    /// To be recorded, in order.
    pub news: Vec<RobotActivity>,
}
