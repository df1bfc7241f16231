//! The state of a session, computed from its events: trial, robot, timeline, and the state of each feature.

use std::sync::Arc;

use crate::button_box::ButtonBoxStatus;
use crate::event::{Event, TrialEndReason};
use crate::external::ExternalStatus;
use crate::gaze_check::{AcceptedGazeCheck, RunningGazeCheck};
use crate::order_needs::{OrderNeeds, OrderWork};
use crate::probes::TrialProbes;
use crate::protocol::StudyProtocolState;
use crate::settings::{Condition, GazeSource, WizardVisibility};
use crate::study_arm::StudyArm;
use crate::tracker::TrackerStatus;
use crate::{GazeStatus, SessionSpec};
use tomcom_core::base::rng::of_trial;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::OfferHistory;
use tomcom_core::communication::recommendation::{Recommendation, SignalReason};
use tomcom_core::communication::{HighlightSet, Sender, Signal};
use tomcom_core::kitchen::rules::NoEffectReason;
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_core::kitchen::{Agent, ButtonId, DishId, Kitchen, LocationId, State};
use tomcom_core::robot::{AbortReason, ArmSample, ArmStage, IdleReason, SafetyMode};
use tomcom_people::wizard::WizardKind;

/// Time without a sample after which gaze counts as missing.
const SILENT_S: f64 = 1.0;

#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    pub kitchen: Arc<Kitchen>,
    pub spec: SessionSpec,
    pub trial: u64,
    /// Of the last event.
    pub time: SessionTime,
    pub phase: TrialPhase,
    pub trial_start: SessionTime,
    /// Duration of all finished pauses.
    pub paused_total: SessionTime,
    /// When the trial's clock last stopped: at the beginning of a pause, or at the trial's end.
    pub paused_at: SessionTime,
    /// Start and end of each finished pause.
    pub pauses: Vec<(SessionTime, SessionTime)>,
    /// True state of the kitchen.
    pub state: State,
    /// Last change of each location.
    pub changed_at: [SessionTime; MAX_LOCATIONS],
    /// In the trial, by [`tomcom_core::kitchen::Agent::index`].
    pub presses: [u32; 2],
    pub served: Vec<ServedOrder>,
    pub robot: RobotStatus,
    /// The signal on the participant's display.
    pub shown: Option<ShownSignal>,
    /// The latest in the running trial.
    pub advice: Option<Recommendation>,
    pub offers: OfferHistory,
    /// Of the external minds, if the session has any.
    pub external: ExternalStatus,
    /// Whether a console shows the session to a person.
    pub has_console: bool,
    /// The latest event for which the participant's display flashes (trial start, signal, trial end).
    pub cue: Option<u64>,
    /// When the wizard sent the last signal.
    pub signalled_at: Option<SessionTime>,
    /// Whether the wizard saw how the assistants compare with the wizard.
    pub unblinded: bool,
    /// Why the trial was aborted, if it was.
    pub aborted: Option<String>,
    /// Why the trial is excluded from the analysis, if it is.
    pub excluded: Option<String>,
    pub gaze: GazeStatus,
    pub tracker: TrackerStatus,
    pub button_box: ButtonBoxStatus,
    /// Running, or waiting for the wizard's decision.
    pub calibration: Option<RunningGazeCheck>,
    /// The last accepted one.
    pub calibrated: Option<AcceptedGazeCheck>,
    /// Events without gaze samples.
    pub timeline: Vec<TimelineEntry>,
    /// Which order each content counts for, after the timeline's last entry.
    pub(crate) order_work: OrderWork,
    pub probes: TrialProbes,
    /// If the recording belongs to a plan.
    pub protocol: Option<StudyProtocolState>,
    /// Whether it was left before its trial, or its step of the plan, was done.
    pub ended_early: bool,
    /// Time marks whose words are not typed yet, oldest first: sequence number and time.
    pub open_marks: Vec<(u64, SessionTime)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServedOrder {
    pub time: SessionTime,
    pub dish: DishId,
    /// Of both agents in the trial, up to and with the serving press.
    pub presses: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ShownSignal {
    pub signal: Signal,
    /// `None` for proposed presses.
    pub location: Option<LocationId>,
    pub by: Sender,
    pub since: SessionTime,
    /// When it will disappear by itself.
    pub until: SessionTime,
    /// Why the assistant sent it; of a wizard's signal nothing is known.
    pub reason: Option<SignalReason>,
    /// The reason in an external concept's own words.
    pub words: Option<String>,
}

impl Session {
    /// Locations whose content last changed at this session time.
    pub fn changed_at(&self, time: SessionTime) -> impl Iterator<Item = LocationId> + '_ {
        let times = self.changed_at[..self.kitchen.locations.len()].iter().enumerate();
        times.filter(move |(_, at)| **at == time).map(|(index, _)| LocationId(index as u8))
    }

    pub fn highlights(&self) -> HighlightSet {
        self.spec.highlights(&self.kitchen)
    }

    /// Before its first event.
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
            external: ExternalStatus::default(),
            has_console: false,
            cue: None,
            signalled_at: None,
            unblinded: false,
            aborted: None,
            excluded: None,
            gaze: GazeStatus::default(),
            tracker: TrackerStatus::default(),
            button_box: ButtonBoxStatus::default(),
            calibration: None,
            calibrated: None,
            timeline: Vec::new(),
            order_work: OrderWork::default(),
            probes: TrialProbes::default(),
            protocol,
            ended_early: false,
            open_marks: Vec::new(),
        }
    }

    /// Time since the trial's start without pauses; zero before the start.
    pub fn trial_clock(&self, now: SessionTime) -> SessionTime {
        match self.phase {
            TrialPhase::Ready => SessionTime::ZERO,
            TrialPhase::Running => now - self.trial_start - self.paused_total,
            TrialPhase::Paused | TrialPhase::Over(_) | TrialPhase::Closed => {
                self.paused_at - self.trial_start - self.paused_total
            }
        }
    }

    /// The trial's clock as it stood at an earlier time.
    pub fn trial_clock_at(&self, at: SessionTime) -> SessionTime {
        let paused = self.pauses.iter().map(|&(from, until)| until.min(at) - from.min(at));
        paused.fold(at - self.trial_start, |clock, pause| clock - pause)
    }

    /// Time from `at` to `now` on the trial's clock: without pauses and without the time after the trial's end.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = match self.phase {
            TrialPhase::Ready | TrialPhase::Running => now,
            TrialPhase::Paused | TrialPhase::Over(_) | TrialPhase::Closed => now.min(self.paused_at),
        };
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// `None` if no sample came for a second.
    pub fn gaze_hz(&self, now: SessionTime) -> Option<f64> {
        let arrived = self.gaze.arrived.filter(|&arrived| now.secs_since(arrived) <= SILENT_S);
        arrived.map(|_| self.gaze.rate_hz)
    }

    /// Of estimates and recommendations, unique to the trial.
    pub fn seed(&self) -> u64 {
        of_trial(self.spec.seed, self.trial)
    }

    /// Whether the settings let the wizard (a person or a script) see recommendations.
    fn wizard_is_to_see_advice(&self) -> bool {
        let spec = &self.spec;
        match spec.wizard.kind {
            WizardKind::Scripted => spec.script_reads_offers(),
            WizardKind::Person => {
                spec.trial.condition == Condition::Wizard && spec.console.visibility == WizardVisibility::Recommendation
            }
        }
    }

    /// Whether the wizard (a person or a script) saw recommendations.
    pub fn wizard_saw_advice(&self) -> bool {
        let is_persons = self.spec.wizard.kind == WizardKind::Person;
        let was_unblinded = self.unblinded && is_persons && self.spec.trial.condition == Condition::Wizard;
        was_unblinded || self.wizard_is_to_see_advice()
    }

    /// As the trial was actually carried out: whether the wizard really saw advice.
    pub fn study_arm(&self) -> StudyArm {
        self.arm_of_settings(self.wizard_saw_advice())
    }

    /// Under which the trial counts, whatever happened in it: the arm that the plan assigned or, without a plan, that
    /// of the settings.
    pub fn planned_arm(&self) -> StudyArm {
        let assigned = self.spec.step.as_ref().and_then(|step| step.arm);
        assigned.unwrap_or_else(|| self.arm_of_settings(self.wizard_is_to_see_advice()))
    }

    fn arm_of_settings(&self, saw_advice: bool) -> StudyArm {
        StudyArm::from_settings(self.spec.trial.condition, self.spec.assistant.concept.name(), saw_advice)
    }

    /// The needs of all orders now.
    pub fn order_needs(&self) -> Vec<OrderNeeds> {
        self.order_work.clone().needs(&self.kitchen, self.state)
    }

    /// Of both agents in the trial.
    pub fn all_presses(&self) -> u32 {
        self.presses.iter().sum()
    }

    /// Whether it has a trial that ran to its end, also after the session's own end.
    pub fn is_trial_over(&self) -> bool {
        self.trial_end().is_some()
    }

    /// Why its trial ended, also after the session's own end; `None` for a trial that is not over.
    pub fn trial_end(&self) -> Option<TrialEndReason> {
        self.timeline.iter().find_map(|entry| match entry.what {
            TimelineEvent::Trial(TrialPhase::Over(reason)) => Some(reason),
            _ => None,
        })
    }

    /// Whether nothing happened that somebody would miss: no trial was begun, no note written, no eye tracker sent
    /// anything, no gaze check was accepted and, in a plan, nothing agreed to, ticked or answered.
    pub fn is_empty(&self) -> bool {
        let is_kept =
            |what: &TimelineEvent| matches!(what, TimelineEvent::Trial(_) | TimelineEvent::Noted(Event::Marker { .. }));
        let is_begun = self.protocol.as_ref().is_some_and(StudyProtocolState::is_begun);
        let has_tracker = !matches!(self.spec.participant.gaze, GazeSource::Mouse | GazeSource::Simulated);
        let is_fed = has_tracker && (self.gaze.samples > 0 || self.tracker.dropped.malformed > 0);
        !is_begun && !is_fed && self.calibrated.is_none() && !self.timeline.iter().any(|entry| is_kept(&entry.what))
    }

    /// Started, and neither paused nor over.
    pub fn is_running(&self) -> bool {
        self.phase == TrialPhase::Running
    }

    /// Whose press changed a location at this time.
    pub fn changed_by(&self, at: SessionTime) -> Option<Agent> {
        let since = self.timeline.iter().rev().take_while(|entry| entry.time >= at);
        since.filter(|entry| entry.time == at).find_map(|entry| match entry.what {
            TimelineEvent::Press { agent, no_effect: None, .. } => Some(agent),
            _ => None,
        })
    }

    /// Whether the location changed without a press of the human, and the participant has not looked there since: a
    /// fact, not an estimate.
    pub fn is_unseen(&self, location: LocationId) -> bool {
        let at = self.changed_at[location.index()];
        let seen = self.gaze.looked_at[location.index()].is_some_and(|seen| seen >= at);
        let knows = seen || self.gaze.samples == 0 || at == SessionTime::ZERO;
        !knows && self.changed_by(at) != Some(Agent::Human)
    }

    pub(crate) fn note(&mut self, time: SessionTime, what: TimelineEvent) {
        let entry = TimelineEntry { time, what };
        self.order_work.follow(&self.kitchen, std::slice::from_ref(&entry));
        self.timeline.push(entry);
    }

    pub(crate) fn note_event(&mut self, time: SessionTime, event: &Event) {
        self.note(time, TimelineEvent::Noted(event.clone()));
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialPhase {
    Ready,
    Running,
    Paused,
    Over(TrialEndReason),
    /// The session has ended.
    Closed,
}

#[derive(Clone, Debug, PartialEq)]
pub struct TimelineEntry {
    pub time: SessionTime,
    pub what: TimelineEvent,
}

/// What the console and the tables show of events.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "some hundred entries a trial, matched by the events in them")]
pub enum TimelineEvent {
    Press {
        agent: Agent,
        button: ButtonId,
        before: State,
        /// As `before` if the press had no effect.
        after: State,
        /// Why, and the location that the reason is about; `None` if the press had an effect.
        no_effect: Option<(NoEffectReason, LocationId)>,
    },
    Served {
        order: LocationId,
    },
    OrderShown {
        order: LocationId,
    },
    /// The press that the wizard skipped.
    RobotSkipped(ButtonId),
    Trial(TrialPhase),
    /// The event itself.
    Noted(Event),
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotStatus {
    /// The ongoing press: button, start, and expected time of contact.
    pub intention: Option<(ButtonId, SessionTime, SessionTime)>,
    /// Whether the ongoing or last press is of the robot's initiative.
    pub initiative: bool,
    /// Number of presses by its initiative while the trial ran.
    pub initiative_presses: u32,
    /// By the wizard or by itself, until the wizard resumes it.
    pub stopped: bool,
    /// By the wizard, before its next press.
    pub held: bool,
    /// The press that the wizard chose, until it is made or aborted.
    pub driven_to: Option<ButtonId>,
    /// Why the robot is idle, and the human's buttons for a press of one of which it waits.
    pub idle: Option<(IdleReason, Vec<ButtonId>)>,
    /// Why a press that was still useful was given up last.
    pub gave_up: Option<AbortReason>,
    pub arm: ArmStatus,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmStatus {
    /// `None` before the first motion and for the timed arm.
    pub last: Option<(SessionTime, ArmSample)>,
    pub mode: SafetyMode,
    /// Contact force that caused a protective stop, or the joint that did not follow its command.
    pub stopped_by_n: Option<f64>,
    pub stopped_by_joint: Option<u8>,
    /// Of a real arm: how far it is with being set up, and what was found.
    pub stage: Option<(ArmStage, String)>,
}

impl ArmStatus {
    /// In which stage beside `ready` a real arm is, and what was found; `None` if it is ready, or is no real one.
    pub fn unready(&self) -> Option<(ArmStage, &str)> {
        let (stage, found) = self.stage.as_ref()?;
        (*stage != ArmStage::Ready).then_some((*stage, found.as_str()))
    }
}

impl RobotStatus {
    /// Also possible after a protective stop.
    pub fn is_stopped_by_wizard(&self) -> bool {
        self.stopped && !self.arm.mode.has_stopped_itself() && self.arm.unready().is_none()
    }

    /// As screens name it: a stop by the wizard is an emergency stop also of the timed arm, which has no safety modes
    /// of its own.
    pub fn safety_mode(&self) -> SafetyMode {
        if self.is_stopped_by_wizard() { SafetyMode::EmergencyStop } else { self.arm.mode }
    }

    pub(crate) fn sets_out(&mut self, button: ButtonId, now: SessionTime, until: SessionTime, initiative: bool) {
        self.intention = Some((button, now, until));
        self.initiative = initiative;
        self.idle = None;
    }

    pub(crate) fn gives_up(&mut self, reason: AbortReason) {
        self.intention = None;
        if !matches!(reason, AbortReason::NoLongerUseful | AbortReason::Stopped | AbortReason::Driven) {
            self.gave_up = Some(reason);
        }
        // If the wizard chose another press for the robot, that press is still pending.
        self.driven_to = self.driven_to.filter(|_| reason == AbortReason::Driven);
    }

    pub(crate) fn rests(&mut self) {
        self.intention = None;
        self.driven_to = None;
        self.idle = None;
        self.gave_up = None;
    }
}
