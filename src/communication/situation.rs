//! The situation in which a concept decides: true state, belief estimate, robot.

use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::signal_model::SignalForecast;

/// A situation of a trial as the assistant knows it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The true state.
    pub state: State,
    /// The estimate of the human's belief.
    pub belief: &'a DirichletBelief,
    /// Locations that have just changed and may draw the human's eye.
    pub changed: &'a [AspectId],
    /// What the robot is about to do.
    pub robot: RobotIntent,
    /// Duration of a robot press, in seconds.
    pub robot_press_s: f64,
    /// How a signal that is shown now will be read.
    pub forecast: SignalForecast,
}

impl<'a> Situation<'a> {
    /// A situation in which nothing has just changed, the robot follows its policy, with a press every 2.4 s, and a signal is believed at
    /// once.
    pub fn new(state: State, belief: &'a DirichletBelief) -> Situation<'a> {
        let forecast = SignalForecast::default();
        Situation { state, belief, changed: &[], robot: RobotIntent::Free, robot_press_s: 2.4, forecast }
    }
}

/// The robot's present action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// Its arm is on its way to a button.
    Busy {
        /// The button, in the list of the robot's buttons.
        button: ButtonId,
        /// Time until the arm touches it, in seconds.
        remaining_s: f64,
        /// The wizard chose the button, so that the press is made whether it is useful or not.
        driven: bool,
    },
    /// It follows its policy.
    Free,
    /// It is stopped or held.
    Still,
}
