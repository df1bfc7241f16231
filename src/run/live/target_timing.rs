//! Timing of the targets in a gaze accuracy check.

use super::live_session::Live;
use tomcom_core::base::time::SessionTime;
use tomcom_session::Event;
use tomcom_session::gaze_check::{AcceptedGazeCheck, GazeCheckEvent, RunningGazeCheck};
use tomcom_session::settings::GazeSource;

impl Live {
    /// Uses the gaze accuracy check that was accepted in the previous recording again, since tracker and participant
    /// are the same (not for simulated participants, whose eyes are drawn anew).
    pub(super) fn carry_calibration(&mut self, before: Option<&AcceptedGazeCheck>) {
        let session = self.engine.session();
        let is_wanted = !matches!(session.spec.participant.gaze, GazeSource::None | GazeSource::Simulated);
        if let Some(AcceptedGazeCheck { found, corrected, .. }) =
            before.filter(|_| is_wanted && session.calibrated.is_none())
        {
            let event = GazeCheckEvent::Carried { found: found.clone(), corrected: *corrected };
            self.input(Event::Calibration(event));
        }
    }

    /// Session time at which the next target is due; `None` while no gaze accuracy check is running.
    pub(super) fn target_due(&self) -> Option<SessionTime> {
        self.engine.session().calibration.as_ref().and_then(RunningGazeCheck::next).map(|(time, _)| time)
    }

    /// Shows the next target of the gaze accuracy check, or hides the last target.
    pub(super) fn show_target(&mut self) {
        if let Some((_, event)) = self.engine.session().calibration.as_ref().and_then(RunningGazeCheck::next) {
            self.input(Event::Calibration(event));
        }
    }
}
