//! The check of the calibration: targets one after another on the display, what the gaze did meanwhile, and whether that is
//! good enough. It is made while the trial does not run; the participant looks at targets, not at the kitchen.

use serde::{Deserialize, Serialize};

use super::settings::GazeSource;
use super::{Phase, Session};
use crate::base::time::SessionTime;
use crate::gaze::calibration::{GazeAccuracy, SETTLE_S, TARGET_S, TARGETS, ViewingGeometry, measure};
use crate::gaze::{GazeSample, MIN_CONFIDENCE};

/// No target keeps more samples: 1,000 a second for longer than it is shown.
const MOST_SAMPLES: usize = 4096;
/// From the beginning to the first target, in seconds.
const READY_S: f64 = 1.0;

/// A step of the check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum CalibrationEvent {
    /// A check begins, or begins again; the targets in fractions of the display.
    Begun { targets: Vec<[f64; 2]> },
    /// The target of this place in the list is shown, and no other.
    TargetShown { target: usize },
    /// The last one was shown long enough.
    TargetsHidden,
    /// What follows from the samples; nothing if too few were usable.
    Measured {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        found: Option<GazeAccuracy>,
    },
    /// The wizard takes the gaze as it is, or with the offset taken off from now on.
    Accepted { corrected: bool },
    /// What was accepted in the recording before, at the same desk, holds in this one, too.
    Carried { found: GazeAccuracy, corrected: bool },
    /// The check is given up; what was accepted before holds.
    Dismissed,
}

/// A check that goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct RunningGazeCheck {
    pub targets: Vec<[f64; 2]>,
    /// The target that is shown, and since when.
    pub shown: Option<(usize, SessionTime)>,
    /// By target.
    samples: Vec<Vec<GazeSample>>,
    /// When it began, and then when the last thing happened.
    at: SessionTime,
    pub result: Option<GazeCheckResult>,
    are_hidden: bool,
}

/// What a check came to.
#[derive(Clone, Debug, PartialEq)]
pub struct GazeCheckResult {
    /// Nothing: too few usable samples.
    pub found: Option<GazeAccuracy>,
}

/// A check that was accepted.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceptedGazeCheck {
    pub at: SessionTime,
    pub found: GazeAccuracy,
    /// The offset is taken off.
    pub corrected: bool,
}

impl AcceptedGazeCheck {
    /// How far gaze is off, in degrees, as it is used from then on.
    pub fn accuracy_deg(&self) -> f64 {
        if self.corrected { self.found.corrected_deg } else { self.found.accuracy_deg }
    }
}

impl RunningGazeCheck {
    /// The display point of the shown target, in fractions.
    pub fn target(&self) -> Option<[f64; 2]> {
        self.shown.and_then(|(index, _)| self.targets.get(index).copied())
    }

    /// What has to happen next, and when; nothing when everything was shown.
    pub fn next(&self) -> Option<(SessionTime, CalibrationEvent)> {
        let (shown_s, target) = match self.shown {
            None if self.are_hidden => return None,
            None => (READY_S, 0),
            Some((target, _)) => (TARGET_S, target + 1),
        };
        let event = match target < self.targets.len() {
            true => CalibrationEvent::TargetShown { target },
            false => CalibrationEvent::TargetsHidden,
        };
        Some((self.at + SessionTime::from_secs_f64(shown_s), event))
    }

    /// What follows from the samples when all targets were shown and nothing was measured yet.
    pub fn to_measure(&self, viewing: &ViewingGeometry) -> Option<CalibrationEvent> {
        let is_due = self.are_hidden && self.result.is_none();
        is_due.then(|| CalibrationEvent::Measured { found: measure(viewing, &self.targets, &self.samples) })
    }

    /// Takes a sample that was taken then.
    fn take(&mut self, taken: SessionTime, sample: GazeSample) {
        let Some((target, since)) = self.shown else { return };
        let counts = taken.secs_since(since) >= SETTLE_S && sample.confidence >= MIN_CONFIDENCE;
        if let Some(samples) = self.samples.get_mut(target).filter(|kept| counts && kept.len() < MOST_SAMPLES) {
            samples.push(sample);
        }
    }
}

impl CalibrationEvent {
    /// The beginning of a check with the usual targets.
    pub fn begin() -> CalibrationEvent {
        CalibrationEvent::Begun { targets: TARGETS.to_vec() }
    }

    /// Whether it comes from outside; what is measured follows from the rest.
    pub(super) fn is_external(&self) -> bool {
        !matches!(self, CalibrationEvent::Measured { .. })
    }
}

impl Session {
    /// Where the participant sits.
    pub fn viewing(&self) -> ViewingGeometry {
        ViewingGeometry { display_m: self.kitchen.display_m, distance_m: self.spec.tracker.distance_m }
    }

    /// Gaze as it is used: with the accepted offset taken off.
    pub fn corrected(&self, sample: GazeSample) -> GazeSample {
        match self.calibrated.as_ref().filter(|calibrated| calibrated.corrected) {
            Some(AcceptedGazeCheck { found: GazeAccuracy { offset, .. }, .. }) => {
                GazeSample { x: sample.x + offset[0], y: sample.y + offset[1], ..sample }
            }
            None => sample,
        }
    }

    /// Whether targets are to be looked at now: the trial has to wait.
    pub fn is_calibrating(&self) -> bool {
        self.calibration.as_ref().is_some_and(|check| check.result.is_none())
    }
}

/// Whether the session takes the event now.
///
/// # Errors
/// The reason why it does not, in words for the wizard.
pub(super) fn admit(session: &Session, event: &CalibrationEvent) -> Result<(), &'static str> {
    let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
    let check = session.calibration.as_ref();
    match event {
        CalibrationEvent::Begun { targets } => {
            unless(session.spec.participant.gaze != GazeSource::None, "there is no gaze in this session")?;
            unless(session.phase != Phase::Running, "pause the trial first: the targets hide the kitchen")?;
            let are_places = targets.iter().flatten().all(|value| (0.0..=1.0).contains(value));
            unless(!targets.is_empty() && targets.len() <= 64 && are_places, "the targets are not on the display")
        }
        CalibrationEvent::TargetShown { target } => {
            let open = check.filter(|check| !check.are_hidden);
            unless(open.is_some_and(|check| *target < check.targets.len()), "there is no such target to be shown")
        }
        CalibrationEvent::TargetsHidden => {
            unless(check.is_some_and(|check| check.shown.is_some()), "no target is shown")
        }
        CalibrationEvent::Measured { .. } => {
            unless(check.is_some_and(|check| check.are_hidden && check.result.is_none()), "there is nothing to measure")
        }
        CalibrationEvent::Accepted { .. } => {
            let found = check.and_then(|check| check.result.as_ref()?.found.as_ref());
            unless(found.is_some(), "nothing was measured that could be accepted")
        }
        CalibrationEvent::Carried { .. } => {
            unless(session.spec.participant.gaze != GazeSource::None, "there is no gaze in this session")?;
            unless(session.phase == Phase::Ready, "the trial has begun")
        }
        CalibrationEvent::Dismissed => unless(check.is_some(), "the calibration is not being checked"),
    }
}

/// Moves on by an event that was admitted.
pub(super) fn apply(session: &mut Session, now: SessionTime, event: &CalibrationEvent) {
    match event {
        CalibrationEvent::Begun { targets } => {
            let samples = vec![Vec::new(); targets.len()];
            let targets = targets.clone();
            session.calibration =
                Some(RunningGazeCheck { targets, shown: None, samples, at: now, result: None, are_hidden: false });
            return;
        }
        CalibrationEvent::Dismissed => {
            session.calibration = None;
            return;
        }
        CalibrationEvent::Accepted { corrected } => {
            let outcome = session.calibration.take().and_then(|check| check.result);
            if let Some(found) = outcome.and_then(|outcome| outcome.found) {
                session.calibrated = Some(AcceptedGazeCheck { at: now, found, corrected: *corrected });
            }
            return;
        }
        CalibrationEvent::Carried { found, corrected } => {
            session.calibrated = Some(AcceptedGazeCheck { at: now, found: found.clone(), corrected: *corrected });
            return;
        }
        _ => {}
    }
    let Some(check) = &mut session.calibration else { return };
    check.at = now;
    match event {
        CalibrationEvent::TargetShown { target } => check.shown = Some((*target, now)),
        CalibrationEvent::TargetsHidden => (check.shown, check.are_hidden) = (None, true),
        CalibrationEvent::Measured { found } => check.result = Some(GazeCheckResult { found: found.clone() }),
        _ => {}
    }
}

/// Takes a sample, as it came.
pub(super) fn gaze(session: &mut Session, taken: SessionTime, sample: GazeSample) {
    if let Some(check) = &mut session.calibration {
        check.take(taken, sample);
    }
}
