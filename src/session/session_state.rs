//! The state of a session: what follows from its events so far.

use std::sync::Arc;

use super::gaze_check::{AcceptedGazeCheck, RunningGazeCheck};
use super::gaze_status::GazeStatus;
use super::phase::Phase;
use super::protocol_state::Protocol;
use super::robot_status::RobotStatus;
use super::settings::SessionSpec;
use super::timeline_entry::{TimelineEntry, TimelineEvent};
use super::tracker::TrackerStatus;
use crate::base::rng::of_trial;
use crate::base::time::SessionTime;
use crate::communication::recommendation::Recommendation;
use crate::communication::{Sender, Signal};
use crate::kitchen::state::MAX_LOCATIONS;
use crate::kitchen::{DishId, Kitchen, LocationId, State};

/// After so many seconds without a sample there is no gaze.
const SILENT_S: f64 = 1.0;

/// Everything that follows from the events so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    pub kitchen: Arc<Kitchen>,
    pub spec: SessionSpec,
    /// Which trial of its seed it is.
    pub trial: u64,
    /// The time of the last event.
    pub time: SessionTime,
    pub phase: Phase,
    /// When the trial's clock started, and how long it stood still since.
    pub trial_start: SessionTime,
    pub paused_total: SessionTime,
    pub paused_at: SessionTime,
    /// The pauses that are over: from, until.
    pub pauses: Vec<(SessionTime, SessionTime)>,
    /// The task state, as it truly is.
    pub state: State,
    /// When each location last changed, indexed by location.
    pub changed_at: [SessionTime; MAX_LOCATIONS],
    /// Presses during the trial, indexed by [`crate::kitchen::Agent::index`].
    pub presses: [u32; 2],
    /// Served orders: when, and the number of presses of both agents until then.
    pub served: Vec<Served>,
    pub robot: RobotStatus,
    /// The signal that the participant sees now.
    pub shown: Option<ShownSignal>,
    /// The newest advice of the assistant in the running trial.
    pub advice: Option<Recommendation>,
    /// The number of the newest event that the display marks with a flash: a start, a signal.
    pub cue: Option<u64>,
    /// When the wizard last sent a signal.
    pub signalled_at: Option<SessionTime>,
    /// The wizard saw what assistants would say, beside what was sent.
    pub unblinded: bool,
    /// Why the trial was aborted, if it was.
    pub aborted: Option<String>,
    /// Why the trial is to be left out of the analysis, if it is.
    pub excluded: Option<String>,
    pub gaze: GazeStatus,
    /// What is known of the eye tracker.
    pub tracker: TrackerStatus,
    /// The check of the calibration that goes on, or waits for the wizard's verdict.
    pub calibration: Option<RunningGazeCheck>,
    /// The check that was accepted last.
    pub calibrated: Option<AcceptedGazeCheck>,
    /// What happened, without the gaze: the timeline of the console.
    pub timeline: Vec<TimelineEntry>,
    /// Where it is in its plan, if it belongs to one.
    pub protocol: Option<Protocol>,
}

/// A served order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Served {
    pub time: SessionTime,
    pub dish: DishId,
    /// Presses of both agents in the trial when it was served, its own included.
    pub presses: u32,
}

/// A signal on the display.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownSignal {
    pub signal: Signal,
    /// The location that the signal is about.
    pub location: LocationId,
    pub by: Sender,
    pub since: SessionTime,
    pub until: SessionTime,
}

impl Session {
    /// The locations that changed last at this time.
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

    /// How long ago `at` is in the trial's time at `now`: pauses do not count, and after the end it stands still.
    pub fn age(&self, at: SessionTime, now: SessionTime) -> SessionTime {
        let end = match self.phase {
            Phase::Ready | Phase::Running => now,
            Phase::Paused | Phase::Over(_) | Phase::Closed => self.paused_at,
        };
        let paused = self.pauses.iter().map(|&(from, until)| until.min(end) - from.max(at));
        paused.fold(end - at, |age, pause| age - pause)
    }

    /// The location that the gaze is on, by a sample that came at `now`.
    pub fn looked_at(&self, now: SessionTime) -> Option<LocationId> {
        let places = self.kitchen.locations.len();
        let at = self.gaze.looked_at[..places].iter().position(|at| *at == Some(now));
        at.map(|index| LocationId(index as u8))
    }

    /// Gaze samples a second at `now`; nothing if none came for a second.
    pub fn gaze_hz(&self, now: SessionTime) -> Option<f64> {
        let arrived = self.gaze.arrived.filter(|&arrived| now.secs_since(arrived) <= SILENT_S);
        arrived.map(|_| self.gaze.rate_hz)
    }

    /// The seed of estimates and advice, which no two trials share.
    pub fn seed(&self) -> u64 {
        of_trial(self.spec.seed, self.trial)
    }

    /// Presses of both agents during the trial.
    pub fn all_presses(&self) -> u32 {
        self.presses.iter().sum()
    }

    /// Whether presses count now.
    pub fn is_running(&self) -> bool {
        self.phase == Phase::Running
    }

    /// Writes an entry of the timeline.
    pub(super) fn note(&mut self, time: SessionTime, what: TimelineEvent) {
        self.timeline.push(TimelineEntry { time, what });
    }
}
