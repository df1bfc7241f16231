//! The observers' page: the wizard's screen as text, live and read-only, with a field for remarks.
//!
//! The console only puts its newest frame into a channel; the server's thread compares frames and sends what changed.
//! An observer who reads slowly skips frames. Nothing of it reaches the participant's display, which is another server
//! with another pairing code.

mod connection;
mod frame;

pub use frame::{CellColour, CellRun, ScreenFrame};

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::sync::mpsc::{Receiver, Sender, channel};
use tokio::sync::{oneshot, watch};

use crate::connection_table::ConnectionLimits;
use crate::page_server::{PageDoor, PageRoom, PageServer, PageSocket};
use tomcom_session::Event;

/// Largest number of observers.
pub const MOST_OBSERVERS: usize = 20;
/// Limits for connections to the observers' server; there is always room for the handshake of a new page.
const LIMITS: ConnectionLimits = ConnectionLimits {
    most: 96,
    per_address: 64,
    admitted: MOST_OBSERVERS,
    admitted_per_address: MOST_OBSERVERS,
    // A page that is silent for this long has already been disconnected.
    silence: Duration::from_secs(90),
};
/// Largest number of remarks that wait for the session.
const WAITING: usize = 64;

/// A remark of an observer.
#[derive(Debug)]
pub struct Remark {
    /// Code of the observer.
    observer: String,
    note: String,
    /// Takes whether the remark is in the recording, else why not. Dropped: nothing is recorded now.
    answer: oneshot::Sender<Result<(), String>>,
}

impl Remark {
    /// The remark as an event of the session.
    pub fn event(&self) -> Event {
        Event::Marker { note: self.note.clone(), observer: Some(self.observer.clone()) }
    }

    /// Tells the observer whether the remark is in the recording, else why not.
    pub fn answer(self, outcome: Result<(), String>) {
        // The observer may have gone meanwhile.
        let _ = self.answer.send(outcome);
    }
}

/// State that all connections of the observers' pages share.
struct ObserverRoom {
    door: Arc<PageDoor>,
    remarks: Sender<Remark>,
    /// The newest frame of the wizard's screen.
    newest: watch::Receiver<Arc<ScreenFrame>>,
}

impl PageRoom for ObserverRoom {
    const FILES: &'static [(&'static str, &'static str, &'static str)] = &[
        ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
        ("/observers.css", "text/css; charset=utf-8", include_str!("page/observers.css")),
        ("/observers.js", "text/javascript; charset=utf-8", include_str!("page/observers.js")),
        ("/talk.js", "text/javascript; charset=utf-8", include_str!("../display/page/talk.js")),
    ];
    type Input = Remark;

    fn door(&self) -> &Arc<PageDoor> {
        &self.door
    }

    fn inputs(&self) -> &Sender<Remark> {
        &self.remarks
    }

    async fn serve(self: Arc<ObserverRoom>, page: PageSocket) {
        connection::serve_observer(page, &self).await;
    }
}

/// Server of the observers' page. Dropping the value tells the pages that the program ends, and stops the server.
pub struct ObserverServer {
    server: PageServer,
    remarks: Receiver<Remark>,
    newest: watch::Sender<Arc<ScreenFrame>>,
}

/// Handle that counts the observers.
#[derive(Clone)]
pub struct ObserverCount(Arc<PageDoor>);

impl ObserverCount {
    /// Number of observers that watch at present.
    pub fn watching(&self) -> u64 {
        self.0.counts.pages.load(Ordering::Relaxed)
    }
}

impl ObserverServer {
    /// Serves the observers' page at an address. Addresses other than localhost need a pairing code.
    ///
    /// # Errors
    /// The program cannot listen at the address.
    pub async fn open(listen: SocketAddr) -> io::Result<ObserverServer> {
        let (send, remarks) = channel(WAITING);
        let (newest, seen) = watch::channel(Arc::new(ScreenFrame::default()));
        let room = |door| ObserverRoom { door, remarks: send, newest: seen };
        let server = PageServer::open(listen, LIMITS, "observers", room).await?;
        Ok(ObserverServer { server, remarks, newest })
    }

    /// Shows a frame of the wizard's screen to the observers; never waits for them.
    pub fn show(&self, frame: ScreenFrame) {
        self.newest.send_replace(Arc::new(frame));
    }

    /// The next remark of an observer.
    pub async fn next(&mut self) -> Option<Remark> {
        self.remarks.recv().await
    }

    /// Tells observers whose remarks wait that nothing was recorded of them.
    pub fn refuse_waiting(&mut self) {
        while self.remarks.try_recv().is_ok() {}
    }

    /// URL of the observers' page, such as "http://127.0.0.1:50023".
    pub fn url(&self) -> String {
        self.server.url()
    }

    /// Pairing code that the observers' page asks for; `None` if no code is needed.
    pub fn code(&self) -> Option<&str> {
        self.server.code()
    }

    pub fn count(&self) -> ObserverCount {
        ObserverCount(self.server.door.clone())
    }
}

impl Drop for ObserverServer {
    fn drop(&mut self) {
        self.remarks.close();
        // Whoever waits for an answer is told that nothing is recorded any more.
        self.refuse_waiting();
        self.server.end();
    }
}
