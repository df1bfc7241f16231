//! The gaze accuracy check of an eye tracker: its events, its running state, and its accepted result.

use serde::{Deserialize, Serialize};

use crate::settings::GazeSource;
use crate::{Session, TrialPhase};
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
    pub(crate) samples: Vec<Vec<GazeSample>>,
    /// Session time of the last event of the accuracy check.
    pub(crate) at: SessionTime,
    /// The result of the check, once all targets were shown.
    pub result: Option<GazeCheckResult>,
    pub(crate) are_hidden: bool,
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
    pub(crate) fn take(&mut self, taken: SessionTime, sample: GazeSample) {
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
    pub(crate) fn is_external(&self) -> bool {
        !matches!(self, GazeCheckEvent::Measured { .. })
    }
}

impl Session {
    /// Size of the wall display, and distance of the participant's eyes from the wall display.
    pub fn viewing(&self) -> ViewingGeometry {
        ViewingGeometry { display_m: self.kitchen.display_m, distance_m: self.spec.tracker.distance_m }
    }

    /// The gaze sample, corrected by the measured offset of the accepted accuracy check (unchanged if none is
    /// corrected).
    pub fn corrected(&self, sample: GazeSample) -> GazeSample {
        match self.calibrated.as_ref().filter(|calibrated| calibrated.corrected) {
            Some(AcceptedGazeCheck { found: GazeAccuracy { offset, .. }, .. }) => {
                GazeSample { x: sample.x + offset[0], y: sample.y + offset[1], ..sample }
            }
            None => sample,
        }
    }

    /// Whether a gaze accuracy check is running, which blocks the trial.
    pub fn is_calibrating(&self) -> bool {
        self.calibration.as_ref().is_some_and(|check| check.result.is_none())
    }
}

/// Whether the session accepts this event of an accuracy check now.
///
/// # Errors
/// Why the session refuses the event, in words for the wizard.
pub(crate) fn admit(session: &Session, event: &GazeCheckEvent) -> Result<(), &'static str> {
    let unless = |holds: bool, reason: &'static str| if holds { Ok(()) } else { Err(reason) };
    let check = session.calibration.as_ref();
    match event {
        GazeCheckEvent::Begun { targets } => {
            unless(session.spec.participant.gaze != GazeSource::None, "there is no gaze in this session")?;
            unless(session.phase != TrialPhase::Running, "pause the trial first: the targets hide the kitchen")?;
            unless(!session.is_frozen(), "a freeze probe is running: check the gaze after the probe")?;
            let are_places = targets.iter().flatten().all(|value| (0.0..=1.0).contains(value));
            unless(!targets.is_empty() && targets.len() <= 64 && are_places, "the gaze targets are not on the display")
        }
        GazeCheckEvent::TargetShown { target } => {
            let open = check.filter(|check| !check.are_hidden);
            unless(
                open.is_some_and(|check| *target < check.targets.len()),
                "there is no gaze target with this number \
                                                                             to be shown",
            )
        }
        GazeCheckEvent::TargetsHidden => unless(
            check.is_some_and(|check| check.shown.is_some()),
            "no gaze target is \
                                                                                                   shown",
        ),
        GazeCheckEvent::Measured { .. } => unless(
            check.is_some_and(|check| check.are_hidden && check.result.is_none()),
            "no gaze target was shown, \
                                                                                           so nothing can be measured",
        ),
        GazeCheckEvent::Accepted { .. } => {
            let found = check.and_then(|check| check.result.as_ref()?.found.as_ref());
            unless(found.is_some(), "no gaze accuracy was measured that could be accepted")
        }
        GazeCheckEvent::Carried { .. } => {
            unless(session.spec.participant.gaze != GazeSource::None, "there is no gaze in this session")?;
            unless(session.phase == TrialPhase::Ready, "the trial has begun")
        }
        GazeCheckEvent::Dismissed => unless(check.is_some(), "no gaze accuracy check is running"),
    }
}

/// Applies an event of an accuracy check that the session accepts.
pub(crate) fn apply(session: &mut Session, now: SessionTime, event: &GazeCheckEvent) {
    match event {
        GazeCheckEvent::Begun { targets } => {
            let samples = vec![Vec::new(); targets.len()];
            let targets = targets.clone();
            session.calibration =
                Some(RunningGazeCheck { targets, shown: None, samples, at: now, result: None, are_hidden: false });
            return;
        }
        GazeCheckEvent::Dismissed => {
            session.calibration = None;
            return;
        }
        GazeCheckEvent::Accepted { corrected } => {
            let outcome = session.calibration.take().and_then(|check| check.result);
            if let Some(found) = outcome.and_then(|outcome| outcome.found) {
                session.calibrated = Some(AcceptedGazeCheck { at: now, found, corrected: *corrected });
            }
            return;
        }
        GazeCheckEvent::Carried { found, corrected } => {
            session.calibrated = Some(AcceptedGazeCheck { at: now, found: found.clone(), corrected: *corrected });
            return;
        }
        _ => {}
    }
    let Some(check) = &mut session.calibration else { return };
    check.at = now;
    match event {
        GazeCheckEvent::TargetShown { target } => check.shown = Some((*target, now)),
        GazeCheckEvent::TargetsHidden => (check.shown, check.are_hidden) = (None, true),
        GazeCheckEvent::Measured { found } => check.result = Some(GazeCheckResult { found: found.clone() }),
        _ => {}
    }
}

/// Adds an uncorrected gaze sample to a running accuracy check.
pub(crate) fn gaze(session: &mut Session, taken: SessionTime, sample: GazeSample) {
    if let Some(check) = &mut session.calibration {
        check.take(taken, sample);
    }
}
