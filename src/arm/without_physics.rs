//! The arm in the physics as it is in a build without the feature `physics`: there is none, and none can be made.

use super::report::CycleNews;
use crate::base::time::SessionTime;
use crate::kitchen::{ButtonId, State};
use crate::robot::{AbortReason, RobotActivity};

/// No arm: this type has no value.
#[derive(Clone, Debug)]
pub enum SteppedArm {}

#[allow(missing_docs, reason = "the functions of the arm that is not there")]
impl SteppedArm {
    /// The time of the next controller cycle.
    pub fn next_due(&self, _: bool) -> Option<SessionTime> {
        match *self {}
    }

    /// Starts the way to a button.
    pub fn set_out(&mut self, _: SessionTime, _: ButtonId) -> Result<f64, AbortReason> {
        match *self {}
    }

    /// Gives up the current press.
    pub fn give_up(&mut self) {
        match *self {}
    }

    /// Whether the caller has to decide now if the press is still useful.
    pub fn asks(&self, _: bool, _: State) -> bool {
        match *self {}
    }

    /// The press is useful in this state.
    pub fn go_for_it(&mut self, _: bool, _: State) {
        match *self {}
    }

    /// Starts the pending press.
    pub fn go_on(&mut self) -> Option<(ButtonId, AbortReason)> {
        match *self {}
    }

    /// Runs the controller cycle that ends now.
    pub fn cycle(&mut self, _: SessionTime) -> CycleNews {
        match *self {}
    }

    /// The arm stays idle until the next press.
    pub fn has_nothing_to_do(&mut self) {
        match *self {}
    }

    /// The wizard stops the arm.
    pub fn stop(&mut self) -> Option<RobotActivity> {
        match *self {}
    }

    /// The wizard releases the arm after a stop.
    pub fn resume(&mut self, _: SessionTime) -> Option<RobotActivity> {
        match *self {}
    }

    /// The person intends to press a button.
    pub fn human_means(&mut self, _: SessionTime, _: [f64; 2], _: SessionTime) {
        match *self {}
    }

    /// The person has pressed a button.
    pub fn human_pressed(&mut self, _: SessionTime, _: [f64; 2]) {
        match *self {}
    }

    /// Shifts all pending times by the length of a pause.
    pub fn postpone(&mut self, _: SessionTime) {
        match *self {}
    }
}
