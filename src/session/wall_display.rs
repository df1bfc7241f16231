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
    /// Other addresses than localhost need the pairing code that the console shows.
    pub listen: IpAddr,
    /// TCP port of the page.
    pub port: u16,
    /// One of [`DisplaySpec::LANGUAGES`], or the path of a file with words, relative to the session file.
    pub language: String,
    /// From the language file; in a recording, the words in use.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub words: BTreeMap<String, String>,
    pub names: DisplayedNames,
    /// Whether each button shows its keyboard key.
    pub keys: bool,
    /// Whether the page shows the robot's next press. The paper does not show it, since a shown intention is
    /// communication.
    pub intention: bool,
    /// How the page shows a robot that the participant cannot see otherwise.
    pub arm: RobotDepiction,
    /// Whether the corners show AprilTags, by which an eye tracker finds the display.
    pub tags: bool,
    /// Whether a square flashes at the start and the end of the trial and at signals, to synchronise video recordings.
    pub flash: bool,
    /// Whether the page says why a press has no effect.
    pub reasons: bool,
    /// Whether the page plays a tone at a press without effect, and another one at a signal.
    pub sound: bool,
    /// Whether the page speaks signals, with the browser's voices.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub voice: bool,
    /// Whether the page shows the time that the trial still has.
    pub clock: bool,
    /// Whether the page shows the number of served orders.
    pub served: bool,
    /// Where questionnaires are answered.
    pub questionnaire: AnswerDevice,
    /// Whether the trial is paused while the page that takes part is lost for long; unset: in a plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pause_when_lost: Option<bool>,
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
            voice: false,
            clock: false,
            served: false,
            questionnaire: AnswerDevice::Console,
            pause_when_lost: None,
        }
    }
}

impl DisplaySpec {
    /// Whether other computers can open the page.
    pub fn is_open(&self) -> bool {
        !self.listen.is_loopback()
    }

    /// A file with words contains its own code.
    pub fn code(&self) -> &str {
        self.words.get("language").unwrap_or(&self.language)
    }

    /// Those that are built in.
    pub const LANGUAGES: [&str; 6] = ["en", "de", "es", "fr", "it", "ja"];

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

/// Which pictures have names beside them. Contents of places never have one, since telling salmon from tuna is part of
/// the task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DisplayedNames {
    None,
    Storages,
    /// Of storages, too.
    Orders,
}

/// An approaching hand reveals an intention, as a real robot's does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum RobotDepiction {
    /// A real robot stands beside the display.
    None,
    /// A hand that moves between the places with its content.
    Hand,
    /// A hand with an arm, seen from above.
    Arm,
}

named!(RobotDepiction);

/// Where answers of the participant are entered, and by whom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerDevice {
    /// The wizard reads the items out and enters the answers.
    #[default]
    Console,
    /// The participant enters the answers; the wizard can, too.
    Display,
}

/// All are witnesses (only recorded).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum DisplayEvent {
    /// The page that takes part, with its size.
    Connected { width_px: u32, height_px: u32 },
    /// The page that took part.
    Lost,
    /// The page has drawn a frame with the flash for an event (trial start, signal, trial end).
    Drawn {
        /// Sequence number of that event.
        cue: u64,
        /// By the page's synchronised clock.
        at_ns: SessionTime,
    },
}
