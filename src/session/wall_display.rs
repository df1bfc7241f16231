//! The participant's wall display: its settings in a session file, and its reports. The room `display` computes its content.

// Addresses are plain values here; nothing connects to them.
use core::net::{IpAddr, Ipv4Addr};
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;
use crate::base::time::SessionTime;

/// The `[display]` of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DisplaySpec {
    /// Address at which the page is served; other addresses than localhost need the pairing code that the console shows.
    pub listen: IpAddr,
    /// The TCP port of the page.
    pub port: u16,
    /// Language of the page: "en", "de", or the path of a file with words, relative to the session file.
    pub language: String,
    /// Words from that file; in a recording, the words in use.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub words: BTreeMap<String, String>,
    /// What is written beside the pictures.
    pub names: Names,
    /// Whether each button shows its key.
    pub keys: bool,
    /// Whether the robot's next press is shown. The paper does not show it, since a shown intention is communication.
    pub intention: bool,
    /// How the robot is shown that nobody can see otherwise. A session file without it means a hand; a recording without it was
    /// made when nothing was shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arm: Option<DisplayedArm>,
    /// Whether AprilTags are shown in the corners, by which an eye tracker finds the display.
    pub tags: bool,
    /// Whether a square flashes at the start of the trial and at signals, to synchronise video recordings.
    pub flash: bool,
    /// Whether a press without effect says why. A session file without it means yes; a recording without it was made when nothing
    /// was said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reasons: Option<bool>,
    /// Whether the page plays a tone at a press without effect, and another one at a signal.
    pub sound: bool,
    /// Whether the time that the trial still has is shown.
    pub clock: bool,
    /// Whether the number of served orders is shown. A session file without it means no; a recording without it was made when it
    /// was always shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub served: Option<bool>,
    /// Where questionnaires are answered.
    pub questionnaire: Answering,
}

impl Default for DisplaySpec {
    fn default() -> DisplaySpec {
        DisplaySpec {
            listen: IpAddr::V4(Ipv4Addr::LOCALHOST),
            port: 50022,
            language: "en".to_string(),
            words: BTreeMap::new(),
            names: Names::Orders,
            keys: true,
            intention: false,
            arm: None,
            tags: true,
            flash: true,
            reasons: None,
            sound: false,
            clock: false,
            served: None,
            questionnaire: Answering::Console,
        }
    }
}

impl DisplaySpec {
    /// Whether the page can be reached from other computers.
    pub fn is_open(&self) -> bool {
        !self.listen.is_loopback()
    }

    /// Whether the number of served orders is shown.
    pub fn shows_served(&self) -> bool {
        self.served != Some(false)
    }

    /// Language code; a file with words contains its own.
    pub fn code(&self) -> &str {
        self.words.get("language").unwrap_or(&self.language)
    }

    /// Built-in languages.
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

/// Which pictures have labels. Contents of places never have one, since telling salmon from tuna is part of the task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Names {
    /// Nothing: pictures alone.
    None,
    /// Labels at storages.
    Storages,
    /// Labels at storages and orders.
    Orders,
}

/// How the robot is shown. An approaching hand tells an intention, as a real robot's does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DisplayedArm {
    /// Not at all: a real robot stands there.
    None,
    /// A hand that moves between the places with what it holds.
    Hand,
    /// The same with an arm, seen from above.
    Arm,
}

impl DisplayedArm {
    /// Name in settings and tables.
    pub fn name(self) -> &'static str {
        match self {
            DisplayedArm::None => "none",
            DisplayedArm::Hand => "hand",
            DisplayedArm::Arm => "arm",
        }
    }
}

/// Who enters the answers of a questionnaire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answering {
    /// The wizard reads the items out and enters the answers.
    Console,
    /// The participant answers on the display; the wizard can also enter answers.
    Display,
}

/// Reports of the acting page; all are witnesses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum DisplayEvent {
    /// The page is connected, with this size in pixels.
    Connected {
        /// Width of the page in pixels.
        width_px: u32,
        /// Height of the page in pixels.
        height_px: u32,
    },
    /// The page is disconnected.
    Lost,
    /// The page drew the event with this sequence number (trial start, signal) with a flash, at this session time by its
    /// synchronised clock.
    Drawn {
        /// Sequence number of that event.
        cue: u64,
        /// When it was drawn by the page's own clock, in session time.
        at_ns: SessionTime,
    },
}
