//! The eye tracker: its settings, and what it tells beside its samples: whether it is there, whether it sees the display,
//! what of its stream could not be recorded, and the fixations and blinks that it found.

use serde::{Deserialize, Serialize};

use super::participant_settings::GazeSource;
use super::setting_checks::SettingError;
use crate::base::time::SessionTime;
use crate::gaze::quality::DropCounts;
use crate::gaze::surface::SurfaceMap;

/// The eye tracker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrackerSpec {
    /// Where Pupil Capture runs, and the port of its Pupil Remote.
    pub address: String,
    pub port: u16,
    /// The name of the surface that Capture defines by the tags on the wall display.
    pub surface: String,
    /// Where the corners of that surface are on the display, in fractions: top left, top right, bottom right, bottom left.
    /// Without them it is the one that Capture makes by itself, the hull of the black corners of the tags.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<[[f64; 2]; 4]>,
    /// Whether Capture records along with every trial.
    pub record: bool,
    /// The file that gaze is replayed from, relative to the session file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// From the participant's eyes to the wall display, in metres.
    pub distance_m: f64,
}

impl Default for TrackerSpec {
    fn default() -> Self {
        let (address, surface) = ("127.0.0.1".to_string(), "wall".to_string());
        TrackerSpec { address, port: 50020, surface, corners: None, record: true, file: None, distance_m: 2.0 }
    }
}

impl TrackerSpec {
    pub(super) fn is_default(&self) -> bool {
        *self == TrackerSpec::default()
    }

    pub(super) fn check(&self, gaze: GazeSource) -> Result<(), SettingError> {
        let is_name =
            |text: &str| (1..=100).contains(&text.len()) && !text.chars().any(|c| c.is_control() || c.is_whitespace());
        for (key, text) in [("address", &self.address), ("surface", &self.surface)] {
            if !is_name(text) {
                return Err(SettingError::new(
                    format!("tracker.{key}"),
                    format!("{key} = {text:?}"),
                    "1 to 100 signs without spaces",
                ));
            }
        }
        if let Some(corners) = self.corners
            && SurfaceMap::new(corners).is_none()
        {
            let remedy = "four corners in fractions of the display: top left, top right, bottom right, bottom left";
            return Err(SettingError::new("tracker.corners", format!("corners = {corners:?}"), remedy));
        }
        if gaze == GazeSource::File && self.file.is_none() {
            let remedy = "file = \"gaze.csv\" in [tracker], or --gaze-file PATH";
            return Err(SettingError::new("participant.gaze", "gaze = \"file\", and no file".to_string(), remedy));
        }
        Ok(())
    }
}

/// Something about the tracker. All of it comes from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum TrackerEvent {
    /// Its program answers; `device` is what it calls itself.
    Connected { device: String },
    /// Its program does not answer any more; it is tried again for ever.
    Lost { reason: String },
    /// It sees the display by its tags.
    DisplayFound,
    /// It does not, and so knows no gaze on it.
    DisplayLost,
    /// What came and could not be recorded, since the session began; at most once a second.
    Dropped(DropCounts),
    /// A fixation that is over, as the tracker finds them; its place in fractions of the display, if it was there.
    Fixation {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<[f64; 2]>,
        duration_ms: f64,
        dispersion_deg: f64,
        confidence: f64,
        device_ns: u64,
        /// When it began.
        began_ns: SessionTime,
    },
    /// Lids closed (onset) or opened (offset), as the tracker finds them.
    Blink { closed: bool, confidence: f64, device_ns: u64, taken_ns: SessionTime },
}

/// Whether the tracker's program is there.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum TrackerConnection {
    /// Nothing was heard of it.
    #[default]
    Unknown,
    Connected {
        device: String,
    },
    Lost {
        since: SessionTime,
        reason: String,
    },
}

/// What is known of the tracker.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackerStatus {
    pub link: TrackerConnection,
    /// Whether it sees the display; nothing: it has not said.
    pub sees_display: Option<bool>,
    /// How often it was lost.
    pub losses: u64,
    pub dropped: DropCounts,
    pub fixations: u64,
    pub blinks: u64,
}

impl TrackerStatus {
    /// Moves on by an event that was admitted.
    pub(super) fn apply(&mut self, now: SessionTime, event: &TrackerEvent) {
        match event {
            TrackerEvent::Connected { device } => self.link = TrackerConnection::Connected { device: device.clone() },
            TrackerEvent::Lost { reason } => {
                self.losses += 1;
                self.link = TrackerConnection::Lost { since: now, reason: reason.clone() };
                self.sees_display = None;
            }
            TrackerEvent::DisplayFound => self.sees_display = Some(true),
            TrackerEvent::DisplayLost => self.sees_display = Some(false),
            TrackerEvent::Dropped(counts) => self.dropped = *counts,
            TrackerEvent::Fixation { .. } => self.fixations += 1,
            TrackerEvent::Blink { closed, .. } => self.blinks += u64::from(*closed),
        }
    }
}

/// Whether the session takes the event.
///
/// # Errors
/// The reason why it does not.
pub(super) fn admit(event: &TrackerEvent) -> Result<(), &'static str> {
    let numbers = match event {
        TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, .. } => {
            let [x, y] = at.unwrap_or_default();
            vec![x, y, *duration_ms, *dispersion_deg, *confidence]
        }
        TrackerEvent::Blink { confidence, .. } => vec![*confidence],
        _ => Vec::new(),
    };
    match numbers.iter().all(|number| number.is_finite()) {
        true => Ok(()),
        false => Err("what the tracker tells is not a number"),
    }
}
