//! What can happen in a session. The log is a list of these, and a session is its log.
//!
//! Facts change the session when applied; witnesses are only kept. Locations, dishes and buttons stand by their names, so
//! that a log can be read without the program.

use serde::{Deserialize, Serialize};

use super::display::DisplayEvent;
use super::gaze_check::CalibrationEvent;
use super::preflight_check::PreflightCheck;
use super::protocol_event::ProtocolEvent;
use super::screen::VisibleScreen;
use super::tracker::TrackerEvent;
use crate::base::time::SessionTime;
use crate::communication::concept::ConceptName;
use crate::communication::recommendation::Recommendation;
use crate::communication::{Sender, Signal};
use crate::gaze::GazeSample;
use crate::kitchen::Agent;
use crate::mind::BeliefWitness;
use crate::mind::witness::EstimateWitness;
use crate::robot::moment::ArmSample;
use crate::robot::safety::SafetyMode;
use crate::robot::{AbortReason, IdleReason};

/// An event with its place in the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stamped {
    /// 0, 1, 2, … without gaps.
    pub seq: u64,
    /// Nanoseconds since the session began; never decreases along the log.
    #[serde(rename = "t_ns")]
    pub time: SessionTime,
    #[serde(flatten)]
    pub event: Event,
}

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event {
    /// What was looked at before the trial, and whether it was started although not all was ok.
    Preflight {
        checks: Vec<PreflightCheck>,
        overridden: bool,
    },
    /// The trial's clock starts; empty kitchen.
    TrialStarted,
    /// Clock, robot and orders stand still; presses have no effect.
    TrialPaused,
    TrialResumed,
    TrialEnded {
        reason: EndReason,
    },
    /// The trial is over and does not count; it may be done again, in another recording.
    TrialAborted {
        reason: String,
    },
    /// The trial is to be left out of the analysis.
    TrialExcluded {
        reason: String,
    },
    /// It is not to be left out after all.
    TrialIncluded,
    /// A gaze sample of the participant.
    Gaze(GazeSample),
    /// What the eye tracker tells beside its samples.
    Tracker(TrackerEvent),
    /// A step in a check of the calibration.
    Calibration(CalibrationEvent),
    /// An agent pressed a physical button.
    Press {
        agent: Agent,
        button: String,
        /// When it went down by the clock of the display that it is at, aligned to session time; a little before the
        /// stamp, which is when the session took it and never runs back.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_ns: Option<SessionTime>,
    },
    /// An order location shows a wanted dish.
    OrderShown {
        order: String,
        dish: String,
    },
    /// An order location no longer shows `served`.
    OrderCleared {
        order: String,
    },
    /// The robot sets out to press a button and will touch it at `until_ns` if nothing comes between.
    RobotIntends {
        button: String,
        until_ns: SessionTime,
    },
    /// The robot gave up the press that it was on its way to.
    RobotAborts {
        button: String,
        reason: AbortReason,
    },
    /// The robot has nothing useful to do.
    RobotIdles {
        reason: IdleReason,
    },
    /// Witness: how the arm in the physics stands, some twelve times a second while it moves.
    RobotMoves(ArmSample),
    /// The arm in the physics is safe in another way. After a protective stop or a fault it stays where it is until the
    /// wizard resumes it.
    RobotSafety {
        mode: SafetyMode,
        /// What it felt in newtons, where that is why.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        force_n: Option<f64>,
        /// The joint at fault, 1 the first.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        joint: Option<u8>,
    },
    /// Witness: somebody touched the arm in the physics, with so much force in newtons; told once for each contact, also of
    /// one that stopped the arm.
    RobotTouched {
        force_n: f64,
    },
    /// The wizard stopped the robot; it stays so until it is resumed.
    RobotStopped,
    RobotResumed,
    /// The robot sets out for nothing new and waits before the button that it is on its way to, until it is released.
    RobotHeld {
        by: Sender,
    },
    RobotReleased {
        by: Sender,
    },
    /// The robot gives up the press that it is on its way to, and decides anew.
    RobotSkipped {
        by: Sender,
    },
    /// The robot's next press is this one, useful or not.
    RobotDriven {
        by: Sender,
        button: String,
    },
    /// The wizard found something else at a location than the program thought: a change by nobody.
    KitchenCorrected {
        location: String,
        content: String,
    },
    /// A signal appears to the participant; an earlier one vanishes.
    SignalShown {
        by: Sender,
        signal: Signal,
        /// The wizard accepted the recommendation for the event of this number.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        accepted: Option<u64>,
    },
    /// What the assistant advises, for an event that is some time ago where it was computed while the session went on.
    Advised(Recommendation),
    /// Witness: the first frame that shows the signal of this number was handed to the terminal.
    SignalDrawn {
        signal: u64,
    },
    /// The signal vanishes.
    SignalEnded {
        reason: SignalEnd,
    },
    /// The wizard marked this moment.
    Marker {
        note: String,
    },
    /// What is around the trial, in a plan.
    Protocol(ProtocolEvent),
    /// Witness: the wall clock went on by so much more than session time (less, if negative), in milliseconds: the
    /// program or the computer stood still, or the clock was set.
    ClockJumped {
        by_ms: i64,
    },
    /// Witness: what the participant's display tells of itself.
    Display(DisplayEvent),
    /// Witness: what is on the wizard's screen from now on.
    Screen(VisibleScreen),
    /// Witness: the wizard sees from now on what these concepts would say, beside what is sent.
    Unblinded {
        concepts: Vec<ConceptName>,
    },
    /// Witness: the terminal lost the keyboard: keys went elsewhere, the robot stop among them.
    FocusLost,
    FocusRegained,
    /// Witness: what a simulated participant believes, written before each of its presses.
    ParticipantBelieves(BeliefWitness),
    /// Witness: what was estimated of the human's belief before the press of the human that was just recorded.
    BeliefEstimated(EstimateWitness),
    /// The session is over; a log without it was cut.
    SessionEnded,
}

impl Event {
    /// Whether it is one of many samples, of the gaze or of how the arm stands.
    pub fn is_sample(&self) -> bool {
        matches!(self, Event::Gaze(_) | Event::RobotMoves(_))
    }

    /// The word that stands for it in the log.
    pub fn kind(&self) -> &'static str {
        match self {
            Event::Preflight { .. } => "preflight",
            Event::TrialStarted => "trial_started",
            Event::TrialPaused => "trial_paused",
            Event::TrialResumed => "trial_resumed",
            Event::TrialEnded { .. } => "trial_ended",
            Event::TrialAborted { .. } => "trial_aborted",
            Event::TrialExcluded { .. } => "trial_excluded",
            Event::TrialIncluded => "trial_included",
            Event::Gaze(_) => "gaze",
            Event::Tracker(_) => "tracker",
            Event::Calibration(_) => "calibration",
            Event::Press { .. } => "press",
            Event::OrderShown { .. } => "order_shown",
            Event::OrderCleared { .. } => "order_cleared",
            Event::RobotIntends { .. } => "robot_intends",
            Event::RobotAborts { .. } => "robot_aborts",
            Event::RobotIdles { .. } => "robot_idles",
            Event::RobotMoves(_) => "robot_moves",
            Event::RobotSafety { .. } => "robot_safety",
            Event::RobotTouched { .. } => "robot_touched",
            Event::RobotStopped => "robot_stopped",
            Event::RobotResumed => "robot_resumed",
            Event::RobotHeld { .. } => "robot_held",
            Event::RobotReleased { .. } => "robot_released",
            Event::RobotSkipped { .. } => "robot_skipped",
            Event::RobotDriven { .. } => "robot_driven",
            Event::KitchenCorrected { .. } => "kitchen_corrected",
            Event::Advised(_) => "advised",
            Event::SignalShown { .. } => "signal_shown",
            Event::SignalDrawn { .. } => "signal_drawn",
            Event::SignalEnded { .. } => "signal_ended",
            Event::Marker { .. } => "marker",
            Event::Protocol(_) => "protocol",
            Event::ClockJumped { .. } => "clock_jumped",
            Event::Display(_) => "display",
            Event::Screen(_) => "screen",
            Event::Unblinded { .. } => "unblinded",
            Event::FocusLost => "focus_lost",
            Event::FocusRegained => "focus_regained",
            Event::ParticipantBelieves(_) => "participant_believes",
            Event::BeliefEstimated(_) => "belief_estimated",
            Event::SessionEnded => "session_ended",
        }
    }
}

/// Why a trial ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndReason {
    /// The set number of presses of both agents was reached.
    Presses,
    /// The set time was over.
    Time,
    /// The set number of orders was served.
    Orders,
    /// The wizard ended it.
    Wizard,
    /// The wizard aborted it: `trial_aborted` says why, and `trial_ended` never says this.
    Aborted,
}

impl EndReason {
    /// As it stands in logs.
    pub fn name(self) -> &'static str {
        match self {
            EndReason::Presses => "presses",
            EndReason::Time => "time",
            EndReason::Orders => "orders",
            EndReason::Wizard => "wizard",
            EndReason::Aborted => "aborted",
        }
    }
}

/// How a signal ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignalEnd {
    /// It was shown for its set time.
    Elapsed,
    /// Its sender took it back.
    TakenBack,
}
