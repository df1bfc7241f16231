//! A live session in a build without the feature `display`: sessions whose participant is at a display were refused before.

use super::Live;
use crate::console::display::DisplayHealth;
use crate::run::desk::{OperatorDesk, PageInput};

/// No display: this type has no value.
pub(super) enum ParticipantDisplay {}

impl ParticipantDisplay {
    /// The display at the desk: there is none.
    pub fn at(_: &OperatorDesk) -> (Option<ParticipantDisplay>, Option<DisplayHealth>) {
        (None, None)
    }
}

impl Live {
    /// Nothing is shown to the participant.
    pub(super) fn build_display(&mut self) {}

    /// Nothing is shown to the participant.
    pub(super) fn show_participant(&mut self) {}

    /// There is nothing to look at.
    pub(super) fn look_at_display(&mut self) {}

    /// Nothing comes from a display.
    pub(super) fn hear(&mut self, input: PageInput) {
        match input {}
    }
}
