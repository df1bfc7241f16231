//! What there is to decide about: the situation in which something could be said.

use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::dirichlet::DirichletBelief;

/// A moment of a trial, as the assistant knows it: the true state, the arm's errand, and the estimate of the belief.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    pub state: State,
    pub belief: &'a DirichletBelief,
    /// The locations that have changed at this very moment, which may draw the eye.
    pub changed: &'a [AspectId],
    pub robot: RobotIntent,
    /// How long a press of the robot takes, in seconds.
    pub robot_press_s: f64,
}

impl<'a> Situation<'a> {
    /// A situation in which nothing has just changed and the robot follows its policy, with a press every 2.4 s.
    pub fn new(state: State, belief: &'a DirichletBelief) -> Situation<'a> {
        Situation { state, belief, changed: &[], robot: RobotIntent::Free, robot_press_s: 2.4 }
    }
}

/// What the robot is about to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// Its arm is on its way to a button, which it will touch in so many seconds; `driven`: useful or not.
    Busy { button: ButtonId, remaining_s: f64, driven: bool },
    /// It follows its policy.
    Free,
    /// It is stopped or held.
    Still,
}
