//! State that all connections of the display share.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::mpsc::Sender;
use tokio::sync::watch;

use super::page_input::PageInput;
use super::status::DisplayStatus;
use crate::edge::connection_table::{ConnectionLimits, ConnectionTable};
use crate::edge::pairing::{PairingDesk, PairingVerdict};

/// Limits of the display's server. Far fewer connections are admitted as watching pages than can be open, so that a new page
/// always has room for its handshake. The acting page is reserved and not counted.
const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 256,
    per_address: 128,
    admitted: 96,
    admitted_per_address: 32,
    // The connection of a page that is silent for so long has been closed already.
    silence: Duration::from_secs(90),
};

/// What the pages are told, each the newest message.
#[derive(Clone)]
pub(super) struct PageFeed {
    pub scene: watch::Receiver<Arc<str>>,
    pub sight: watch::Receiver<Arc<str>>,
    /// Where the robot's hand is.
    pub robot: watch::Receiver<Arc<str>>,
}

/// State that all connections share.
pub(super) struct ServerState {
    /// Pairing code and attempts at it; `None` if no code is asked for.
    pairing: Option<Mutex<PairingDesk>>,
    /// Words of the page by key.
    pub words: BTreeMap<String, String>,
    pub inputs: Sender<PageInput>,
    /// What the pages are told.
    pub told: PageFeed,
    pub status: Arc<DisplayStatus>,
    /// Number of the acting connection and name of its page.
    pub acting: watch::Sender<Option<(u64, String)>>,
    pub connections: Arc<ConnectionTable>,
    began: Instant,
}

impl ServerState {
    /// The state of a server that nobody is connected to yet; its clock begins at `began`.
    pub fn new(
        code: Option<String>,
        words: BTreeMap<String, String>,
        inputs: Sender<PageInput>,
        (told, status): (PageFeed, Arc<DisplayStatus>),
        began: Instant,
    ) -> ServerState {
        let pairing = code.map(|code| Mutex::new(PairingDesk::new(code)));
        let (acting, connections) = (watch::Sender::new(None), ConnectionTable::new(LIMITS));
        ServerState { pairing, words, inputs, told, status, acting, connections, began }
    }

    /// Whether pages have to pair.
    pub fn has_code(&self) -> bool {
        self.pairing.is_some()
    }

    /// Checks a typed code. Attempts of all connections are checked one after another.
    pub fn pair(&self, address: IpAddr, page: &str, typed: &str) -> PairingVerdict {
        match &self.pairing {
            Some(desk) => {
                let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
                desk.attempt(address, Some(page), typed, Instant::now())
            }
            None => PairingVerdict::Right,
        }
    }

    /// The server's clock, in milliseconds.
    pub fn now_ms(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * 1000.0
    }

    /// The instant of a time on the server's clock, bounded to the last 2 s: a page's times are not trusted further.
    pub fn moment(&self, at_ms: f64) -> Instant {
        /// Longest delay of a press on its way, in milliseconds.
        const OLDEST_MS: f64 = 2000.0;
        let now = Instant::now();
        let age_ms = (self.now_ms() - at_ms).clamp(0.0, OLDEST_MS);
        now.checked_sub(Duration::from_secs_f64(age_ms / 1000.0)).unwrap_or(now)
    }
}
