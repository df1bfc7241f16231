//! The state of a session, computed from its events.

use std::sync::Arc;

use crate::event::{SignalEndReason, TrialEndReason};
use crate::gaze_check::{AcceptedGazeCheck, RunningGazeCheck};
use crate::probes::{ProbeEvent, TrialProbes};
use crate::protocol::StudyProtocolState;
use crate::settings::{Condition, WizardVisibility};
use crate::study_arm::StudyArm;
use crate::tracker::TrackerStatus;
use crate::{GazeStatus, SessionSpec};
use tomcom_core::base::rng::of_trial;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::OfferHistory;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{HighlightSet, Sender, Signal};
use tomcom_core::kitchen::no_effect::NoEffectReason;
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, State};
use tomcom_core::robot::moment::ArmSample;
use tomcom_core::robot::safety::SafetyMode;
use tomcom_core::robot::{AbortReason, IdleReason};
use tomcom_people::wizard::settings::WizardKind;

/// Time without a gaze sample after which gaze counts as missing, in seconds.
const SILENT_S: f64 = 1.0;

/// The state of a session after its events so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The kitchen of the session, compiled from its files.
    pub kitchen: Arc<Kitchen>,
    /// The settings of the session in use.
    pub spec: SessionSpec,
    /// Index of the session's trial.
    pub trial: u64,
    /// The session time of the last event.
    pub time: SessionTime,
    /// The phase of the session's trial: ready, running, paused or over.
    pub phase: TrialPhase,
    /// Session time of the trial's start.
    pub trial_start: SessionTime,
    /// Total duration of all finished pauses of the trial's clock.
    pub paused_total: SessionTime,
    /// Session time at which the trial's clock last stopped: at the beginning of a pause, or at the trial's end.
    pub paused_at: SessionTime,
    /// Session times of start and end of each finished pause of the trial.
    pub pauses: Vec<(SessionTime, SessionTime)>,
    /// True state of the kitchen: the content of every location.
    pub state: State,
    /// Session time of the last change of each location.
    pub changed_at: [SessionTime; MAX_LOCATIONS],
    /// Number of presses during the trial by each agent, indexed by [`tomcom_core::kitchen::Agent::index`].
    pub presses: [u32; 2],
    /// The orders that were served in the trial.
    pub served: Vec<ServedOrder>,
    /// Present state of the robot.
    pub robot: RobotStatus,
    /// The signal on the participant's display, if there is one.
    pub shown: Option<ShownSignal>,
    /// The assistant's latest recommendation in the running trial.
    pub advice: Option<Recommendation>,
    /// The open offer to the wizard, and the offers that have closed.
    pub offers: OfferHistory,
    /// Whether a console shows the session to a person (the wizard).
    pub has_console: bool,
    /// Sequence number of the latest event for which the participant's display flashes (trial start, signal).
    pub cue: Option<u64>,
    /// Session time of the wizard's last signal.
    pub signalled_at: Option<SessionTime>,
    /// Whether the wizard saw the comparison of the wizard's signals with those of the assistants.
    pub unblinded: bool,
    /// Reason for aborting the trial, if it was aborted.
    pub aborted: Option<String>,
    /// Reason for excluding the trial from the analysis, if it is excluded.
    pub excluded: Option<String>,
    /// State of the participant's gaze stream.
    pub gaze: GazeStatus,
    /// State of the eye tracker.
    pub tracker: TrackerStatus,
    /// The gaze accuracy check that is running or waits for the wizard's decision.
    pub calibration: Option<RunningGazeCheck>,
    /// The last accepted gaze accuracy check.
    pub calibrated: Option<AcceptedGazeCheck>,
    /// All entries of the session's timeline (events without gaze samples).
    pub timeline: Vec<TimelineEntry>,
    /// The freeze probes of the trial.
    pub probes: TrialProbes,
    /// State of the study protocol (phases and answers), if the recording belongs to a plan.
    pub protocol: Option<StudyProtocolState>,
}

/// An order that was served in the trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServedOrder {
    /// Session time at which the order was served.
    pub time: SessionTime,
    /// The dish that the served order wanted.
    pub dish: DishId,
    /// Number of presses of both agents in the trial up to the serving press, which is included.
    pub presses: u32,
}

/// A signal on the participant's display.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownSignal {
    /// The signal that the display shows.
    pub signal: Signal,
    /// The location that the signal is about; `None` for proposed presses.
    pub location: Option<LocationId>,
    /// Who sent the displayed signal.
    pub by: Sender,
    /// Session time at which the signal appeared.
    pub since: SessionTime,
    /// Session time at which the signal will disappear by itself.
    pub until: SessionTime,
}

impl Session {
    /// Locations whose content last changed at this session time.
    pub fn changed_at(&self, time: SessionTime) -> impl Iterator<Item = LocationId> + '_ {
        let times = self.changed_at[..self.kitchen.locations.len()].iter().enumerate();
        times.filter(move |(_, at)| **at == time).map(|(index, _)| LocationId(index as u8))
    }

    /// The locations that signals may highlight in this session.
    pub fn highlights(&self) -> HighlightSet {
        self.spec.highlights(&self.kitchen)
    }

    /// The state of a session before its first event.
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, trial: u64) -> Session {
        let state = kitchen.empty_state();
        let protocol = spec.step.as_ref().map(|_| StudyProtocolState::default());
        Session {
            kitchen,
            spec,
            trial,
            time: SessionTime::ZERO,
            phase: TrialPhase::Ready,
            trial_start: SessionTime::ZERO,
            paused_total: SessionTime::ZERO,
            paused_at: SessionTime::ZERO,
            pauses: Vec::new(),
            state,
            changed_at: [SessionTime::ZERO; MAX_LOCATIONS],
            presses: [0; 2],
            served: Vec::new(),
            robot: RobotStatus::default(),
            shown: None,
            advice: None,
            offers: OfferHistory::default(),
            has_console: false,
            cue: None,
            signalled_at: None,
            unblinded: false,
            aborted: None,
            excluded: None,
            gaze: GazeStatus::default(),
            tracker: TrackerStatus::default(),
            calibration: None,
            calibrated: None,
            timeline: Vec::new(),
            probes: TrialProbes::default(),
            protocol,
        }
    }

    /// Reading of the trial's clock at `now`: time since the trial's start without pauses; zero before the start.
    pub fn trial_clock(&self, now: SessionTime) -> SessionTime {
        match self.phase {
            TrialPhase::Ready => SessionTime::ZERO,
            TrialPhase::Running => now - self.trial_start - self.paused_total,
            TrialPhase::Paused => self.paused_at - self.trial_start - self.paused_total,
            TrialPhase::Over(_) | TrialPhase::Closed => self.paused_at - self.trial_start - self.paused_total,
        }
    }

    /// Time from `at` to `now` on the trial's clock, without pauses and without the time after the trial's end.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = match self.phase {
            TrialPhase::Ready | TrialPhase::Running => now,
            TrialPhase::Paused | TrialPhase::Over(_) | TrialPhase::Closed => self.paused_at,
        };
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// Sampling rate of the gaze in Hz; `None` if no sample came for a second.
    pub fn gaze_hz(&self, now: SessionTime) -> Option<f64> {
        let arrived = self.gaze.arrived.filter(|&arrived| now.secs_since(arrived) <= SILENT_S);
        arrived.map(|_| self.gaze.rate_hz)
    }

    /// Random seed of estimates and recommendations, unique to the trial.
    pub fn seed(&self) -> u64 {
        of_trial(self.spec.seed, self.trial)
    }

    /// Whether the settings let the wizard (a person or a script) see the assistant's recommendations.
    fn wizard_is_to_see_advice(&self) -> bool {
        let spec = &self.spec;
        match spec.wizard.kind {
            WizardKind::Scripted => spec.script_reads_offers(),
            WizardKind::Person => {
                spec.trial.condition == Condition::Wizard && spec.console.visibility == WizardVisibility::Recommendation
            }
        }
    }

    /// Whether the wizard (a person or a script) saw the assistant's recommendations.
    pub fn wizard_saw_advice(&self) -> bool {
        let is_persons = self.spec.wizard.kind == WizardKind::Person;
        let was_unblinded = self.unblinded && is_persons && self.spec.trial.condition == Condition::Wizard;
        was_unblinded || self.wizard_is_to_see_advice()
    }

    /// The study arm of the trial as it was actually carried out: whether the wizard really saw advice.
    pub fn study_arm(&self) -> StudyArm {
        self.arm_of_settings(self.wizard_saw_advice())
    }

    /// The study arm under which the trial counts, whatever happened in it: the arm that the plan assigned or, without a
    /// plan, the arm of the settings.
    pub fn planned_arm(&self) -> StudyArm {
        let assigned = self.spec.step.as_ref().and_then(|step| step.arm);
        assigned.unwrap_or_else(|| self.arm_of_settings(self.wizard_is_to_see_advice()))
    }

    fn arm_of_settings(&self, saw_advice: bool) -> StudyArm {
        StudyArm::from_settings(self.spec.trial.condition, self.spec.assistant.concept, saw_advice)
    }

    /// Number of presses of both agents during the trial.
    pub fn all_presses(&self) -> u32 {
        self.presses.iter().sum()
    }

    /// Whether the trial is running: started, and neither paused nor over.
    pub fn is_running(&self) -> bool {
        self.phase == TrialPhase::Running
    }

    /// Adds an entry to the session's timeline.
    pub(crate) fn note(&mut self, time: SessionTime, what: TimelineEvent) {
        self.timeline.push(TimelineEntry { time, what });
    }
}

/// Phase of a session's trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialPhase {
    /// The trial has not started.
    Ready,
    /// The trial is running: its clock goes.
    Running,
    /// The trial is paused: its clock stands still.
    Paused,
    /// The trial has ended; the reason says why.
    Over(TrialEndReason),
    /// The session has ended, and its recording is closed.
    Closed,
}

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

/// State of the robot in a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotStatus {
    /// The robot's ongoing press: button, start, and expected time of contact.
    pub intention: Option<(ButtonId, SessionTime, SessionTime)>,
    /// Whether the ongoing or last press is part of the robot's initiative.
    pub initiative: bool,
    /// Number of presses that the robot made by its initiative while the trial ran.
    pub initiative_presses: u32,
    /// Whether the robot is stopped, by the wizard or by itself, until the wizard resumes it.
    pub stopped: bool,
    /// Whether the wizard holds the robot before its next press.
    pub held: bool,
    /// The press that the wizard chose for the robot, until the robot has made or aborted that press.
    pub driven_to: Option<ButtonId>,
    /// Why the robot is idle, if it is, and the human's buttons for a press of one of which it waits.
    pub idle: Option<(IdleReason, Vec<ButtonId>)>,
    /// State of the simulated robot arm.
    pub arm: ArmStatus,
}

/// Pose and safety state of the simulated arm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmStatus {
    /// Last sample of the arm's motion with its time; `None` before the first motion and for the timed arm.
    pub last: Option<(SessionTime, ArmSample)>,
    /// The safety mode of the arm: normal, slowed, or stopped for a reason.
    pub mode: SafetyMode,
    /// Contact force that caused a protective stop, in newtons.
    pub stopped_by_n: Option<f64>,
}

impl RobotStatus {
    /// Whether the wizard stopped the robot (also possible after a protective stop).
    pub fn is_stopped_by_wizard(&self) -> bool {
        self.stopped && !self.arm.mode.has_stopped_itself()
    }

    /// The safety mode as screens name it: a stop by the wizard is an emergency stop also of the timed arm, which has no
    /// safety modes of its own.
    pub fn safety_mode(&self) -> SafetyMode {
        if self.is_stopped_by_wizard() { SafetyMode::EmergencyStop } else { self.arm.mode }
    }

    /// Records that the robot starts a press and will touch the button at `until`.
    pub(crate) fn sets_out(&mut self, button: ButtonId, now: SessionTime, until: SessionTime, initiative: bool) {
        self.intention = Some((button, now, until));
        self.initiative = initiative;
        self.idle = None;
    }

    pub(crate) fn gives_up(&mut self, reason: AbortReason) {
        self.intention = None;
        // If the wizard chose another press for the robot, that press is still pending.
        self.driven_to = self.driven_to.filter(|_| reason == AbortReason::Driven);
    }

    /// Records the end of the trial: the robot has no press and is not idle for a reason.
    pub(crate) fn rests(&mut self) {
        self.intention = None;
        self.driven_to = None;
        self.idle = None;
    }
}

impl Session {
    /// Agent whose press changed a location at this session time, from the timeline.
    pub fn changed_by(&self, at: SessionTime) -> Option<Agent> {
        let since = self.timeline.iter().rev().take_while(|entry| entry.time >= at);
        since.filter(|entry| entry.time == at).find_map(|entry| match entry.what {
            TimelineEvent::Press { agent, no_effect: None, .. } => Some(agent),
            _ => None,
        })
    }

    /// Whether a location changed without a press of the human, and the participant has not looked at the location
    /// since.
    pub fn is_unseen(&self, location: LocationId) -> bool {
        let at = self.changed_at[location.index()];
        let seen = self.gaze.looked_at[location.index()].is_some_and(|seen| seen >= at);
        let knows = seen || self.gaze.samples == 0 || at == SessionTime::ZERO;
        !knows && self.changed_by(at) != Some(Agent::Human)
    }
}
