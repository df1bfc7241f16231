//! State that all connections of the participant's display share.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;
use tokio::sync::watch;

use super::page_input::PageInput;
use super::status::DisplayStatus;
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
    /// Message with the pose of the robot's hand on the display.
    pub robot: watch::Receiver<Arc<str>>,
}

/// State that all connections of the participant's display share.
pub(super) struct ServerState {
    /// Check of pairing codes for participant pages; `None` if no code is required.
    pairing: Option<Mutex<PairingCodeCheck>>,
    /// Texts of the participant's page, by key.
    pub words: BTreeMap<String, String>,
    pub inputs: Sender<PageInput>,
    /// Newest messages for the participant's pages.
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

    /// Whether participant pages need a pairing code.
    pub fn has_code(&self) -> bool {
        self.pairing.is_some()
    }

    /// Time to wait before a pairing code that was typed into a page is to be checked.
    pub fn pairing_delay(&self, page: &str, typed: &str) -> Duration {
        let Some(desk) = &self.pairing else { return Duration::ZERO };
        let desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
        desk.delay(Some(page), typed, Instant::now())
    }

    /// Checks a pairing code that was typed into a page. Attempts of all connections are checked one after another.
    pub fn pair(&self, address: IpAddr, page: &str, typed: &str) -> PairingVerdict {
        match &self.pairing {
            Some(desk) => {
                let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
                desk.attempt(address, Some(page), typed, Instant::now())
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
