//! Panels of the console that can be shown alone at full size.

use tomcom_session::settings::WizardVisibility;

/// A panel of the console that can be shown alone at full size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    /// Kitchen as it truly is, with the wizard's keys.
    Kitchen,
    /// Estimate of the participant's beliefs.
    Belief,
    /// Signals that the assistant advises.
    Recommendation,
    /// Map of the places where the participant looked lately; shown at full size only.
    GazeMap,
    /// List of the newest events.
    Events,
    /// Timeline of presses, signals and errors.
    Timeline,
    /// Comparison of the wizard's and the assistants' signals on one time axis.
    Comparison,
}

impl Panel {
    /// All panels, in the order in which the keys go through them.
    pub(super) const ALL: [Panel; 7] = [
        Panel::Comparison,
        Panel::Kitchen,
        Panel::Belief,
        Panel::Recommendation,
        Panel::GazeMap,
        Panel::Events,
        Panel::Timeline,
    ];

    /// Whether the wizard may see the panel under this visibility setting.
    pub(super) fn may_be_seen(self, visibility: WizardVisibility, compares: bool) -> bool {
        match self {
            Panel::Comparison => compares,
            Panel::Belief => visibility >= WizardVisibility::Belief,
            Panel::Recommendation => visibility >= WizardVisibility::Recommendation,
            _ => true,
        }
    }
}
