//! The state of a session, computed from its events.

use std::sync::Arc;

use super::gaze_check::{AcceptedGazeCheck, RunningGazeCheck};
use super::gaze_status::GazeStatus;
use super::phase::TrialPhase;
use super::probe_state::TrialProbes;
use super::protocol_state::StudyProtocolState;
use super::robot_status::RobotStatus;
use super::settings::{Condition, SessionSpec, WizardVisibility};
use super::study_arm::StudyArm;
use super::timeline_entry::{TimelineEntry, TimelineEvent};
use super::tracker::TrackerStatus;
use tomcom_core::base::rng::of_trial;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::offer::OfferHistory;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{HighlightSet, Sender, Signal};
use tomcom_core::kitchen::state::MAX_LOCATIONS;
use tomcom_core::kitchen::{DishId, Kitchen, LocationId, State};
use tomcom_people::wizard::WizardKind;

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
    pub(super) fn note(&mut self, time: SessionTime, what: TimelineEvent) {
        self.timeline.push(TimelineEntry { time, what });
    }
}
