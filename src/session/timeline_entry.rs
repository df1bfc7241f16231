//! What the timeline of a session holds.

use super::event::SignalEnd;
use super::phase::Phase;
use crate::base::time::SessionTime;
use crate::communication::{Sender, Signal};
use crate::kitchen::{Agent, ButtonId, LocationId};
use crate::robot::safety::SafetyMode;

/// An entry of the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineEntry {
    pub time: SessionTime,
    pub what: TimelineEvent,
}

/// What an entry of the timeline is about.
#[derive(Clone, Debug, PartialEq)]
pub enum TimelineEvent {
    Press {
        agent: Agent,
        button: ButtonId,
        effective: bool,
    },
    Signal {
        by: Sender,
        signal: Signal,
    },
    SignalEnded(SignalEnd),
    Served {
        order: LocationId,
    },
    OrderShown {
        order: LocationId,
    },
    Marker(String),
    RobotStopped,
    /// It stopped by itself; with the force that it felt, in newtons, or the joint at fault.
    ArmStopped {
        mode: SafetyMode,
        force_n: Option<f64>,
        joint: Option<u8>,
    },
    ArmTouched {
        force_n: f64,
    },
    RobotResumed,
    RobotHeld,
    RobotReleased,
    RobotSkipped(ButtonId),
    RobotDriven(ButtonId),
    Corrected {
        location: LocationId,
    },
    Trial(Phase),
    Excluded(String),
    Included,
    /// The terminal has the keyboard, or not.
    Focus(bool),
}
