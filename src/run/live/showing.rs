//! Output of a live session: the wizard's screen with its record in the log, and the participant's display.

use super::live_session::Live;
use crate::console::panels::screen;
use crate::console::{interventions, mouse};
use crate::run::comparison_thread::ComparisonThreadHandle;
use tomcom_core::base::time::SessionTime;
use tomcom_session::gaze_check::{AcceptedGazeCheck, GazeCheckEvent, RunningGazeCheck};
use tomcom_session::settings::GazeSource;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Event, TrialPhase};

impl Live {
    /// Updates the time that the wizard's console shows.
    pub(super) fn tick(&mut self) {
        self.model.now = self.clock.now();
        self.model.clock = self.model.now;
    }

    /// Prepares the next frame and records what the wizard will see in it.
    pub(super) fn prepare_frame(&mut self) {
        self.tick();
        mouse::expire(&mut self.model, self.engine.session());
        interventions::expire(&mut self.model, self.engine.session());
        if let (Some(newest), Some(compared)) =
            (self.comparison.as_ref().and_then(ComparisonThreadHandle::newest), &mut self.model.comparison)
        {
            compared.show(newest);
        }
        self.tell_screen();
        self.dirty = false;
    }

    /// Records the content of the wizard's screen if it changed.
    fn tell_screen(&mut self) {
        let now = screen(self.engine.session(), &self.model);
        if self.engine.session().phase != TrialPhase::Closed && self.seen.as_ref() != Some(&now) {
            self.seen = Some(now.clone());
            self.input(Event::Screen(now));
        }
    }

    /// Records that the frame just drawn is the first one that shows a signal to the wizard.
    pub(super) fn tell_drawn(&mut self) {
        self.model.rings = false;
        if let Some(signal) = self.undrawn.take_if(|_| self.engine.session().phase != TrialPhase::Closed) {
            self.input(Event::SignalDrawn { signal });
        }
    }

    pub(super) fn build_display(&mut self) {
        if let Some(display) = &mut self.display {
            display.build(self.engine.session());
        }
        self.examine_display();
        // The participant's page can have been connected since before this recording.
        let page = self.model.display.as_ref().and_then(|display| display.page);
        if let Some([width_px, height_px]) = page {
            self.input(Event::Display(DisplayEvent::Connected { width_px, height_px }));
        }
        self.show_participant();
    }

    pub(super) fn show_participant(&mut self) {
        if let Some(display) = &mut self.display {
            display.show(self.engine.session(), self.clock.now());
        }
    }

    /// Moves the robot's hand on the participant's display.
    pub(super) fn move_robot(&mut self) {
        if let Some(display) = &mut self.display {
            display.move_robot(self.engine.session(), self.clock.now());
        }
    }

    /// Updates the state of the participant's display, and of the observers' page, that the console shows to the wizard.
    pub(super) fn examine_display(&mut self) {
        if let (Some(display), Some(health)) = (&self.display, &mut self.model.display) {
            display.examine(health);
        }
        self.model.observers = self.observers.as_ref().map(|status| status());
    }

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
