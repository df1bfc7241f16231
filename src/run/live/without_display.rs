//! A live session in a build without the feature `display`; sessions with a participant at a display have been refused before.

use crate::base::time::SessionTime;
use crate::console::display_status::DisplayHealth;
use crate::console::notice::NoticeLevel;
use crate::run::desk::{OperatorDesk, PageInput};
use crate::session::{Event, Session};

/// No display: this type has no value.
pub(super) enum ParticipantDisplay {}

impl ParticipantDisplay {
    /// The display at the desk: there is none.
    pub fn at(_: &OperatorDesk) -> (Option<ParticipantDisplay>, Option<DisplayHealth>) {
        (None, None)
    }

    /// There is nothing to build.
    pub fn build(&mut self, _: &Session) {
        match *self {}
    }

    /// No hand is shown to the participant.
    pub fn move_robot(&mut self, _: &Session, _: SessionTime) {
        match *self {}
    }

    /// Nothing is shown to the participant.
    pub fn show(&mut self, _: &Session, _: SessionTime) {
        match *self {}
    }

    /// There is nothing to examine.
    pub fn examine(&self, _: &mut DisplayHealth) {
        match *self {}
    }
}

/// An input of the page as an event of the session and a notice to the wizard.
pub(super) struct PageEvent {
    pub event: Option<Event>,
    pub notice: Option<(NoticeLevel, String)>,
}

impl PageEvent {
    /// Nothing comes from a display.
    pub fn from_input(input: PageInput, _: &Session, _: SessionTime) -> PageEvent {
        match input {}
    }
}
