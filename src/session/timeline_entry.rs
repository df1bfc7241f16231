//! Entries of a session's timeline.

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

/// Content of a timeline entry.
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
    /// The arm stopped by itself, with the contact force in newtons or the number of the faulty joint.
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
    /// The terminal gained or lost keyboard focus.
    Focus(bool),
}
