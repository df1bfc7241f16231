//! Replacement for the simulated robot arm in a build without the feature `physics`: a type of which no value can be
//! created.

use super::report::ArmCycleReport;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{ButtonId, State};
use tomcom_core::robot::{AbortReason, RobotEvent};

/// The simulated arm in a build without physics: no value of this type can be created.
#[derive(Clone, Debug)]
pub enum SimulatedArm {}

#[allow(missing_docs, reason = "the functions of the arm that is not there")]
impl SimulatedArm {
    /// The time of the next cycle of the arm's controller.
    pub fn next_due(&self, _: bool) -> Option<SessionTime> {
        match *self {}
    }

    /// Starts the arm's motion to a button.
    pub fn set_out(&mut self, _: SessionTime, _: ButtonId) -> Result<f64, AbortReason> {
        match *self {}
    }

    /// Abandons the robot arm's present press.
    pub fn give_up(&mut self) {
        match *self {}
    }

    /// Whether the caller now has to decide if the press is still useful.
    pub fn asks(&self, _: bool, _: State) -> bool {
        match *self {}
    }

    /// Confirms that the press is useful in this state.
    pub fn go_for_it(&mut self, _: bool, _: State) {
        match *self {}
    }

    /// Starts the robot arm's pending press.
    pub fn go_on(&mut self) -> Option<(ButtonId, AbortReason)> {
        match *self {}
    }

    /// Runs the controller cycle that ends now.
    pub fn cycle(&mut self, _: SessionTime) -> ArmCycleReport {
        match *self {}
    }

    /// The arm stays idle until the next press.
    pub fn has_nothing_to_do(&mut self) {
        match *self {}
    }

    /// Stops the arm at the wizard's command.
    pub fn stop(&mut self) -> Option<RobotEvent> {
        match *self {}
    }

    /// Releases the arm at the wizard's command after a stop.
    pub fn resume(&mut self, _: SessionTime) -> Option<RobotEvent> {
        match *self {}
    }

    /// Tells the simulated hand that the person intends to press a button.
    pub fn human_means(&mut self, _: SessionTime, _: [f64; 2], _: SessionTime) {
        match *self {}
    }

    /// Tells the simulated hand that the person has pressed a button.
    pub fn human_pressed(&mut self, _: SessionTime, _: [f64; 2]) {
        match *self {}
    }

    /// Shifts all pending times by the duration of a pause.
    pub fn postpone(&mut self, _: SessionTime) {
        match *self {}
    }
}
