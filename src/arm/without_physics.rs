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
    pub fn next_due(&self, _: bool) -> Option<SessionTime> {
        match *self {}
    }

    pub fn set_out(&mut self, _: SessionTime, _: ButtonId) -> Result<f64, AbortReason> {
        match *self {}
    }

    pub fn give_up(&mut self) {
        match *self {}
    }

    pub fn asks(&self, _: bool, _: State) -> bool {
        match *self {}
    }

    pub fn go_for_it(&mut self, _: bool, _: State) {
        match *self {}
    }

    pub fn go_on(&mut self) -> Option<(ButtonId, AbortReason)> {
        match *self {}
    }

    pub fn cycle(&mut self, _: SessionTime) -> CycleNews {
        match *self {}
    }

    pub fn has_nothing_to_do(&mut self) {
        match *self {}
    }

    pub fn stop(&mut self) -> Option<RobotActivity> {
        match *self {}
    }

    pub fn resume(&mut self, _: SessionTime) -> Option<RobotActivity> {
        match *self {}
    }

    pub fn human_means(&mut self, _: SessionTime, _: [f64; 2], _: SessionTime) {
        match *self {}
    }

    pub fn human_pressed(&mut self, _: SessionTime, _: [f64; 2]) {
        match *self {}
    }

    pub fn postpone(&mut self, _: SessionTime) {
        match *self {}
    }
}
