//! The state of a session, computed from its events.

use std::sync::Arc;

use super::gaze_check::{AcceptedGazeCheck, RunningGazeCheck};
use super::gaze_status::GazeStatus;
use super::phase::Phase;
use super::probe_state::ProbeBook;
use super::protocol_state::Protocol;
use super::robot_status::RobotStatus;
use super::settings::{Condition, SessionSpec, Visibility};
use super::study_arm::StudyArm;
use super::timeline_entry::{TimelineEntry, TimelineEvent};
use super::tracker::TrackerStatus;
use crate::base::rng::of_trial;
use crate::base::time::SessionTime;
use crate::communication::offer::OfferBook;
use crate::communication::recommendation::Recommendation;
use crate::communication::{Sender, Signal};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{DishId, Kitchen, LocationId, State};
use crate::wizard::settings::WizardKind;

/// Time without a sample after which there is no gaze, in seconds.
const SILENT_S: f64 = 1.0;

/// The state of a session after the events so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The compiled kitchen.
    pub kitchen: Arc<Kitchen>,
    /// The settings, as they are in force.
    pub spec: SessionSpec,
    /// Index of the trial.
    pub trial: u64,
    /// The time of the last event.
    pub time: SessionTime,
    /// Where the trial is.
    pub phase: Phase,
    /// Session time of the trial's start.
    pub trial_start: SessionTime,
    /// How long the trial's clock stood still, in all pauses that are over.
    pub paused_total: SessionTime,
    /// When the trial's clock last came to a stand: at the beginning of a pause, or at the trial's end.
    pub paused_at: SessionTime,
    /// Start and end of each finished pause.
    pub pauses: Vec<(SessionTime, SessionTime)>,
    /// True state of the kitchen.
    pub state: State,
    /// Time of the last change of each location.
    pub changed_at: [SessionTime; MAX_LOCATIONS],
    /// Presses during the trial, indexed by [`crate::kitchen::Agent::index`].
    pub presses: [u32; 2],
    /// Served orders.
    pub served: Vec<Served>,
    /// What is known of the robot.
    pub robot: RobotStatus,
    /// The signal on the display, if there is one.
    pub shown: Option<ShownSignal>,
    /// Latest recommendation of the assistant in the running trial.
    pub advice: Option<Recommendation>,
    /// Whether recommendations become offers: not in recordings of format 1.
    pub makes_offers: bool,
    /// The offer to the wizard, and the last one.
    pub offers: OfferBook,
    /// Whether a console shows the session to a wizard.
    pub has_console: bool,
    /// Sequence number of the latest event that the display marks with a flash (trial start, signal).
    pub cue: Option<u64>,
    /// Time of the wizard's last signal.
    pub signalled_at: Option<SessionTime>,
    /// Whether the wizard saw the comparison with the assistants.
    pub unblinded: bool,
    /// Reason for aborting the trial, if it was aborted.
    pub aborted: Option<String>,
    /// Reason for excluding the trial from the analysis, if it is excluded.
    pub excluded: Option<String>,
    /// The participant's gaze.
    pub gaze: GazeStatus,
    /// State of the eye tracker.
    pub tracker: TrackerStatus,
    /// Running gaze accuracy check, or one that waits for the wizard's decision.
    pub calibration: Option<RunningGazeCheck>,
    /// Last accepted gaze accuracy check.
    pub calibrated: Option<AcceptedGazeCheck>,
    /// All entries of the timeline (events without gaze samples).
    pub timeline: Vec<TimelineEntry>,
    /// The freeze probes of the trial.
    pub probes: ProbeBook,
    /// Progress within the recording's phases, if it belongs to a plan.
    pub protocol: Option<Protocol>,
}

/// A served order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Served {
    /// Session time of serving.
    pub time: SessionTime,
    /// The dish that was wanted.
    pub dish: DishId,
    /// Number of presses of both agents in the trial, including the serving press.
    pub presses: u32,
}

/// A signal on the display.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownSignal {
    /// The signal.
    pub signal: Signal,
    /// The location that the signal is about; `None` for proposed presses.
    pub location: Option<LocationId>,
    /// Who sent it.
    pub by: Sender,
    /// When it appeared, in session time.
    pub since: SessionTime,
    /// When it vanishes by itself, in session time.
    pub until: SessionTime,
}

impl Session {
    /// Locations whose last change was at this time.
    pub fn changed_at(&self, time: SessionTime) -> impl Iterator<Item = LocationId> + '_ {
        let times = self.changed_at[..self.kitchen.locations.len()].iter().enumerate();
        times.filter(move |(_, at)| **at == time).map(|(index, _)| LocationId(index as u8))
    }

    /// A session before its first event.
    pub fn new(kitchen: Arc<Kitchen>, spec: SessionSpec, trial: u64) -> Session {
        let state = kitchen.empty_state();
        let protocol = spec.step.as_ref().map(|_| Protocol::default());
        Session {
            kitchen,
            spec,
            trial,
            time: SessionTime::ZERO,
            phase: Phase::Ready,
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
            makes_offers: true,
            offers: OfferBook::default(),
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
            probes: ProbeBook::default(),
            protocol,
        }
    }

    /// The trial's clock at `now`: time since its start without the pauses; zero before the start.
    pub fn trial_clock(&self, now: SessionTime) -> SessionTime {
        match self.phase {
            Phase::Ready => SessionTime::ZERO,
            Phase::Running => now - self.trial_start - self.paused_total,
            Phase::Paused => self.paused_at - self.trial_start - self.paused_total,
            Phase::Over(_) | Phase::Closed => self.paused_at - self.trial_start - self.paused_total,
        }
    }

    /// Time from `at` to `now` on the trial's clock, without pauses and without the time after the trial's end.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = match self.phase {
            Phase::Ready | Phase::Running => now,
            Phase::Paused | Phase::Over(_) | Phase::Closed => self.paused_at,
        };
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// The location at which the participant looks, by the latest sample before `now`.
    pub fn looked_at(&self, now: SessionTime) -> Option<LocationId> {
        let places = self.kitchen.locations.len();
        let at = self.gaze.looked_at[..places].iter().position(|at| *at == Some(now));
        at.map(|index| LocationId(index as u8))
    }

    /// Sampling rate of the gaze in Hz; `None` if no sample came for a second.
    pub fn gaze_hz(&self, now: SessionTime) -> Option<f64> {
        let arrived = self.gaze.arrived.filter(|&arrived| now.secs_since(arrived) <= SILENT_S);
        arrived.map(|_| self.gaze.rate_hz)
    }

    /// Seed of estimates and recommendations, unique to the trial.
    pub fn seed(&self) -> u64 {
        of_trial(self.spec.seed, self.trial)
    }

    /// Whether the wizard, a person or a script, saw the assistant's recommendations.
    pub fn wizard_saw_advice(&self) -> bool {
        let spec = &self.spec;
        match spec.wizard.kind {
            WizardKind::Scripted => spec.script_reads_offers(),
            WizardKind::Person => {
                let is_shown = self.unblinded || spec.console.visibility == Visibility::Recommendation;
                spec.trial.condition == Condition::Wizard && is_shown
            }
        }
    }

    /// The arm of the trial, by what is done in it.
    pub fn study_arm(&self) -> StudyArm {
        StudyArm::from_settings(self.spec.trial.condition, self.spec.assistant.concept, self.wizard_saw_advice())
    }

    /// Presses of both agents during the trial.
    pub fn all_presses(&self) -> u32 {
        self.presses.iter().sum()
    }

    /// Whether the trial is running.
    pub fn is_running(&self) -> bool {
        self.phase == Phase::Running
    }

    /// Adds an entry to the timeline.
    pub(super) fn note(&mut self, time: SessionTime, what: TimelineEvent) {
        self.timeline.push(TimelineEntry { time, what });
    }
}
