//! The participant's wall display (a page in a browser): its settings in a session file, and the reports that the page
//! sends. The module `display` computes the page's content.

// Network addresses are plain values here; this module opens no connections.
use core::net::{IpAddr, Ipv4Addr};
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::settings::SettingError;
use tomcom_core::base::time::SessionTime;

/// `[display]` of a session file: settings of the participant's display.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DisplaySpec {
    /// Address at which the display's page is served; other addresses than localhost need the pairing code that the
    /// console shows.
    pub listen: IpAddr,
    /// The TCP port of the display's page.
    pub port: u16,
    /// Language of the display's page: "en", "de", or the path of a file with words, relative to the session file.
    pub language: String,
    /// Words of the page from the language file; in a recording, the words in use.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub words: BTreeMap<String, String>,
    /// Which pictures on the page have names beside them.
    pub names: DisplayedNames,
    /// Whether each button on the page shows its keyboard key.
    pub keys: bool,
    /// Whether the page shows the robot's next press. The paper does not show it, since a shown intention is
    /// communication.
    pub intention: bool,
    /// How the page shows a robot that the participant cannot see otherwise.
    pub arm: RobotDepiction,
    /// Whether AprilTags are shown in the corners, by which an eye tracker finds the display.
    pub tags: bool,
    /// Whether a square on the page flashes at the start of the trial and at signals, to synchronise video recordings.
    pub flash: bool,
    /// Whether the page says why a press has no effect.
    pub reasons: bool,
    /// Whether the page plays a tone at a press without effect, and another one at a signal.
    pub sound: bool,
    /// Whether the page shows the time that the trial still has.
    pub clock: bool,
    /// Whether the page shows the number of served orders.
    pub served: bool,
    /// Where questionnaires are answered: on the display or at the console.
    pub questionnaire: AnswerDevice,
}

impl Default for DisplaySpec {
    fn default() -> DisplaySpec {
        DisplaySpec {
            listen: IpAddr::V4(Ipv4Addr::LOCALHOST),
            port: 50022,
            language: "en".to_string(),
            words: BTreeMap::new(),
            names: DisplayedNames::Orders,
            keys: true,
            intention: false,
            arm: RobotDepiction::Hand,
            tags: true,
            flash: true,
            reasons: true,
            sound: false,
            clock: false,
            served: false,
            questionnaire: AnswerDevice::Console,
        }
    }
}

impl DisplaySpec {
    /// Whether other computers can open the display's page.
    pub fn is_open(&self) -> bool {
        !self.listen.is_loopback()
    }

    /// Language code of the display's page; a file with words contains its own language code.
    pub fn code(&self) -> &str {
        self.words.get("language").unwrap_or(&self.language)
    }

    /// Built-in languages of the display's page.
    pub const LANGUAGES: [&str; 2] = ["en", "de"];

    pub(super) fn check(&self) -> Result<(), SettingError> {
        let is_long = |word: &&String| word.chars().count() > 400;
        match self.words.values().find(is_long) {
            Some(word) => {
                let found = format!("a word of {} characters for the display", word.chars().count());
                Err(SettingError::new("display.words", found, "at most 400 characters"))
            }
            None => Ok(()),
        }
    }
}

/// Which pictures on the participant's display have names beside them. Contents of places never have a name, since
/// telling salmon from tuna is part of the task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DisplayedNames {
    /// No picture has a name beside it.
    None,
    /// Pictures of storages have names beside them.
    Storages,
    /// Pictures of storages and orders have names beside them.
    Orders,
}

/// How the participant's display shows the robot. An approaching hand reveals an intention, as a real robot's does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RobotDepiction {
    /// The page does not show the robot: a real robot stands beside the display.
    None,
    /// The page shows a hand that moves between the places with its content.
    Hand,
    /// The page shows a hand with an arm, seen from above.
    Arm,
}

impl RobotDepiction {
    /// Name of this choice of the shown robot in files and tables.
    pub fn name(self) -> &'static str {
        match self {
            RobotDepiction::None => "none",
            RobotDepiction::Hand => "hand",
            RobotDepiction::Arm => "arm",
        }
    }
}

/// Where answers of the participant are entered, and by whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerDevice {
    /// Answers are entered at the console: the wizard reads the items out and enters the participant's answers.
    Console,
    /// Answers are entered on the display by the participant; the wizard can also enter answers.
    Display,
}

/// Reports of the participant's display; all are witnesses (only recorded).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum DisplayEvent {
    /// The display's page is connected.
    Connected {
        /// Width of the page in pixels.
        width_px: u32,
        /// Height of the page in pixels.
        height_px: u32,
    },
    /// The display's page is disconnected.
    Lost,
    /// The page has drawn a frame with the flash for an event (trial start, signal).
    Drawn {
        /// Sequence number of the event for which the page flashed.
        cue: u64,
        /// Session time at which the page drew the frame, by its synchronised clock.
        at_ns: SessionTime,
    },
}
