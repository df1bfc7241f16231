//! Rules of the gaze accuracy check in a session: targets are shown one after another on the display, and the measured
//! gaze is compared with the targets. A gaze accuracy check runs only while the trial does not.

pub use super::gaze_check::{AcceptedGazeCheck, GazeCheckEvent, GazeCheckResult, RunningGazeCheck};
use super::participant_settings::GazeSource;
use super::phase::TrialPhase;
use super::session_state::Session;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::calibration::{GazeAccuracy, ViewingGeometry};

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
pub(super) fn admit(session: &Session, event: &GazeCheckEvent) -> Result<(), &'static str> {
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
pub(super) fn apply(session: &mut Session, now: SessionTime, event: &GazeCheckEvent) {
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
pub(super) fn gaze(session: &mut Session, taken: SessionTime, sample: GazeSample) {
    if let Some(check) = &mut session.calibration {
        check.take(taken, sample);
    }
}
