//! Entries of a session's timeline: what the console and the tables show of events.

use super::event::SignalEndReason;
use super::phase::TrialPhase;
use super::probe_event::ProbeEvent;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::{Agent, ButtonId, LocationId, State};
use tomcom_core::robot::SafetyMode;

/// An entry of the session's timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineEntry {
    /// Session time of the entry.
    pub time: SessionTime,
    /// What happened at that time, as the timeline shows it.
    pub what: TimelineEvent,
}

/// Content of an entry of the session's timeline.
#[derive(Clone, Debug, PartialEq)]
pub enum TimelineEvent {
    /// An agent pressed a button.
    Press {
        /// The agent that pressed.
        agent: Agent,
        /// The pressed button, as an index into that agent's buttons.
        button: ButtonId,
        /// The state of the kitchen before the press.
        before: State,
        /// The state of the kitchen after the press; the same as before if the press had no effect.
        after: State,
        /// Why the press had no effect, and the location that the reason is about; `None` if the press had an effect.
        no_effect: Option<(NoEffectReason, LocationId)>,
    },
    /// A signal appeared on the participant's display.
    Signal {
        /// Who sent the signal.
        by: Sender,
        /// The signal that appeared.
        signal: Signal,
    },
    /// The signal disappeared from the display, for this reason.
    SignalEnded(SignalEndReason),
    /// An order was served at a location.
    Served {
        /// The location of the served order.
        order: LocationId,
    },
    /// An order appeared at a location.
    OrderShown {
        /// The location of the order that appeared.
        order: LocationId,
    },
    /// The wizard set a marker with this note.
    Marker(String),
    /// The wizard stopped the robot's arm.
    RobotStopped,
    /// The arm stopped by itself (protective stop or fault), with the contact force in newtons or the number of the
    /// faulty joint.
    ArmStopped {
        /// The arm's safety mode since the stop.
        mode: SafetyMode,
        /// The contact force that stopped the arm, in newtons, if a contact did.
        force_n: Option<f64>,
        /// The number of the faulty joint that stopped the arm, if one did; 1 is the first.
        joint: Option<u8>,
    },
    /// Somebody touched the robot's arm.
    ArmTouched {
        /// The force of the contact in newtons.
        force_n: f64,
    },
    /// The wizard released the stopped robot.
    RobotResumed,
    /// The wizard holds the robot before its next press.
    RobotHeld,
    /// The robot, which was held, continues.
    RobotReleased,
    /// The robot abandoned its press of this button, because the wizard skipped it.
    RobotSkipped(ButtonId),
    /// The wizard chose this button for the robot's next press.
    RobotDriven(ButtonId),
    /// The wizard corrected the content of a location in the program's state.
    Corrected {
        /// The location that the wizard corrected.
        location: LocationId,
    },
    /// The trial entered this phase (running, paused, over).
    Trial(TrialPhase),
    /// An event of a freeze probe, other than a question or an answer.
    Probe(ProbeEvent),
    /// The trial was excluded from the analysis, for this reason.
    Excluded(String),
    /// The trial was included in the analysis again.
    Included,
    /// The terminal gained or lost keyboard focus.
    Focus(bool),
}
