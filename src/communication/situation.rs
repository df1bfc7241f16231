//! The situation in which a concept decides: true state, belief estimate, robot.

use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::dirichlet::DirichletBelief;

/// A situation of a trial as the assistant knows it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    pub state: State,
    pub belief: &'a DirichletBelief,
    /// Locations that have just changed and may draw the human's eye.
    pub changed: &'a [AspectId],
    pub robot: RobotIntent,
    /// Duration of a robot press, in seconds.
    pub robot_press_s: f64,
}

impl<'a> Situation<'a> {
    /// A situation in which nothing has just changed and the robot follows its policy, with a press every 2.4 s.
    pub fn new(state: State, belief: &'a DirichletBelief) -> Situation<'a> {
        Situation { state, belief, changed: &[], robot: RobotIntent::Free, robot_press_s: 2.4 }
    }
}

/// The robot's present action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// The arm moves towards a button and will touch it in `in_s` seconds; `driven` if the wizard chose the press.
    Busy { button: ButtonId, remaining_s: f64, driven: bool },
    /// It follows its policy.
    Free,
    /// It is stopped or held.
    Still,
}
