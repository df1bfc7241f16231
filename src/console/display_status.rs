//! The participant's display, as far as the wizard has to know: where it is, whether somebody is there, how quick it is.

use crate::session::Session;
use crate::session::preflight_checks::{PreflightCheck, PreflightVerdict};
use crate::session::settings::{GazeSource, ParticipantKind};

/// The participant's display.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisplayHealth {
    /// "http://127.0.0.1:50022".
    pub url: String,
    /// What the page asks for, if the network reaches it.
    pub code: Option<String>,
    /// The page that takes part: its size in pixels.
    pub page: Option<[u32; 2]>,
    /// It shows the layout of upright screens, on which gaze is not mapped.
    pub upright: bool,
    /// There and back, in milliseconds.
    pub round_trip_ms: Option<f64>,
    /// From the last press to its effect on the screen, in milliseconds.
    pub redraw_ms: Option<f64>,
    /// Pages that only watch.
    pub watching: u64,
    /// Messages that could not be read.
    pub malformed: u64,
    /// Connections that were not let in.
    pub refused: u64,
}

/// Smaller screens are hard to read from where the participant stands, in pixels.
const SMALL_PX: [u32; 2] = [1280, 720];
/// A page that needs longer there and back delays presses, in milliseconds.
const SLOW_MS: f64 = 30.0;

impl DisplayHealth {
    /// For the line of what is alive; true: it is as it should be.
    pub fn line(&self) -> (String, bool) {
        match (self.page, self.redraw_ms.or(self.round_trip_ms)) {
            (None, _) => ("NO DISPLAY".to_string(), false),
            (Some(_), None) => ("display ok".to_string(), true),
            (Some(_), Some(ms)) => (format!("display {ms:.0} ms"), true),
        }
    }

    fn address(&self) -> String {
        format!("open {} in a browser, full screen", self.url)
    }

    /// The text with the pairing code behind it, if the page asks for one.
    fn with_code(&self, text: String) -> String {
        match &self.code {
            Some(code) => format!("{text}; pairing code {code}"),
            None => text,
        }
    }

    /// What is to be opened, with its pairing code, as long as no page takes part.
    pub fn to_open(&self) -> Option<String> {
        self.page.is_none().then(|| self.with_code(self.address()))
    }

    /// What is looked at before a trial with gaze from this source.
    pub fn check(&self, gaze: GazeSource) -> PreflightCheck {
        let Some([width, height]) = self.page else {
            let found = self.with_code("no page is connected".to_string());
            return PreflightCheck::new("display", PreflightVerdict::Failed, found, self.address());
        };
        let trip = self.round_trip_ms.map_or(String::new(), |ms| format!(", {ms:.0} ms there and back"));
        let others = match self.watching {
            0 => String::new(),
            watching => format!(", {watching} more watching"),
        };
        let wrong = match self.malformed + self.refused {
            0 => String::new(),
            _ => format!(", {} messages malformed, {} refused", self.malformed, self.refused),
        };
        let upright = if self.upright { " upright" } else { "" };
        let found = format!("{width}x{height}{upright}{trip}{others}{wrong}");
        // Who holds an upright screen in the hand reads it from nearby.
        let is_small = !self.upright && (width < SMALL_PX[0] || height < SMALL_PX[1]);
        let is_slow = self.round_trip_ms.is_some_and(|ms| ms > SLOW_MS);
        let (verdict, remedy) = match (is_small, is_slow) {
            _ if self.upright && gaze != GazeSource::None => {
                (PreflightVerdict::Warning, "turn the screen: on an upright page there is no gaze")
            }
            (true, _) => (PreflightVerdict::Warning, "full screen (F11) on a display of at least 1280x720"),
            (false, true) => (PreflightVerdict::Warning, "a page on this computer, or a wire instead of radio"),
            (false, false) => (PreflightVerdict::Ok, ""),
        };
        PreflightCheck::new("display", verdict, found, remedy)
    }
}

/// Whether the participant is at the display.
pub fn is_wanted(session: &Session) -> bool {
    session.spec.participant.kind == ParticipantKind::Display
}
