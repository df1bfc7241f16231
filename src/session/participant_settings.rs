//! What a session file says about the participant.

use serde::{Deserialize, Serialize};

use crate::participant::population::Population;

/// The participant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParticipantSpec {
    /// A code, never a name.
    pub code: String,
    pub kind: ParticipantKind,
    pub gaze: GazeSource,
    /// Where the JSON gaze input listens, on localhost.
    pub gaze_port: u16,
    /// From what population simulated participants are drawn; none: the program's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub population: Option<Population>,
}

impl Default for ParticipantSpec {
    fn default() -> Self {
        let code = "P01".to_string();
        ParticipantSpec {
            code,
            kind: ParticipantKind::Simulated,
            gaze: GazeSource::Simulated,
            gaze_port: 50021,
            population: None,
        }
    }
}

impl ParticipantSpec {
    /// Whether the gaze samples come from the simulated participant.
    pub fn simulates_gaze(&self) -> bool {
        self.kind == ParticipantKind::Simulated && self.gaze == GazeSource::Simulated
    }
}

/// Who plays the human's part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticipantKind {
    Simulated,
    /// Somebody at the keyboard of the console.
    Keyboard,
    /// Somebody at the wall display, a page in a browser.
    Display,
}

/// Where gaze samples come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSource {
    Simulated,
    /// The mouse pointer over the kitchen: the console's, or the display's if the participant is there.
    Mouse,
    /// Pupil Core, through Pupil Capture's network API.
    Pupil,
    /// A recorded file: Pupil Player's export, or a recording of this program.
    File,
    /// Newline separated JSON over TCP and UDP on localhost.
    Json,
    /// No gaze at all.
    None,
}
