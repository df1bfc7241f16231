//! The panels that may be shown alone.

use crate::session::settings::Visibility;

/// A panel that may be shown alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// The kitchen as it truly is, with the wizard's keys.
    Kitchen,
    /// The estimate of the participant's belief.
    Belief,
    /// What the assistant advises.
    Recommendation,
    /// Where the participant looked lately.
    GazeMap,
    /// The newest events.
    Events,
    /// Presses, signals and errors over time.
    Timeline,
    /// Wizard and assistants side by side.
    Comparison,
}

impl Panel {
    /// In the order in which the keys go through them.
    pub(super) const ALL: [Panel; 7] = [
        Panel::Comparison,
        Panel::Kitchen,
        Panel::Belief,
        Panel::Recommendation,
        Panel::GazeMap,
        Panel::Events,
        Panel::Timeline,
    ];

    /// Whether the wizard may see it.
    pub(super) fn may_be_seen(self, visibility: Visibility, compares: bool) -> bool {
        match self {
            Panel::Comparison => compares,
            Panel::Belief => visibility >= Visibility::Belief,
            Panel::Recommendation => visibility >= Visibility::Recommendation,
            _ => true,
        }
    }
}
