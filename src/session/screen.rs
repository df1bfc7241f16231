//! What the wizard can see: written down whenever it changes, since a judgement depends on what it was made from.

use serde::{Deserialize, Serialize};

use super::console_settings::Visibility;

/// What is on the screen.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct VisibleScreen {
    pub visibility: Visibility,
    /// How much room there is: `small`, `medium`, `large`, or `too_small` for anything but questions.
    pub room: String,
    /// The names of the panels, from top to bottom.
    pub panels: Vec<String>,
    /// What is open above them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dialog: Option<String>,
}
