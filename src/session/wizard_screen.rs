//! Visible content of the wizard's screen, recorded at every change, since the wizard's decisions depend on it.

use serde::{Deserialize, Serialize};

use super::console_settings::WizardVisibility;

/// Visible content of the wizard's screen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WizardScreenContent {
    /// How much the wizard may see in this session.
    pub visibility: WizardVisibility,
    /// Size class of the screen: `small`, `medium`, `large`, or `too_small` for anything but questions.
    pub room: String,
    /// The names of the visible panels, from top to bottom.
    pub panels: Vec<String>,
    /// Name of the open dialog, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dialog: Option<String>,
}
