//! Settings of the participant and of the gaze source in a session file.

use core::net::{IpAddr, Ipv4Addr};

use serde::{Deserialize, Serialize};

use tomcom_people::participant::population::Population;

const LOCALHOST: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);

/// Settings of the participant and of the gaze source.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ParticipantSpec {
    /// Anonymous code of the participant, never a name.
    pub code: String,
    /// Whether a simulated participant or a person takes part, and by which input.
    pub kind: ParticipantKind,
    /// Source of the gaze samples.
    pub gaze: GazeSource,
    /// UDP and TCP port of the JSON gaze input.
    pub gaze_port: u16,
    /// Address at which the JSON gaze input listens; this computer's own (localhost) by default.
    pub gaze_listen: IpAddr,
    /// Addresses of other computers from which gaze is read; if empty, other computers need the pairing code.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gaze_from: Vec<IpAddr>,
    /// Addresses from which the JSON gaze input reads datagrams.
    pub gaze_senders: GazeSenders,
    /// Population from which simulated participants are drawn; `None` for the default population.
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
            gaze_listen: LOCALHOST,
            gaze_from: Vec::new(),
            gaze_senders: GazeSenders::First,
            population: None,
        }
    }
}

impl ParticipantSpec {
    /// Whether gaze samples come from the simulated participant.
    pub fn simulates_gaze(&self) -> bool {
        self.kind == ParticipantKind::Simulated && self.gaze == GazeSource::Simulated
    }
}

/// Who takes the human's part: a simulation or a person, and by which input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticipantKind {
    /// A simulated participant.
    Simulated,
    /// A person who presses keys at the keyboard of the console.
    Keyboard,
    /// A person at the wall display, which is a page in a browser.
    Display,
}

/// Source of gaze samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSource {
    /// Gaze comes from the eyes of the simulated participant.
    Simulated,
    /// Gaze is the mouse pointer: over the console's kitchen, or over the display if the participant plays there.
    Mouse,
    /// Gaze comes from the eye tracker Pupil Core, through Pupil Capture's network API.
    Pupil,
    /// Gaze comes from a recorded file: Pupil Player's export, or a recording of this program.
    File,
    /// Gaze comes as newline separated JSON over TCP or UDP (network) from another program.
    Json,
    /// Gaze comes from a stream of the Lab Streaming Layer.
    Lsl,
    /// There are no gaze samples at all.
    None,
}

/// Addresses from which the JSON gaze input accepts datagrams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GazeSenders {
    /// Only the address that sent the first gaze sample is accepted, until it has been silent for 5 s.
    First,
    /// Gaze datagrams from every address are accepted.
    Any,
}
