//! A check of the calibration: its events, and what a running and an accepted one are.

use serde::{Deserialize, Serialize};

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
    pub(super) samples: Vec<Vec<GazeSample>>,
    /// When it began, and then when the last thing happened.
    pub(super) at: SessionTime,
    pub result: Option<GazeCheckResult>,
    pub(super) are_hidden: bool,
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
    pub(super) fn take(&mut self, taken: SessionTime, sample: GazeSample) {
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
