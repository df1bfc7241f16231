//! Replacement for the simulated robot arm in a build without the feature `physics`: a type of which no value can be
//! created.

use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::{ButtonId, State};
use tomcom_core::robot::{AbortReason, RobotEvent};

use crate::worker::ArmCycleReport;

pub use NoSimulatedArm as SimulatedArm;

#[derive(Clone, Debug)]
pub enum NoSimulatedArm {}

/// Functions that are never called, since there is no `self`.
macro_rules! uncallable {
    ($($name:ident($($argument:ty),*) $(-> $result:ty)?,)*) => {
        impl NoSimulatedArm {
            $(pub(crate) fn $name(&self, $(_: $argument),*) $(-> $result)? {
                match *self {}
            })*
        }
    };
}

uncallable! {
    next_due(bool) -> Option<SessionTime>,
    set_out(SessionTime, ButtonId) -> Result<f64, AbortReason>,
    give_up(),
    asks(bool, State) -> bool,
    go_for_it(bool, State),
    go_on() -> Option<(ButtonId, AbortReason)>,
    cycle(SessionTime) -> ArmCycleReport,
    has_nothing_to_do(),
    stop() -> Option<RobotEvent>,
    resume(SessionTime) -> Option<RobotEvent>,
    human_means(SessionTime, [f64; 2], SessionTime),
    human_pressed(SessionTime, [f64; 2]),
    postpone(SessionTime),
}
