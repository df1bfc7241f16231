//! The participant's wall display: a page in a browser, served by a thread of its own, so that connections cannot delay
//! the session.
//!
//! The page receives the scene (fixed layout) and the state as JSON over a WebSocket, and sends presses, answers and
//! the pointer. One page takes part (its inputs count), all others watch.

mod connection;
pub mod message;
mod server_state;

pub use message::{PageInput, ParticipantResponse};
pub use server_state::{ActivePage, DisplayCounts};

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};

use tokio::sync::mpsc::{Receiver, channel};
use tokio::sync::watch;

use self::message::MessageToPage;
use self::server_state::{DisplayStatus, LIMITS, PageFeed, ServerState};
use crate::page_server::{PageDoor, PageServer, text};
use crate::sight::page_language::DisplayWords;
use crate::sight::{DisplayContent, DisplayScene, RobotHandPose};

/// Largest number of page inputs that wait for the session.
const WAITING: usize = 1024;

/// Server of the participant's display: its address and its inputs. Dropping the value tells the pages that the program
/// ends, and stops the server.
pub struct DisplayServer {
    server: PageServer,
    inputs: Receiver<PageInput>,
    screen: DisplayHandle,
}

/// Handle with which the program sends content to all pages of the display and reads their counters.
#[derive(Clone)]
pub struct DisplayHandle {
    scene: watch::Sender<Arc<str>>,
    sight: watch::Sender<Arc<str>>,
    robot: watch::Sender<Arc<str>>,
    status: Arc<DisplayStatus>,
    door: Arc<PageDoor>,
}

impl DisplayServer {
    /// Serves the participant's page at an address, with the page's texts `words`. Addresses other than localhost need
    /// a pairing code.
    ///
    /// # Errors
    /// The program cannot listen at the address.
    pub async fn open(listen: IpAddr, port: u16, words: &DisplayWords) -> io::Result<DisplayServer> {
        let (send, inputs) = channel(WAITING);
        let status = Arc::new(DisplayStatus::default());
        let feed = || watch::Sender::new(Arc::<str>::from(""));
        let (scene, sight, robot) = (feed(), feed(), feed());
        let told = PageFeed { scene: scene.subscribe(), sight: sight.subscribe(), robot: robot.subscribe() };
        let (shared, words) = (status.clone(), words.of_page());
        let room =
            |door| ServerState { door, words, inputs: send, told, status: shared, acting: watch::Sender::new(None) };
        let server = PageServer::open(SocketAddr::new(listen, port), LIMITS, "display", room).await?;
        let screen = DisplayHandle { scene, sight, robot, status, door: server.door.clone() };
        Ok(DisplayServer { server, inputs, screen })
    }

    pub async fn next(&mut self) -> Option<PageInput> {
        self.inputs.recv().await
    }

    /// URL of the participant's page, such as "http://127.0.0.1:50022"; for a wildcard address, with this machine's
    /// address in the network.
    pub fn url(&self) -> String {
        self.server.url()
    }

    /// Pairing code that the participant's page asks for; `None` if no code is needed.
    pub fn code(&self) -> Option<&str> {
        self.server.code()
    }

    pub fn screen(&self) -> DisplayHandle {
        self.screen.clone()
    }
}

impl Drop for DisplayServer {
    fn drop(&mut self) {
        self.inputs.close();
        self.server.end();
    }
}

impl DisplayHandle {
    /// Sends a new scene (the fixed layout of kitchen and page) to the pages.
    pub fn build(&self, scene: &DisplayScene) {
        self.scene.send_replace(text(&MessageToPage::Scene { scene }));
    }

    /// Sends to the pages what the display shows now, with the time in seconds that a probe or the trial still has.
    pub fn show(&self, sight: &DisplayContent, left_s: Option<f64>) {
        let at = left_s.map(|_| self.door.now_ms());
        self.sight.send_replace(text(&MessageToPage::Sight { sight, at, left_s }));
    }

    pub fn move_robot(&self, robot: &RobotHandPose) {
        self.robot.send_replace(text(&MessageToPage::Robot { robot }));
    }

    pub fn counts(&self) -> DisplayCounts {
        let page = *self.status.lock().unwrap_or_else(PoisonError::into_inner);
        let counts = &self.door.counts;
        DisplayCounts {
            page,
            watching: counts.pages.load(Ordering::Relaxed).saturating_sub(u64::from(page.is_some())),
            malformed: counts.malformed.load(Ordering::Relaxed),
            refused: counts.refused.load(Ordering::Relaxed),
        }
    }
}
