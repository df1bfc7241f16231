//! State that all connections of the participant's display share, and counters of its pages.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;
use tokio::sync::watch;

use super::connection::serve_page;
use super::message::PageInput;
use crate::connection_table::ConnectionLimits;
use crate::page_server::{PageDoor, PageRoom, PageSocket};

/// Limits for connections to the display's server. Far fewer connections are admitted as watching pages than can be
/// open, so that a new page always has room for its handshake. The page that takes part is reserved and not counted.
pub(super) const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 256,
    per_address: 128,
    admitted: 96,
    admitted_per_address: 32,
    // A page that is silent for this long has already been disconnected.
    silence: Duration::from_secs(90),
};

/// Messages for the participant's pages: the newest message of each kind.
#[derive(Clone)]
pub(super) struct PageFeed {
    pub scene: watch::Receiver<Arc<str>>,
    pub sight: watch::Receiver<Arc<str>>,
    pub robot: watch::Receiver<Arc<str>>,
}

/// State that all connections of the participant's display share.
pub(super) struct ServerState {
    pub door: Arc<PageDoor>,
    pub words: BTreeMap<String, String>,
    pub inputs: Sender<PageInput>,
    pub told: PageFeed,
    pub status: Arc<DisplayStatus>,
    /// Connection number and page name of the page that takes part.
    pub acting: watch::Sender<Option<(u64, String)>>,
}

impl PageRoom for ServerState {
    const FILES: &'static [(&'static str, &'static str, &'static str)] = &[
        ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
        ("/display.css", "text/css; charset=utf-8", include_str!("page/display.css")),
        ("/talk.js", "text/javascript; charset=utf-8", include_str!("page/talk.js")),
        ("/display.js", "text/javascript; charset=utf-8", include_str!("page/display.js")),
        ("/sound.js", "text/javascript; charset=utf-8", include_str!("page/sound.js")),
        ("/readiness.js", "text/javascript; charset=utf-8", include_str!("page/readiness.js")),
        ("/reason.js", "text/javascript; charset=utf-8", include_str!("page/reason.js")),
        ("/status.js", "text/javascript; charset=utf-8", include_str!("page/status.js")),
        ("/robot.js", "text/javascript; charset=utf-8", include_str!("page/robot.js")),
        ("/room.js", "text/javascript; charset=utf-8", include_str!("page/room.js")),
        ("/upright.js", "text/javascript; charset=utf-8", include_str!("page/upright.js")),
        ("/stage.js", "text/javascript; charset=utf-8", include_str!("page/stage.js")),
        ("/tutorial.js", "text/javascript; charset=utf-8", include_str!("page/tutorial.js")),
        ("/probe.js", "text/javascript; charset=utf-8", include_str!("page/probe.js")),
        ("/questions.js", "text/javascript; charset=utf-8", include_str!("page/questions.js")),
        ("/hands.js", "text/javascript; charset=utf-8", include_str!("page/hands.js")),
        ("/art.js", "text/javascript; charset=utf-8", include_str!("page/art.js")),
    ];
    type Input = PageInput;

    fn door(&self) -> &Arc<PageDoor> {
        &self.door
    }

    fn inputs(&self) -> &Sender<PageInput> {
        &self.inputs
    }

    async fn serve(self: Arc<ServerState>, page: PageSocket) {
        serve_page(page, self).await;
    }
}

impl ServerState {
    /// Instant that corresponds to a time on the server's clock. Times that pages send are trusted only within the last
    /// 2 s; other times are set to the nearest end of that range.
    pub fn moment(&self, at_ms: f64) -> Instant {
        /// Longest delay of a press between page and server, in milliseconds.
        const OLDEST_MS: f64 = 2000.0;
        let now = Instant::now();
        let age_ms = (self.door.now_ms() - at_ms).clamp(0.0, OLDEST_MS);
        now.checked_sub(Duration::from_secs_f64(age_ms / 1000.0)).unwrap_or(now)
    }

    /// Updates the state of the participant page that takes part.
    pub fn change_page(&self, change: impl FnOnce(&mut Option<ActivePage>)) {
        change(&mut self.status.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// State of the participant page that takes part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActivePage {
    pub width_px: u32,
    pub height_px: u32,
    /// Whether the page shows the layout of upright screens, on which gaze is not mapped.
    pub upright: bool,
    pub round_trip_ms: Option<f64>,
    pub redraw_ms: Option<f64>,
    /// Whether the browser can speak the session's language; `None` where the session does not want that.
    pub voice: Option<bool>,
}

/// State and counters of the participant's pages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DisplayCounts {
    pub page: Option<ActivePage>,
    pub watching: u64,
    pub malformed: u64,
    /// Number of refused pages and messages: wrong pairing code, too many, too fast, or from a watching page.
    pub refused: u64,
}

/// State of the page that takes part, for the program.
pub(super) type DisplayStatus = Mutex<Option<ActivePage>>;
