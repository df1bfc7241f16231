//! State of the participant's display as the wizard needs it: its address, whether a page is connected, and its delays.

use tomcom_session::Session;
use tomcom_session::preflight_checks::{PreflightCheck, PreflightVerdict};
use tomcom_session::settings::{GazeSource, ParticipantKind};

/// State of the participant's display: the web page on the wall screen and its connection.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticipantDisplayHealth {
    /// Address of the display's web page: "http://127.0.0.1:50022".
    pub url: String,
    /// Pairing code that the web page asks for; `None` if the page can only be opened at this computer.
    pub code: Option<String>,
    /// Size in pixels of the page that the participant uses; `None` if no such page is connected.
    pub page: Option<[u32; 2]>,
    /// Whether the page shows the layout of upright screens, on which gaze is not mapped.
    pub upright: bool,
    /// Round-trip time between the program and the page, in milliseconds.
    pub round_trip_ms: Option<f64>,
    /// Delay from the participant's last press to its effect on the screen, in milliseconds.
    pub redraw_ms: Option<f64>,
    /// Number of connected participant pages that only watch.
    pub watching: u64,
    /// Number of unreadable messages from participant pages.
    pub malformed: u64,
    /// Number of rejected connections to the participant's display.
    pub refused: u64,
}

/// Least size of the participant's page in pixels; a smaller screen is hard to read from where the participant stands.
const SMALL_PX: [u32; 2] = [1280, 720];
/// Round-trip time above which presses at the page are noticeably delayed, in milliseconds.
const SLOW_MS: f64 = 30.0;

impl ParticipantDisplayHealth {
    /// State of the participant's display for the console's head line; `true` if all is well.
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

    /// The text, followed by the pairing code if the participant's page asks for a code.
    fn with_code(&self, text: String) -> String {
        match &self.code {
            Some(code) => format!("{text}; pairing code {code}"),
            None => text,
        }
    }

    /// Address to open for the participant, with the pairing code, while no participant page is connected.
    pub fn to_open(&self) -> Option<String> {
        self.page.is_none().then(|| self.with_code(self.address()))
    }

    /// Preflight check of the participant's display before a trial whose gaze comes from this source.
    pub fn check(&self, gaze: GazeSource) -> PreflightCheck {
        let Some([width, height]) = self.page else {
            let found = self.with_code("participant's page not connected".to_string());
            return PreflightCheck::new("display", PreflightVerdict::Failed, found, self.address());
        };
        let trip = self.round_trip_ms.map_or(String::new(), |ms| format!(", {ms:.0} ms round trip"));
        let others = match self.watching {
            0 => String::new(),
            watching => format!(", {watching} more watch the page"),
        };
        let wrong = match self.malformed + self.refused {
            0 => String::new(),
            _ => format!(", {} messages malformed, {} connections rejected", self.malformed, self.refused),
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
            (true, _) => {
                (PreflightVerdict::Warning, "show the page in full screen (F11) on a display of at least 1280x720")
            }
            (false, true) => {
                (PreflightVerdict::Warning, "open the page on this computer, or use a cable instead of Wi-Fi")
            }
            (false, false) => (PreflightVerdict::Ok, ""),
        };
        PreflightCheck::new("display", verdict, found, remedy)
    }
}

/// Whether the session's participant uses the display.
pub fn is_wanted(session: &Session) -> bool {
    session.spec.participant.kind == ParticipantKind::Display
}
