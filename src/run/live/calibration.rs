//! The targets of a check of the calibration, when it is time for them.

use tokio::time::Instant;

use super::Live;
use crate::session::Event;
use crate::session::calibration::Check;

impl Live {
    /// When the next target is to be shown; nothing while no check goes on.
    pub(super) fn next_target(&self) -> Option<Instant> {
        let (time, _) = self.engine.session().calibration.as_ref().and_then(Check::next)?;
        Some(Instant::from_std(self.clock.instant_of(time)))
    }

    /// Shows the next target, or hides the last one.
    pub(super) fn show_target(&mut self) {
        if let Some((_, event)) = self.engine.session().calibration.as_ref().and_then(Check::next) {
            self.input(Event::Calibration(event));
        }
    }
}
