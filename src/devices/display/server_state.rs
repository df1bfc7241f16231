//! State that all connections of the participant's display share, and counters of its pages.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;
use tokio::sync::watch;

use super::message::PageInput;
use crate::connection_table::{ConnectionLimits, ConnectionTable};
use crate::pairing::{PairingCodeCheck, PairingVerdict};

/// Limits for connections to the display's server. Far fewer connections are admitted as watching pages than can be
/// open, so that a new page always has room for its handshake. The page that takes part is reserved and not counted.
const LIMITS: ConnectionLimits = ConnectionLimits {
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
    /// Check of pairing codes for participant pages; `None` if no code is required.
    pairing: Option<Mutex<PairingCodeCheck>>,
    pub words: BTreeMap<String, String>,
    pub inputs: Sender<PageInput>,
    pub told: PageFeed,
    pub status: Arc<DisplayStatus>,
    /// Connection number and page name of the page that takes part.
    pub acting: watch::Sender<Option<(u64, String)>>,
    pub connections: Arc<ConnectionTable>,
    began: Instant,
}

impl ServerState {
    /// State of a display server without connections; its clock is zero at `began`.
    pub fn new(
        code: Option<String>,
        words: BTreeMap<String, String>,
        inputs: Sender<PageInput>,
        (told, status): (PageFeed, Arc<DisplayStatus>),
        began: Instant,
    ) -> ServerState {
        let pairing = code.map(|code| Mutex::new(PairingCodeCheck::new(code)));
        let (acting, connections) = (watch::Sender::new(None), ConnectionTable::new(LIMITS));
        ServerState { pairing, words, inputs, told, status, acting, connections, began }
    }

    pub fn has_code(&self) -> bool {
        self.pairing.is_some()
    }

    /// Time to wait before a pairing code that was typed into a page is to be checked.
    pub fn pairing_delay(&self, page: &str, typed: &str) -> Duration {
        let Some(check) = &self.pairing else { return Duration::ZERO };
        let check = check.lock().unwrap_or_else(PoisonError::into_inner);
        check.delay(Some(page), typed, Instant::now())
    }

    /// Checks a pairing code that was typed into a page. Attempts of all connections are checked one after another.
    pub fn pair(&self, address: IpAddr, page: &str, typed: &str) -> PairingVerdict {
        match &self.pairing {
            Some(check) => {
                let mut check = check.lock().unwrap_or_else(PoisonError::into_inner);
                check.attempt(address, Some(page), typed, Instant::now())
            }
            None => PairingVerdict::Right,
        }
    }

    /// Time on the display server's clock, in milliseconds.
    pub fn now_ms(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * 1000.0
    }

    /// Instant that corresponds to a time on the server's clock. Times that pages send are trusted only within the last
    /// 2 s; other times are set to the nearest end of that range.
    pub fn moment(&self, at_ms: f64) -> Instant {
        /// Longest delay of a press between page and server, in milliseconds.
        const OLDEST_MS: f64 = 2000.0;
        let now = Instant::now();
        let age_ms = (self.now_ms() - at_ms).clamp(0.0, OLDEST_MS);
        now.checked_sub(Duration::from_secs_f64(age_ms / 1000.0)).unwrap_or(now)
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

#[derive(Debug, Default)]
pub(super) struct DisplayStatus {
    pub pages: AtomicU64,
    pub malformed: AtomicU64,
    pub refused: AtomicU64,
    page: Mutex<Option<ActivePage>>,
}

impl DisplayStatus {
    /// The present state and counters of the participant's pages.
    pub fn counts(&self) -> DisplayCounts {
        let page = *self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        DisplayCounts {
            page,
            watching: self.pages.load(Ordering::Relaxed).saturating_sub(u64::from(page.is_some())),
            malformed: self.malformed.load(Ordering::Relaxed),
            refused: self.refused.load(Ordering::Relaxed),
        }
    }

    /// Updates the state of the participant page that takes part.
    pub fn page(&self, change: impl FnOnce(&mut Option<ActivePage>)) {
        change(&mut self.page.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    }
}

/// Adds 1 to a counter of the participant's pages.
pub(super) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}
