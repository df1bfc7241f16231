//! The gaze accuracy check of an eye tracker: its events, its running state, and its accepted result.

use serde::{Deserialize, Serialize};

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::calibration::{GazeAccuracy, SETTLE_S, TARGET_S, TARGETS, ViewingGeometry, measure};
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};

/// Largest number of gaze samples kept per target of the accuracy check: 1,000 Hz for longer than a target is shown.
const MOST_SAMPLES: usize = 4096;
/// Time from the beginning of the accuracy check to the first target, in seconds.
const READY_S: f64 = 1.0;

/// A step of a gaze accuracy check.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum GazeCheckEvent {
    /// The accuracy check begins or restarts, with its targets in fractions of the display.
    Begun {
        /// Positions of the targets in the order in which they are shown, in fractions of the display.
        targets: Vec<[f64; 2]>,
    },
    /// The target with this index is shown.
    TargetShown {
        /// Index of the shown target in the list of targets.
        target: usize,
    },
    /// All targets of the accuracy check have been shown.
    TargetsHidden,
    /// The gaze accuracy was measured.
    Measured {
        /// The measured gaze accuracy; `None` if too few gaze samples were usable.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        found: Option<GazeAccuracy>,
    },
    /// The wizard accepts the measured gaze accuracy, with or without correction of the offset.
    Accepted {
        /// Whether the gaze is corrected by the measured offset from now on.
        corrected: bool,
    },
    /// The accepted result of the participant's previous recording is used again.
    Carried {
        /// The gaze accuracy that was measured and accepted in the previous recording.
        found: GazeAccuracy,
        /// Whether the gaze is corrected by the measured offset.
        corrected: bool,
    },
    /// The accuracy check is cancelled; the result of an earlier accepted check remains valid.
    Dismissed,
}

/// A running gaze accuracy check.
#[derive(Clone, Debug, PartialEq)]
pub struct RunningGazeCheck {
    /// Positions of the targets of the accuracy check, in fractions of the display.
    pub targets: Vec<[f64; 2]>,
    /// Index of the shown target of the accuracy check, with the session time at which the target appeared.
    pub shown: Option<(usize, SessionTime)>,
    /// Gaze samples taken while each target was shown, a list for each target.
    pub(super) samples: Vec<Vec<GazeSample>>,
    /// Session time of the last event of the accuracy check.
    pub(super) at: SessionTime,
    /// The result of the check, once all targets were shown.
    pub result: Option<GazeCheckResult>,
    pub(super) are_hidden: bool,
}

/// Result of a gaze accuracy check.
#[derive(Clone, Debug, PartialEq)]
pub struct GazeCheckResult {
    /// Measured gaze accuracy; `None` if too few samples were usable.
    pub found: Option<GazeAccuracy>,
}

/// An accepted gaze accuracy check.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceptedGazeCheck {
    /// Session time at which the wizard accepted the check.
    pub at: SessionTime,
    /// The measured gaze accuracy.
    pub found: GazeAccuracy,
    /// Whether gaze samples are corrected by the measured offset.
    pub corrected: bool,
}

impl AcceptedGazeCheck {
    /// Accuracy of the gaze as the session uses it since the check (corrected or not), in degrees.
    pub fn accuracy_deg(&self) -> f64 {
        if self.corrected { self.found.corrected_deg } else { self.found.accuracy_deg }
    }
}

impl RunningGazeCheck {
    /// Position of the target that is shown now, in fractions of the display.
    pub fn target(&self) -> Option<[f64; 2]> {
        self.shown.and_then(|(index, _)| self.targets.get(index).copied())
    }

    /// The next step of the accuracy check with the time at which it is due; `None` when all targets have been shown.
    pub fn next(&self) -> Option<(SessionTime, GazeCheckEvent)> {
        let (shown_s, target) = match self.shown {
            None if self.are_hidden => return None,
            None => (READY_S, 0),
            Some((target, _)) => (TARGET_S, target + 1),
        };
        let event = match target < self.targets.len() {
            true => GazeCheckEvent::TargetShown { target },
            false => GazeCheckEvent::TargetsHidden,
        };
        Some((self.at + SessionTime::from_secs_f64(shown_s), event))
    }

    /// The event that gives the measured gaze accuracy, once all targets have been shown.
    pub fn to_measure(&self, viewing: &ViewingGeometry) -> Option<GazeCheckEvent> {
        let is_due = self.are_hidden && self.result.is_none();
        is_due.then(|| GazeCheckEvent::Measured { found: measure(viewing, &self.targets, &self.samples) })
    }

    /// Adds a gaze sample taken at session time `taken` to those of the shown target.
    pub(super) fn take(&mut self, taken: SessionTime, sample: GazeSample) {
        let Some((target, since)) = self.shown else { return };
        let counts = taken.secs_since(since) >= SETTLE_S && sample.confidence >= MIN_CONFIDENCE;
        if let Some(samples) = self.samples.get_mut(target).filter(|kept| counts && kept.len() < MOST_SAMPLES) {
            samples.push(sample);
        }
    }
}

impl GazeCheckEvent {
    /// The event that begins an accuracy check with the standard targets.
    pub fn begin() -> GazeCheckEvent {
        GazeCheckEvent::Begun { targets: TARGETS.to_vec() }
    }

    /// Whether the event of the check comes from outside; the measurement does not, since it follows from earlier
    /// events.
    pub(super) fn is_external(&self) -> bool {
        !matches!(self, GazeCheckEvent::Measured { .. })
    }
}
