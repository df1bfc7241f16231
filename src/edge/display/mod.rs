//! The participant's wall display: a page in a browser, served on a thread of its own, so that whatever connects there
//! delays no session, and no session a page.
//!
//! The page is told the scene and the whole sight, as JSON over a WebSocket; it tells presses, answers, the pointer. One page
//! acts, all others watch.

mod code;
mod connection;
mod host_check;
mod message;
mod page_input;
mod page_life;
mod pairing;
mod server;
mod server_state;
mod status;

use std::io;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::sync::Arc;

use tokio::net::TcpListener;
use tokio::sync::mpsc::{Receiver, channel};
use tokio::sync::watch;

pub use self::page_input::PageInput;
use self::server::serve;
use self::server_state::ServerState;
use self::status::DisplayStatus;
pub use self::status::{ActivePage, DisplayCounts};
use crate::display::words::DisplayWords;
use crate::display::{DisplayScene, DisplayUpdate};

/// So many inputs of the page may wait to be taken.
const WAITING: usize = 1024;

/// The display, as a session has it: where it is served, and what comes from it. It is served until this is dropped.
pub struct Display {
    address: SocketAddr,
    code: Option<String>,
    inputs: Receiver<PageInput>,
    screen: PageScreen,
}

/// What the pages show, and how they are; copies are about the same pages.
#[derive(Clone)]
pub struct PageScreen {
    scene: watch::Sender<Arc<str>>,
    sight: watch::Sender<Arc<str>>,
    status: Arc<DisplayStatus>,
}

impl Display {
    /// Serves the page at this address, in these words. What is not localhost asks for a pairing code.
    ///
    /// # Errors
    /// The address cannot be listened on.
    pub async fn open(listen: IpAddr, port: u16, words: &DisplayWords) -> io::Result<Display> {
        let listener = TcpListener::bind((listen, port)).await?;
        let address = listener.local_addr()?;
        let listener = listener.into_std()?;
        let code = (!listen.is_loopback()).then(code::pairing_code);
        let (send, inputs) = channel(WAITING);
        let status = Arc::new(DisplayStatus::default());
        let screen = PageScreen {
            scene: watch::Sender::new(Arc::from("")),
            sight: watch::Sender::new(Arc::from("")),
            status: status.clone(),
        };
        let hub = ServerState::new(
            code.clone(),
            words.of_page(),
            send,
            screen.scene.subscribe(),
            screen.sight.subscribe(),
            status,
        );
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        std::thread::Builder::new()
            .name("display".to_string())
            .spawn(move || runtime.block_on(serve(listener, hub)))?;
        Ok(Display { address, code, inputs, screen })
    }

    /// The next input of the page that acts.
    pub async fn next(&mut self) -> Option<PageInput> {
        self.inputs.recv().await
    }

    /// Where the page is: "http://127.0.0.1:50022". Where every address of this machine is listened on, the one that the
    /// network knows it by.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if let (true, Some(known)) = (address.ip().is_unspecified(), address_outside(address.ip())) {
            address.set_ip(known);
        }
        format!("http://{address}")
    }

    /// What the page asks for, if the network reaches it.
    pub fn code(&self) -> Option<&str> {
        self.code.as_deref()
    }

    /// What the pages show.
    pub fn screen(&self) -> PageScreen {
        self.screen.clone()
    }
}

/// The address from which this machine would send into the network; nothing is sent (the addresses are those kept for
/// documentation, RFC 5737 and 3849).
fn address_outside(any: IpAddr) -> Option<IpAddr> {
    let elsewhere: IpAddr = match any {
        IpAddr::V4(_) => Ipv4Addr::new(192, 0, 2, 1).into(),
        IpAddr::V6(_) => Ipv6Addr::new(0x2001, 0xdb8, 0, 0, 0, 0, 0, 1).into(),
    };
    let socket = UdpSocket::bind((any, 0)).ok()?;
    socket.connect((elsewhere, 9)).ok()?;
    socket.local_addr().ok().map(|address| address.ip())
}

impl PageScreen {
    /// Builds the pages anew.
    pub fn build(&self, scene: &DisplayScene) {
        self.scene.send_replace(message::scene(scene));
    }

    /// Shows what the participant may see now.
    pub fn show(&self, sight: &DisplayUpdate) {
        self.sight.send_replace(message::sight(sight));
    }

    /// How the pages are.
    pub fn counts(&self) -> DisplayCounts {
        self.status.counts()
    }
}
