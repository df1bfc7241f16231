//! The situation in which a communication concept decides: true state, belief estimate, robot.

use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::signal_model::SignalForecast;

/// A situation of a trial as the assistant knows it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The true state of the kitchen.
    pub state: State,
    /// The estimate of the human's belief.
    pub belief: &'a DirichletBelief,
    /// Locations that have just changed, and may attract the human's gaze.
    pub changed: &'a [AspectId],
    /// What the robot is doing now.
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

/// What the robot is doing now: moving to a button, following its policy, or standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// The robot's arm is moving to a button.
    Busy {
        /// The robot's button, as an index into its buttons.
        button: ButtonId,
        /// Time until the arm touches the button, in seconds.
        remaining_s: f64,
        /// Whether the wizard chose the button, so that the robot makes the press even if it is not useful.
        driven: bool,
    },
    /// The robot follows its task policy.
    Free,
    /// The robot is stopped or held by the wizard.
    Still,
}
