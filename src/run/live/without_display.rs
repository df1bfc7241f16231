//! Stand-in for the participant's display in a live session, in a build without the feature `display`.

use crate::console::console_model::NoticeLevel;
use crate::console::preflight::ParticipantDisplayHealth;
use crate::run::operator_station::{OperatorStation, PageInput};
use tomcom_core::base::time::SessionTime;
use tomcom_session::{Event, Session};

/// The participant's display, which this build lacks; so the type has no values.
pub(super) enum ParticipantDisplay {}

impl ParticipantDisplay {
    pub fn at(_: &OperatorStation) -> (Option<ParticipantDisplay>, Option<ParticipantDisplayHealth>) {
        (None, None)
    }

    pub fn build(&mut self, _: &Session) {
        match *self {}
    }

    pub fn move_robot(&mut self, _: &Session, _: SessionTime) {
        match *self {}
    }

    pub fn show(&mut self, _: &Session, _: SessionTime) {
        match *self {}
    }

    pub fn examine(&self, _: &mut ParticipantDisplayHealth) {
        match *self {}
    }
}

/// What an input of the participant's page leads to: an event of the session, or a notice to the wizard.
pub(super) struct PageEvent {
    pub event: Option<Event>,
    pub notice: Option<(NoticeLevel, String)>,
}

impl PageEvent {
    pub fn from_input(input: PageInput, _: &Session, _: SessionTime) -> PageEvent {
        match input {}
    }
}
