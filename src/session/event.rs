//! Events of a session. A log is a list of events, and a session is determined by its log.
//!
//! Facts change the session when they are applied; witnesses are only recorded. Events identify locations, dishes and
//! buttons by name, so that a log can be read without the program.

use serde::{Deserialize, Serialize};

use crate::button_box::ButtonBoxEvent;
use crate::external::ExternalEvent;
use crate::film::FilmEvent;
use crate::gaze_check::GazeCheckEvent;
use crate::preflight_checks::PreflightCheck;
use crate::probes::ProbeEvent;
use crate::protocol::ProtocolEvent;
use crate::settings::WizardVisibility;
use crate::tracker::TrackerEvent;
use crate::tutorial::TutorialEvent;
use crate::wall_display::DisplayEvent;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::offer::{OfferCloseReason, OfferedAdvice};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal};
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::Agent;
use tomcom_core::mind::{RecordedBelief, RecordedEstimate};
use tomcom_core::robot::{AbortReason, ArmSample, ArmStage, IdleReason, SafetyMode};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimestampedEvent {
    /// 0, 1, 2, … without gaps.
    pub seq: u64,
    /// Never decreases along the log.
    #[serde(rename = "t_ns")]
    pub time: SessionTime,
    #[serde(flatten)]
    pub event: Event,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, strum::IntoStaticStr, strum::VariantNames)]
#[serde(tag = "kind", rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Event {
    /// The checks before the trial.
    Preflight {
        checks: Vec<PreflightCheck>,
        /// Whether the wizard started the trial although not all checks were ok.
        overridden: bool,
    },
    /// The trial starts with an empty kitchen.
    TrialStarted,
    /// The trial is paused: clock, robot and orders stop, presses have no effect.
    TrialPaused,
    /// The trial's clock goes on.
    TrialResumed,
    /// By itself, or by the wizard; an aborted one has an event of its own.
    TrialEnded { reason: TrialEndReason },
    /// The trial is aborted and does not count; it may be repeated in another recording.
    TrialAborted { reason: String },
    /// The trial is left out of the analysis.
    TrialExcluded { reason: String },
    /// An excluded trial counts again.
    TrialIncluded,
    /// On the display or beside it.
    Gaze(GazeSample),
    /// Other than a gaze sample.
    Tracker(TrackerEvent),
    /// A step of a gaze accuracy check.
    Calibration(GazeCheckEvent),
    /// Of a button, by the participant or the robot; it may have no effect.
    Press {
        agent: Agent,
        button: String,
        /// When the button went down by the display's synchronised clock, or when the button box's line arrived: slightly
        /// before the event's time, at which the session received it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_ns: Option<SessionTime>,
        /// Whether it came from the button box, and not from the page or the console.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        button_box: bool,
    },
    /// A new order appears.
    OrderShown { order: String, dish: String },
    /// The location no longer shows `served`.
    OrderCleared { order: String },
    /// The human has not pressed for unusually long, and may be stuck.
    HumanWaits {
        /// Since the human's last press, without pauses.
        silent_ns: SessionTime,
    },
    /// The robot starts a press and will touch the button at `until_ns` unless it is interrupted.
    RobotIntends {
        button: String,
        until_ns: SessionTime,
        /// Whether the robot takes the initiative, since the participant does not press.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        initiative: bool,
    },
    /// The robot gives up its press.
    RobotAborts { button: String, reason: AbortReason },
    /// The robot has no useful press.
    RobotIdles {
        reason: IdleReason,
        /// The human's buttons for a press of one of which the robot waits.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        waits_for: Vec<String>,
    },
    /// A sample of the motion of an arm with joints, about 12 per second while it moves; of the simulated arm a witness.
    RobotMoves(ArmSample),
    /// Of an arm with joints. After a protective stop or a fault it does not move until the wizard resumes it.
    RobotSafety {
        mode: SafetyMode,
        /// Contact force, if it caused the change.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        force_n: Option<f64>,
        /// Number of the faulty joint, from 1.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        joint: Option<u8>,
    },
    /// How far a real arm is with being set up; beside `ready` it makes no press.
    RobotStage {
        stage: ArmStage,
        /// What was found, in words.
        found: String,
    },
    /// The wizard confirms what a real arm asks for in this stage.
    RobotConfirmed { stage: ArmStage },
    /// Witness: a contact between the simulated arm and the human, with its peak force; once per contact.
    RobotTouched { force_n: f64 },
    /// By the wizard.
    RobotStopped,
    /// The wizard lets the stopped robot go on.
    RobotResumed,
    /// While held, the robot starts no press and waits before the button of the ongoing one. Only the wizard can hold,
    /// release, skip and drive.
    RobotHeld { by: Sender },
    /// The held robot goes on.
    RobotReleased { by: Sender },
    /// The robot gives up its ongoing press and decides anew.
    RobotSkipped { by: Sender },
    /// The wizard chooses the robot's next press.
    RobotDriven { by: Sender, button: String },
    /// The wizard corrects the program's state, which differed from the real kitchen.
    KitchenCorrected { location: String, content: String },
    /// Replaces the signal that was shown.
    SignalShown {
        by: Sender,
        signal: Signal,
        /// Sequence number of the `offer_opened` whose offer the wizard took, if any.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        offer: Option<u64>,
    },
    /// Refers to an earlier event if it was computed while the session continued.
    Advised(Recommendation),
    /// From an external concept or participant.
    External(ExternalEvent),
    /// A recommendation is offered to the wizard.
    OfferOpened(OfferedAdvice),
    /// Taken or not.
    OfferClosed {
        /// Sequence number of its `offer_opened`.
        offer: u64,
        reason: OfferCloseReason,
    },
    /// Witness: the first frame with the signal of this sequence number was written to the terminal.
    SignalDrawn { signal: u64 },
    /// It disappears from the participant's display.
    SignalEnded { reason: SignalEndReason },
    /// A time mark of the wizard, without words if they are to be typed later; or an observer's remark.
    Marker {
        note: String,
        /// Code of the observer whose remark it is; without one it is the wizard's.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        observer: Option<String>,
    },
    /// The words of an earlier time mark; empty if it stays without.
    MarkerWorded {
        /// Sequence number of the mark.
        marker: u64,
        note: String,
    },
    /// A step of a freeze probe.
    Probe(ProbeEvent),
    /// A step of the study around the trial.
    Protocol(ProtocolEvent),
    /// Witness: the wall clock advanced by this much more than session time (negative: less), because the computer was
    /// suspended or its clock was set.
    ClockJumped { by_ms: i64 },
    /// Witness.
    Display(DisplayEvent),
    /// Witness: other than a press.
    ButtonBox(ButtonBoxEvent),
    /// Witness: what happens to a film that the program records.
    Film(FilmEvent),
    /// Witness: the visible content of the wizard's screen changes.
    Screen(WizardScreenContent),
    /// Witness: from now on the wizard sees how these concepts compare with the wizard.
    Unblinded { concepts: Vec<ConceptName> },
    /// Witness: without keyboard focus no key arrives, not even the robot stop.
    FocusLost,
    /// Witness.
    FocusRegained,
    /// Witness: the belief of a simulated participant before its next press.
    ParticipantBelieves(RecordedBelief),
    /// Witness: the belief estimate before the last press of the human.
    BeliefEstimated(RecordedEstimate),
    /// A log without this event was cut off.
    SessionEnded,
}

impl Event {
    /// Of the gaze, or of the arm's motion.
    pub fn is_sample(&self) -> bool {
        matches!(self, Event::Gaze(_) | Event::RobotMoves(_))
    }

    /// Whether an event is hidden from raters: it reveals the trial's condition (a signal, an offer, a recommendation), or
    /// what the wizard thought.
    pub fn is_hidden_from_raters(&self) -> bool {
        matches!(
            self,
            Event::SignalShown { .. }
                | Event::SignalDrawn { .. }
                | Event::SignalEnded { .. }
                | Event::OfferOpened(_)
                | Event::OfferClosed { .. }
                | Event::Advised(_)
                | Event::External(_)
                | Event::Unblinded { .. }
                | Event::Marker { .. }
                | Event::MarkerWorded { .. }
        )
    }

    /// Fields of an event that can identify a person, a computer or its folders; streams in a network leave them out, since everybody
    /// there can read them.
    pub fn private_fields(&self) -> &'static [&'static str] {
        match self {
            Event::Marker { observer: Some(_), .. } => &["note", "observer"],
            Event::Marker { .. } | Event::MarkerWorded { .. } => &["note"],
            Event::TrialAborted { .. } | Event::TrialExcluded { .. } => &["reason"],
            Event::Preflight { .. } => &["checks"],
            Event::External(_) => &["name", "found", "answer"],
            Event::Advised(advice) if advice.words.is_some() => &["words"],
            Event::Tracker(TrackerEvent::Connected { .. }) | Event::ButtonBox(ButtonBoxEvent::Connected { .. }) => {
                &["device"]
            }
            Event::Tracker(TrackerEvent::Lost { .. }) => &["reason"],
            Event::Film(FilmEvent::Lost { .. }) | Event::ButtonBox(ButtonBoxEvent::Lost { .. }) => &["reason"],
            Event::ButtonBox(ButtonBoxEvent::Refused { .. }) | Event::RobotStage { .. } => &["found"],
            Event::Tracker(TrackerEvent::OtherSurfaces { .. }) => &["names"],
            Event::Tracker(TrackerEvent::SeveralStreams { .. }) => &["streams"],
            Event::Protocol(ProtocolEvent::ItemAnswered { .. }) => &["answer"],
            Event::Probe(ProbeEvent::Answered { .. }) => &["answer", "confidence"],
            Event::Protocol(ProtocolEvent::Tutorial(TutorialEvent::Answered { .. })) => &["choice"],
            Event::Protocol(ProtocolEvent::CriterionWaived { .. }) | Event::Probe(ProbeEvent::Skipped { .. }) => {
                &["reason"]
            }
            _ => &[],
        }
    }

    /// Name of the event in the log.
    pub fn kind(&self) -> &'static str {
        self.into()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum TrialEndReason {
    Presses,
    Time,
    Orders,
    Wizard,
    /// Recorded as `trial_aborted`, never as `trial_ended`.
    Aborted,
}

named!(TrialEndReason);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SignalEndReason {
    /// It was shown for its set time.
    Elapsed,
    TakenBack,
    /// Proposed presses were made, another button was pressed, or the next one would have no effect.
    Outdated,
}

/// What the wizard's screen shows, recorded at every change, since the wizard's decisions depend on it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WizardScreenContent {
    pub visibility: WizardVisibility,
    /// `small`, `medium`, `large`, or `too_small` for anything but questions.
    pub room: String,
    /// From top to bottom.
    pub panels: Vec<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dialog: Option<String>,
}

/// What each kind of event means, for exports; without samples, which have tables of their own.
pub const MEANINGS: &[(&str, &str)] = &[
    ("advised", "The assistant computed a recommendation; seen only if an offer follows"),
    (
        "belief_estimated",
        "The participant's belief before a press was estimated; the probabilities stand in the table of beliefs",
    ),
    ("button_box", "The participant's button box was connected or lost, or sent what is no press"),
    ("calibration", "A step of the gaze accuracy check"),
    ("clock_jumped", "The wall clock moved against session time: the computer stood still, or its clock was set"),
    ("display", "A report of the participant's display"),
    ("external", "An external concept or participant began, told its belief, was late, or made a fault"),
    ("film", "A camera's film of the trial began, was lost, or is back"),
    ("focus_lost", "The wizard's terminal lost the keyboard"),
    ("focus_regained", "The wizard's terminal has the keyboard again"),
    ("human_waits", "The participant has not pressed for unusually long by its own intervals"),
    ("kitchen_corrected", "The wizard corrected what the program thought of a place"),
    ("marker", "The wizard marked this moment, or an observer remarked something"),
    ("marker_worded", "The wizard's words about a moment marked before"),
    ("offer_closed", "An offer to the wizard closed"),
    ("offer_opened", "A recommendation was offered to the wizard"),
    ("order_cleared", "A served order disappeared"),
    ("order_shown", "An order appeared"),
    (
        "participant_believes",
        "What a simulated participant believed before its press; the probabilities stand in the table of beliefs",
    ),
    ("preflight", "The checks before the trial"),
    ("press", "The participant or the robot pressed a button"),
    ("probe", "A freeze probe: the task stands still, and the participant is asked what it believes"),
    ("protocol", "A step of the study around the trial: consent, phases, tutorial, questionnaires"),
    ("robot_aborts", "The robot gave up its press"),
    ("robot_confirmed", "The wizard confirmed a step in which the real arm is set up"),
    ("robot_driven", "Somebody chose the robot's next press"),
    ("robot_held", "Somebody holds the robot before its next press"),
    (
        "robot_idles",
        "The robot has nothing useful to do: there is no order, or it waits for a press of the participant",
    ),
    ("robot_intends", "The robot sets out for a button"),
    ("robot_released", "The held robot goes on"),
    ("robot_resumed", "The wizard lets the stopped robot go on"),
    ("robot_safety", "The safety mode of the arm changed"),
    ("robot_skipped", "Somebody skipped the robot's press"),
    ("robot_stage", "How far the real arm is with being set up; it presses where it is ready"),
    ("robot_stopped", "The wizard stopped the robot"),
    ("robot_touched", "Somebody touched the arm"),
    ("screen", "What the wizard sees changed"),
    ("session_ended", "The recording is complete"),
    ("signal_drawn", "The first frame with a signal was drawn at the console"),
    ("signal_ended", "A signal disappeared"),
    ("signal_shown", "A signal was shown to the participant"),
    ("tracker", "An event of the eye tracker"),
    ("trial_aborted", "The trial was aborted and does not count"),
    ("trial_ended", "The trial is over"),
    ("trial_excluded", "The trial is left out of the analysis"),
    ("trial_included", "The trial counts again"),
    ("trial_paused", "The trial's clock stands still"),
    ("trial_resumed", "The trial's clock goes on"),
    ("trial_started", "The trial starts with an empty kitchen"),
    ("unblinded", "The wizard sees from now on what concepts would send"),
];
