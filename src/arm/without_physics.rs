//! Replacement for the simulated robot arm in a build without the feature `physics`: a type of which no value can be
//! created.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{ButtonId, State};
use tomcom_core::robot::{AbortReason, RobotEvent};

use crate::worker::ArmCycleReport;

pub use NoSimulatedArm as SimulatedArm;

#[derive(Clone, Debug)]
pub enum NoSimulatedArm {}

impl NoSimulatedArm {
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

    pub(crate) fn go_for_it(&mut self, _: bool, _: State) {
        match *self {}
    }

    pub fn go_on(&mut self) -> Option<(ButtonId, AbortReason)> {
        match *self {}
    }

    pub fn cycle(&mut self, _: SessionTime) -> ArmCycleReport {
        match *self {}
    }

    pub(crate) fn has_nothing_to_do(&mut self) {
        match *self {}
    }

    pub fn stop(&mut self) -> Option<RobotEvent> {
        match *self {}
    }

    pub fn resume(&mut self, _: SessionTime) -> Option<RobotEvent> {
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
