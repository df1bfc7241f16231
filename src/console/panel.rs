//! The panels that may be shown alone.

use crate::session::settings::Visibility;

/// A panel that may be shown alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    Kitchen,
    Belief,
    Recommendation,
    GazeMap,
    Events,
    Timeline,
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
