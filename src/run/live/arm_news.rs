//! What the driver of a real arm tells, in a live session.

use super::live_session::Live;
use crate::run::operator_station::ArmNews;
use tomcom_session::TrialPhase;

impl Live {
    /// Takes what the arm does as events of the session, and what is found of it as checks.
    pub(super) fn take_arm_news(&mut self, news: ArmNews) {
        self.dirty = true;
        match news {
            ArmNews::Event(event) if self.engine.session().phase != TrialPhase::Closed => self.input(*event),
            ArmNews::Event(_) => {}
            ArmNews::Checks(checks) => self.model.arm = checks,
            ArmNews::Message(words) => self.model.warn(format!("the arm's controller: {words}")),
        }
    }
}
