//! The gaze accuracy check of an eye tracker: targets are shown one after another on the display, and the measured
//! gaze is compared with them. It runs only while the trial does not.

use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::settings::GazeSource;
use crate::{Session, TrialPhase};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::calibration::{
    GazeAccuracy, SETTLE_S, TARGET_S, TARGETS, ViewingGeometry, measure, mistaken_coordinates,
};
use tomcom_core::gaze::{GazeSample, MIN_CONFIDENCE};

/// Per target: 1,000 Hz for longer than a target is shown.
const MOST_SAMPLES: usize = 4096;
/// From the beginning of the check to the first target.
const READY_S: f64 = 1.0;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum GazeCheckEvent {
    /// Begins or restarts, with targets in fractions of the display, in the order in which they are shown.
    Begun { targets: Vec<[f64; 2]> },
    /// By its index.
    TargetShown { target: usize },
    /// After the last one.
    TargetsHidden,
    /// From the samples of all targets.
    Measured {
        /// `None` if too few gaze samples were usable.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        found: Option<GazeAccuracy>,
    },
    /// The wizard takes the result.
    Accepted {
        /// Whether gaze is corrected by the measured offset from now on.
        corrected: bool,
    },
    /// The accepted result of the participant's previous recording is used again.
    Carried { found: GazeAccuracy, corrected: bool },
    /// The result of an earlier accepted check remains valid.
    Dismissed,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RunningGazeCheck {
    /// In fractions of the display.
    pub targets: Vec<[f64; 2]>,
    /// Index, and session time at which it appeared.
    pub shown: Option<(usize, SessionTime)>,
    /// A list for each target.
    pub(crate) samples: Vec<Vec<GazeSample>>,
    /// Time of the last event of the check.
    pub(crate) at: SessionTime,
    /// Once all targets were shown.
    pub result: Option<GazeCheckResult>,
    pub(crate) are_hidden: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct GazeCheckResult {
    /// `None` if too few samples were usable.
    pub found: Option<GazeAccuracy>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct AcceptedGazeCheck {
    pub at: SessionTime,
    pub found: GazeAccuracy,
    /// Whether gaze samples are corrected by the measured offset.
    pub corrected: bool,
}

impl AcceptedGazeCheck {
    /// Of the gaze as the session uses it, corrected or not.
    pub fn accuracy_deg(&self) -> f64 {
        if self.corrected { self.found.corrected_deg } else { self.found.accuracy_deg }
    }
}

impl RunningGazeCheck {
    /// In fractions of the display.
    pub fn target(&self) -> Option<[f64; 2]> {
        self.shown.and_then(|(index, _)| self.targets.get(index).copied())
    }

    /// The next step and when it is due; `None` when all targets have been shown.
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

    /// Once all targets have been shown.
    pub(crate) fn to_measure(&self, viewing: &ViewingGeometry) -> Option<GazeCheckEvent> {
        let is_due = self.are_hidden && self.result.is_none();
        is_due.then(|| GazeCheckEvent::Measured { found: measure(viewing, &self.targets, &self.samples) })
    }

    /// How the sender of gaze seems to mean its coordinates, in words, if the gaze is on the targets only when it is read
    /// so.
    pub fn mistaken_coordinates(&self, viewing: &ViewingGeometry) -> Option<&'static str> {
        mistaken_coordinates(viewing, &self.targets, &self.samples)
    }

    /// An uncorrected sample.
    pub(crate) fn take(&mut self, taken: SessionTime, sample: GazeSample) {
        let Some((target, since)) = self.shown else { return };
        let counts = taken.secs_since(since) >= SETTLE_S && sample.confidence >= MIN_CONFIDENCE;
        if let Some(samples) = self.samples.get_mut(target).filter(|kept| counts && kept.len() < MOST_SAMPLES) {
            samples.push(sample);
        }
    }
}

impl GazeCheckEvent {
    /// With the standard targets.
    pub fn begin() -> GazeCheckEvent {
        GazeCheckEvent::Begun { targets: TARGETS.to_vec() }
    }

    /// The measurement follows from earlier events; the others come from outside.
    pub(crate) fn is_external(&self) -> bool {
        !matches!(self, GazeCheckEvent::Measured { .. })
    }
}

impl Session {
    pub fn viewing(&self) -> ViewingGeometry {
        ViewingGeometry { display_m: self.kitchen.display_m, distance_m: self.spec.tracker.distance_m }
    }

    /// By the offset of the accepted check, if the wizard accepted it with correction.
    pub fn corrected(&self, sample: GazeSample) -> GazeSample {
        match self.calibrated.as_ref().filter(|calibrated| calibrated.corrected) {
            Some(AcceptedGazeCheck { found: GazeAccuracy { offset, .. }, .. }) => {
                GazeSample { x: sample.x + offset[0], y: sample.y + offset[1], ..sample }
            }
            None => sample,
        }
    }

    /// Whether a check is running, which blocks the trial.
    pub fn is_calibrating(&self) -> bool {
        self.calibration.as_ref().is_some_and(|check| check.result.is_none())
    }
}

pub(crate) fn admit(session: &Session, event: &GazeCheckEvent) -> Result<(), &'static str> {
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
                "there is no gaze target with this number to be shown",
            )
        }
        GazeCheckEvent::TargetsHidden => {
            unless(check.is_some_and(|check| check.shown.is_some()), "no gaze target is shown")
        }
        GazeCheckEvent::Measured { .. } => unless(
            check.is_some_and(|check| check.are_hidden && check.result.is_none()),
            "no gaze target was shown, so nothing can be measured",
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

pub(crate) fn apply(session: &mut Session, now: SessionTime, event: &GazeCheckEvent) {
    match (event, &mut session.calibration) {
        (GazeCheckEvent::Begun { targets }, check) => {
            let samples = vec![Vec::new(); targets.len()];
            let targets = targets.clone();
            *check = Some(RunningGazeCheck { targets, shown: None, samples, at: now, result: None, are_hidden: false });
        }
        (GazeCheckEvent::Dismissed, check) => *check = None,
        (GazeCheckEvent::Accepted { corrected }, check) => {
            if let Some(found) = check.take().and_then(|check| check.result?.found) {
                session.calibrated = Some(AcceptedGazeCheck { at: now, found, corrected: *corrected });
            }
        }
        (GazeCheckEvent::Carried { found, corrected }, _) => {
            session.calibrated = Some(AcceptedGazeCheck { at: now, found: found.clone(), corrected: *corrected });
        }
        (GazeCheckEvent::TargetShown { target }, Some(check)) => {
            (check.at, check.shown) = (now, Some((*target, now)));
        }
        (GazeCheckEvent::TargetsHidden, Some(check)) => {
            (check.at, check.shown, check.are_hidden) = (now, None, true);
        }
        (GazeCheckEvent::Measured { found }, Some(check)) => {
            (check.at, check.result) = (now, Some(GazeCheckResult { found: found.clone() }));
        }
        // Such an event is not admitted without a check.
        (_, None) => {}
    }
}
