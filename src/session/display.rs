//! The participant's wall display: what a session file says of it, and what it tells of itself. What stands on it is made
//! from the session in the room `display`.

// Addresses are values here; nothing is connected to.
use core::net::{IpAddr, Ipv4Addr};
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::setting_checks::SettingError;
use crate::base::time::SessionTime;

/// The `[display]` of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DisplaySpec {
    /// Where the page is served; anything but localhost needs the pairing code that the console shows.
    pub listen: IpAddr,
    pub port: u16,
    /// "en", "de", or a file with words, relative to the session file.
    pub language: String,
    /// The words of that file; in a recording those that were in force.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub words: BTreeMap<String, String>,
    pub names: Names,
    /// Each button shows its key.
    pub keys: bool,
    /// What the robot is about to press is shown. The paper does without: a shown intention is communication.
    pub intention: bool,
    /// AprilTags in the corners, by which an eye tracker knows the display.
    pub tags: bool,
    /// A square flashes at the start of the trial and at signals, for a video from outside.
    pub flash: bool,
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
            tags: true,
            flash: true,
            questionnaire: Answering::Console,
        }
    }
}

impl DisplaySpec {
    /// Whether the network reaches the page.
    pub fn is_open(&self) -> bool {
        !self.listen.is_loopback()
    }

    /// The code of the language: a file with words names its own.
    pub fn code(&self) -> &str {
        self.words.get("language").unwrap_or(&self.language)
    }

    /// The languages that the program carries.
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

/// What is written beside its picture. What lies at a place never is: to tell salmon from tuna is part of the task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Names {
    None,
    /// What the storages hold.
    Storages,
    /// That, and what the orders want.
    Orders,
}

/// Where a questionnaire is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answering {
    /// The wizard reads it out and types the answers.
    Console,
    /// By the participant, on the display; the wizard can help.
    Display,
}

/// What the page that takes part tells; witnesses, all of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum DisplayEvent {
    /// It is there, of this size in pixels.
    Connected { width_px: u32, height_px: u32 },
    /// It is gone.
    Lost,
    /// It drew what the event of this number brought (the start of the trial, a signal), with a flash for a video, at this
    /// session time by its own clock.
    Drawn { cue: u64, at_ns: SessionTime },
}
