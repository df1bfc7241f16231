//! What the participant's display and the observers' page share: a server of pages in browsers, on a thread of its own, so that connections
//! cannot delay the session. A page identifies itself over a WebSocket, with the pairing code where one is needed.

mod http;
mod socket;

pub(crate) use socket::{PageMessage, PageSocket};

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde::Serialize;
use tokio::net::TcpListener;
use tokio::sync::mpsc::Sender;

use crate::connection_table::{ConnectionHandle, ConnectionLimits, ConnectionTable};
use crate::lock;
use crate::outer_address::reachable;
use crate::pairing::{PairingCodeCheck, PairingVerdict, pairing_code};

/// Longest message of a page, in bytes.
const MAX_BYTES: usize = 4096;

/// What one server serves: the participant's page, or the observers' page.
pub(crate) trait PageRoom: Send + Sync + Sized + 'static {
    /// Files of the page: path, content type, and content of each file.
    const FILES: &'static [(&'static str, &'static str, &'static str)];
    /// What a page puts into the session.
    type Input: Send;

    fn door(&self) -> &Arc<PageDoor>;

    /// Inputs of the pages; the server stops when their receiver is dropped.
    fn inputs(&self) -> &Sender<Self::Input>;

    /// Serves a page until one side closes the connection.
    fn serve(self: Arc<Self>, page: PageSocket) -> impl Future<Output = ()> + Send;
}

/// The way into a room: pairing code, limits of connections, counters.
pub(crate) struct PageDoor {
    /// Check of pairing codes; `None` if no code is required.
    pairing: Option<Mutex<PairingCodeCheck>>,
    connections: Arc<ConnectionTable>,
    pub counts: PageCounts,
    began: Instant,
}

/// Counters of a server's pages.
#[derive(Debug, Default)]
pub(crate) struct PageCounts {
    /// Number of pages that are let in at present.
    pub pages: AtomicU64,
    pub malformed: AtomicU64,
    /// Number of refused pages and messages.
    pub refused: AtomicU64,
}

impl PageDoor {
    fn new(code: Option<String>, limits: ConnectionLimits) -> PageDoor {
        let pairing = code.map(|code| Mutex::new(PairingCodeCheck::new(code)));
        let (connections, counts) = (ConnectionTable::new(limits), PageCounts::default());
        PageDoor { pairing, connections, counts, began: Instant::now() }
    }

    fn has_code(&self) -> bool {
        self.pairing.is_some()
    }

    /// Time to wait before a pairing code that was typed into a page is to be checked.
    fn pairing_delay(&self, page: &str, typed: &str) -> Duration {
        let Some(check) = &self.pairing else { return Duration::ZERO };
        lock(check).delay(Some(page), typed, Instant::now())
    }

    /// Checks a pairing code that was typed into a page. Attempts of all connections are checked one after another.
    fn pair(&self, address: IpAddr, page: &str, typed: &str) -> PairingVerdict {
        match &self.pairing {
            Some(check) => lock(check).attempt(address, Some(page), typed, Instant::now()),
            None => PairingVerdict::Right,
        }
    }

    /// Time on the server's clock, in milliseconds.
    pub fn now_ms(&self) -> f64 {
        self.began.elapsed().as_secs_f64() * 1000.0
    }
}

/// A running server of pages: its address and pairing code.
pub(crate) struct PageServer {
    pub door: Arc<PageDoor>,
    address: SocketAddr,
    code: Option<String>,
    thread: Option<JoinHandle<io::Result<()>>>,
}

impl PageServer {
    /// Serves a room at an address. Addresses other than localhost need a pairing code, another one for each server.
    ///
    /// # Errors
    /// The program cannot listen at the address, or no thread can be started.
    pub async fn open<R: PageRoom>(
        listen: SocketAddr,
        limits: ConnectionLimits,
        name: &str,
        room: impl FnOnce(Arc<PageDoor>) -> R,
    ) -> io::Result<PageServer> {
        let listener = TcpListener::bind(listen).await?;
        let address = listener.local_addr()?;
        let listener = listener.into_std()?;
        let code = (!listen.ip().is_loopback()).then(pairing_code);
        let door = Arc::new(PageDoor::new(code.clone(), limits));
        let room = room(door.clone());
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let thread = std::thread::Builder::new().name(name.to_string());
        let thread = Some(thread.spawn(move || runtime.block_on(http::serve(listener, room)))?);
        Ok(PageServer { door, address, code, thread })
    }

    /// URL of the page, such as "http://127.0.0.1:50022"; for a wildcard address, with this machine's address in the
    /// network.
    pub fn url(&self) -> String {
        format!("http://{}", reachable(self.address))
    }

    /// Pairing code that the page asks for; `None` if no code is needed.
    pub fn code(&self) -> Option<&str> {
        self.code.as_deref()
    }

    /// Waits until the pages were told that the program ends; the receiver of their inputs must be closed before.
    pub fn end(&mut self) {
        // The server takes half a second at most to tell its pages; without waiting, the process would end before that.
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Adds 1 to a counter.
pub(crate) fn count(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

/// A message as JSON.
pub(crate) fn text(message: &impl Serialize) -> Arc<str> {
    // Messages have only string keys, so serialisation cannot fail.
    Arc::from(serde_json::to_string(message).unwrap_or_default())
}

/// The connection's place among the server's connections, which each of its requests has.
type Place = Arc<ConnectionHandle>;
