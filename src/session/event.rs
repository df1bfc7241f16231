//! Events of a session. A log is a list of events, and a session is determined by its log.
//!
//! Facts change the session when they are applied; witnesses are only recorded. Events identify locations, dishes and
//! buttons by name, so that a log can be read without the program.

use serde::{Deserialize, Serialize};

use super::gaze_check::GazeCheckEvent;
use super::preflight_check::PreflightCheck;
use super::probe_event::ProbeEvent;
use super::protocol_event::ProtocolEvent;
use super::tracker::TrackerEvent;
use super::wall_display::DisplayEvent;
use super::wizard_screen::WizardScreenContent;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::offer::{OfferCloseReason, OfferedAdvice};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::Agent;
use tomcom_core::mind::RecordedBelief;
use tomcom_core::mind::RecordedEstimate;
use tomcom_core::robot::ArmSample;
use tomcom_core::robot::SafetyMode;
use tomcom_core::robot::{AbortReason, IdleReason};

/// An event with its sequence number in the log and its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimestampedEvent {
    /// Sequence number: 0, 1, 2, … without gaps.
    pub seq: u64,
    /// Session time of the event; never decreases along the log.
    #[serde(rename = "t_ns")]
    pub time: SessionTime,
    /// What happened in the session.
    #[serde(flatten)]
    pub event: Event,
}

/// An event of a session, as the log contains it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Event {
    /// Results of the preflight checks before the trial, and whether the wizard overrode them.
    Preflight {
        /// The preflight checks and their results.
        checks: Vec<PreflightCheck>,
        /// Whether the wizard started the trial although not all checks were ok.
        overridden: bool,
    },
    /// The trial starts with an empty kitchen.
    TrialStarted,
    /// The trial is paused: clock, robot and orders stop, presses have no effect.
    TrialPaused,
    /// The paused trial resumes: clock, robot and orders continue.
    TrialResumed,
    /// The trial has ended.
    TrialEnded {
        /// The reason for the end of the trial.
        reason: TrialEndReason,
    },
    /// The trial is aborted and does not count; it may be repeated in another recording.
    TrialAborted {
        /// The wizard's reason for aborting the trial.
        reason: String,
    },
    /// The trial is excluded from the analysis.
    TrialExcluded {
        /// The wizard's reason for excluding the trial.
        reason: String,
    },
    /// The wizard includes an excluded trial in the analysis again.
    TrialIncluded,
    /// A gaze sample of the participant.
    Gaze(GazeSample),
    /// An event of the eye tracker other than a gaze sample.
    Tracker(TrackerEvent),
    /// A step of a gaze accuracy check.
    Calibration(GazeCheckEvent),
    /// An agent pressed a physical button.
    Press {
        /// The agent that pressed.
        agent: Agent,
        /// Name of the pressed button.
        button: String,
        /// Session time of the press by the display's synchronised clock; slightly before the event's time, at which
        /// the session received it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_ns: Option<SessionTime>,
    },
    /// A new order appears at an order location.
    OrderShown {
        /// Name of the order's location.
        order: String,
        /// Name of the ordered dish.
        dish: String,
    },
    /// An order location no longer shows `served`.
    OrderCleared {
        /// Name of the order's location.
        order: String,
    },
    /// The human has not pressed for unusually long, compared with the human's own intervals between presses, and may be
    /// stuck.
    HumanWaits {
        /// Time since the human's last press, without pauses.
        silent_ns: SessionTime,
    },
    /// The robot starts a press and will touch the button at `until_ns` unless it is interrupted.
    RobotIntends {
        /// Name of the button that the robot is going to press.
        button: String,
        /// Session time at which the robot will touch the button if it is not interrupted.
        until_ns: SessionTime,
        /// Whether the press is part of the robot's initiative, since the participant does not press; absent if not.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        initiative: bool,
    },
    /// The robot aborts the press that it has begun.
    RobotAborts {
        /// Name of the button that the robot does not press.
        button: String,
        /// Why the robot abandoned the press.
        reason: AbortReason,
    },
    /// The robot becomes idle: the robot has no useful press.
    RobotIdles {
        /// Why the robot is idle.
        reason: IdleReason,
        /// Names of the human's buttons for a press of one of which the robot waits.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        waits_for: Vec<String>,
    },
    /// Recorded only (witness): a sample of the simulated arm's motion, about 12 per second while it moves.
    RobotMoves(ArmSample),
    /// The safety mode of the simulated arm changes. After a protective stop or a fault the arm does not move until the
    /// wizard resumes it.
    RobotSafety {
        /// The safety mode from now on.
        mode: SafetyMode,
        /// Contact force in newtons, if it caused the change.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        force_n: Option<f64>,
        /// Number of the faulty joint, from 1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        joint: Option<u8>,
    },
    /// Recorded only (witness): a contact between the simulated arm and the human, with its peak force in newtons; once
    /// per contact.
    RobotTouched {
        /// The greatest force of the contact in newtons.
        force_n: f64,
    },
    /// The wizard stops the robot until the wizard releases it.
    RobotStopped,
    /// The wizard releases the stopped robot.
    RobotResumed,
    /// The wizard holds the robot: while held, the robot starts no press and waits before the button of the ongoing
    /// press, until the wizard releases it.
    RobotHeld {
        /// Who holds the robot back; only the wizard can.
        by: Sender,
    },
    /// The robot, which was held back, may continue.
    RobotReleased {
        /// Who lets the held robot continue; only the wizard can.
        by: Sender,
    },
    /// The wizard skips the robot's ongoing press; the robot decides anew.
    RobotSkipped {
        /// Who skips the robot's press; only the wizard can.
        by: Sender,
    },
    /// The wizard chooses the robot's next press.
    RobotDriven {
        /// Who chose the robot's next press; only the wizard can.
        by: Sender,
        /// Name of the button that the robot shall press.
        button: String,
    },
    /// The wizard corrects the content of a location in the program's state, which differed from the real one.
    KitchenCorrected {
        /// Name of the corrected location.
        location: String,
        /// Name of the content that really is at the corrected location.
        content: String,
    },
    /// A signal is shown to the participant and replaces the previous one.
    SignalShown {
        /// Who sent the signal (wizard or assistant).
        by: Sender,
        /// The signal that is shown on the participant's display.
        signal: Signal,
        /// Sequence number of the `offer_opened` whose offer the wizard took, if any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        offer: Option<u64>,
    },
    /// A recommendation of the assistant, which refers to an earlier event if it was computed while the session
    /// continued.
    Advised(Recommendation),
    /// An offer to the wizard opens: the assistant recommends a signal or presses.
    OfferOpened(OfferedAdvice),
    /// The open offer to the wizard closes.
    OfferClosed {
        /// Sequence number of the event `offer_opened` by which the offer opened.
        offer: u64,
        /// Why the offer to the wizard closes.
        reason: OfferCloseReason,
    },
    /// Recorded only (witness): the first frame with the signal of this sequence number was written to the terminal.
    SignalDrawn {
        /// Sequence number of the event that showed the signal.
        signal: u64,
    },
    /// The signal disappears from the participant's display.
    SignalEnded {
        /// Why the signal disappears.
        reason: SignalEndReason,
    },
    /// The wizard sets a marker, a time mark with a note.
    Marker {
        /// Text of the wizard's note.
        note: String,
    },
    /// An event of a freeze probe.
    Probe(ProbeEvent),
    /// An event of the study protocol.
    Protocol(ProtocolEvent),
    /// Recorded only (witness): the wall clock advanced by this much more than session time, in milliseconds (negative:
    /// less), because the computer was suspended or its clock was set.
    ClockJumped {
        /// How much further the wall clock advanced than session time, in milliseconds; negative: the wall clock
        /// advanced less.
        by_ms: i64,
    },
    /// Recorded only (witness): a report of the participant's display.
    Display(DisplayEvent),
    /// Recorded only (witness): the visible content of the wizard's screen changes.
    Screen(WizardScreenContent),
    /// Recorded only (witness): from now on the wizard sees how these communication concepts compare with the wizard.
    Unblinded {
        /// Names of the communication concepts that the wizard sees compared.
        concepts: Vec<ConceptName>,
    },
    /// Recorded only (witness): the terminal lost or regained keyboard focus; without focus no key arrives, including
    /// the robot stop.
    FocusLost,
    /// Recorded only (witness): the terminal has keyboard focus again.
    FocusRegained,
    /// Recorded only (witness): the belief of a simulated participant before its next press.
    ParticipantBelieves(RecordedBelief),
    /// Recorded only (witness): the belief estimate before the last press of the human.
    BeliefEstimated(RecordedEstimate),
    /// The session ends; a log without this event was cut off.
    SessionEnded,
}

impl Event {
    /// Whether the event is a sample of the gaze or of the arm's motion.
    pub fn is_sample(&self) -> bool {
        matches!(self, Event::Gaze(_) | Event::RobotMoves(_))
    }

    /// Name of the event in the log.
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
            Event::HumanWaits { .. } => "human_waits",
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
            Event::OfferOpened(_) => "offer_opened",
            Event::OfferClosed { .. } => "offer_closed",
            Event::SignalShown { .. } => "signal_shown",
            Event::SignalDrawn { .. } => "signal_drawn",
            Event::SignalEnded { .. } => "signal_ended",
            Event::Marker { .. } => "marker",
            Event::Probe(_) => "probe",
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

/// Reason for the end of a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialEndReason {
    /// The trial ended because its set number of presses was reached.
    Presses,
    /// The trial ended because its set duration was reached.
    Time,
    /// The trial ended because its set number of orders was served.
    Orders,
    /// The trial ended because the wizard ended it.
    Wizard,
    /// The wizard aborted the trial; recorded as `trial_aborted`, never as `trial_ended`.
    Aborted,
}

impl TrialEndReason {
    /// Name of the reason for the trial's end in logs.
    pub fn name(self) -> &'static str {
        match self {
            TrialEndReason::Presses => "presses",
            TrialEndReason::Time => "time",
            TrialEndReason::Orders => "orders",
            TrialEndReason::Wizard => "wizard",
            TrialEndReason::Aborted => "aborted",
        }
    }
}

/// Reason for the end of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignalEndReason {
    /// The signal was shown for its set time.
    Elapsed,
    /// The sender withdrew the signal.
    TakenBack,
    /// The proposed presses are out of date: they were made, another button was pressed, or the next proposed press
    /// would have no effect.
    Outdated,
}
