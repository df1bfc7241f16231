//! The situation in which a communication concept decides: true state, belief estimate, robot.

use crate::kitchen::{AspectId, ButtonId, State};
use crate::mind::dirichlet::DirichletBelief;
use crate::mind::signal_model::SignalReadingForecast;

/// A situation of a trial as the assistant knows it.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The true state of the kitchen.
    pub state: State,
    /// The estimate of the human's belief at this time.
    pub belief: &'a DirichletBelief,
    /// State aspects of locations that have just changed, and that may attract the human's gaze.
    pub changed: &'a [AspectId],
    /// What the robot is doing now.
    pub robot: RobotIntent,
    /// Duration of a press of the robot, in seconds.
    pub robot_press_s: f64,
    /// Forecast of how a signal that is shown now will be read.
    pub forecast: SignalReadingForecast,
}

impl<'a> Situation<'a> {
    /// A situation in which nothing has just changed, the robot follows its policy, with a press every 2.4 s, and
    /// signals are believed at once.
    pub fn new(state: State, belief: &'a DirichletBelief) -> Situation<'a> {
        let forecast = SignalReadingForecast::default();
        Situation { state, belief, changed: &[], robot: RobotIntent::Free, robot_press_s: 2.4, forecast }
    }
}

/// What the robot is doing now: moving to a button, following its policy, or standing still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotIntent {
    /// The robot's arm is moving to a button.
    Busy {
        /// The button to which the arm is moving, as an index into the robot's buttons.
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
