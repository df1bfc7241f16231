//! Entries of a session's timeline.

use super::event::SignalEnd;
use super::phase::Phase;
use super::probe_event::ProbeEvent;
use crate::base::time::SessionTime;
use crate::communication::{Sender, Signal};
use crate::kitchen::no_effect::NoEffect;
use crate::kitchen::{Agent, ButtonId, LocationId};
use crate::robot::safety::SafetyMode;

/// An entry of the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineEntry {
    /// Session time.
    pub time: SessionTime,
    /// What happened.
    pub what: TimelineEvent,
}

/// Content of a timeline entry.
#[derive(Clone, Debug, PartialEq)]
pub enum TimelineEvent {
    /// An agent pressed a button.
    Press {
        /// Who pressed.
        agent: Agent,
        /// The button, in the list of that agent's buttons.
        button: ButtonId,
        /// Why it changed nothing in the kitchen, and the location that the reason is about; `None` if it did.
        no_effect: Option<(NoEffect, LocationId)>,
    },
    /// A signal appeared.
    Signal {
        /// Who sent it.
        by: Sender,
        /// The signal.
        signal: Signal,
    },
    /// The signal vanished, for this reason.
    SignalEnded(SignalEnd),
    /// An order was served.
    Served {
        /// The order's location.
        order: LocationId,
    },
    /// An order appeared.
    OrderShown {
        /// The order's location.
        order: LocationId,
    },
    /// The wizard marked the moment, with this note.
    Marker(String),
    /// The wizard stopped the robot.
    RobotStopped,
    /// The arm stopped by itself, with the contact force in newtons or the number of the faulty joint.
    ArmStopped {
        /// The safety mode that it is in since.
        mode: SafetyMode,
        /// The force that it felt, in newtons, if a contact stopped it.
        force_n: Option<f64>,
        /// The faulty joint, if one stopped it; 1 is the first.
        joint: Option<u8>,
    },
    /// Somebody touched the arm.
    ArmTouched {
        /// The force of the contact in newtons.
        force_n: f64,
    },
    /// The wizard let the stopped robot go on.
    RobotResumed,
    /// The robot is held before its next press.
    RobotHeld,
    /// The held robot goes on.
    RobotReleased,
    /// The robot gave up its press of this button, because somebody skipped it.
    RobotSkipped(ButtonId),
    /// Somebody chose this button for the robot's next press.
    RobotDriven(ButtonId),
    /// The wizard corrected what the program thought of a location.
    Corrected {
        /// The location.
        location: LocationId,
    },
    /// The trial reached this phase.
    Trial(Phase),
    /// An event of a freeze probe, other than a question or an answer.
    Probe(ProbeEvent),
    /// The trial was excluded from the analysis, for this reason.
    Excluded(String),
    /// The trial was included in the analysis again.
    Included,
    /// The terminal gained or lost keyboard focus.
    Focus(bool),
}
