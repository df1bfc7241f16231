//! The participant's wall display: a page in a browser, served by a thread of its own, so that connections cannot delay
//! the session.
//!
//! The page receives the scene (fixed layout) and the state as JSON over a WebSocket, and sends presses, answers and
//! the pointer. One page takes part (its inputs count), all others watch.

mod connection;
pub mod message;
mod server;
mod server_state;

pub use message::{PageInput, ParticipantResponse};
pub use server_state::{ActivePage, DisplayCounts};

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Instant;

use tokio::net::TcpListener;
use tokio::sync::mpsc::{Receiver, channel};
use tokio::sync::watch;

use self::server::serve;
use self::server_state::{DisplayStatus, PageFeed, ServerState};
use crate::outer_address::reachable;
use crate::pairing::pairing_code;
use crate::sight::page_language::DisplayWords;
use crate::sight::{DisplayContent, DisplayScene, RobotHandPose};

/// Largest number of page inputs that wait for the session.
const WAITING: usize = 1024;

/// Server of the participant's display: its address and its inputs. Dropping the value tells the pages that the program
/// ends, and stops the server.
pub struct DisplayServer {
    address: SocketAddr,
    code: Option<String>,
    inputs: Receiver<PageInput>,
    screen: DisplayHandle,
    thread: Option<JoinHandle<io::Result<()>>>,
}

/// Handle with which the program sends content to all pages of the display and reads their counters.
#[derive(Clone)]
pub struct DisplayHandle {
    scene: watch::Sender<Arc<str>>,
    sight: watch::Sender<Arc<str>>,
    robot: watch::Sender<Arc<str>>,
    status: Arc<DisplayStatus>,
    began: Instant,
}

impl DisplayServer {
    /// Serves the participant's page at an address, with the page's texts `words`. Addresses other than localhost need
    /// a pairing code.
    ///
    /// # Errors
    /// The program cannot listen at the address.
    pub async fn open(listen: IpAddr, port: u16, words: &DisplayWords) -> io::Result<DisplayServer> {
        let listener = TcpListener::bind((listen, port)).await?;
        let address = listener.local_addr()?;
        let listener = listener.into_std()?;
        let code = (!listen.is_loopback()).then(pairing_code);
        let (send, inputs) = channel(WAITING);
        let status = Arc::new(DisplayStatus::default());
        let screen = DisplayHandle {
            scene: watch::Sender::new(Arc::from("")),
            sight: watch::Sender::new(Arc::from("")),
            robot: watch::Sender::new(Arc::from("")),
            status: status.clone(),
            began: Instant::now(),
        };
        let told = PageFeed {
            scene: screen.scene.subscribe(),
            sight: screen.sight.subscribe(),
            robot: screen.robot.subscribe(),
        };
        let hub = ServerState::new(code.clone(), words.of_page(), send, (told, status), screen.began);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let thread = std::thread::Builder::new().name("display".to_string());
        let thread = Some(thread.spawn(move || runtime.block_on(serve(listener, hub)))?);
        Ok(DisplayServer { address, code, inputs, screen, thread })
    }

    pub async fn next(&mut self) -> Option<PageInput> {
        self.inputs.recv().await
    }

    /// URL of the participant's page, such as "http://127.0.0.1:50022"; for a wildcard address, with this machine's
    /// address in the network.
    pub fn url(&self) -> String {
        format!("http://{}", reachable(self.address))
    }

    /// Pairing code that the participant's page asks for; `None` if no code is needed.
    pub fn code(&self) -> Option<&str> {
        self.code.as_deref()
    }

    pub fn screen(&self) -> DisplayHandle {
        self.screen.clone()
    }
}

impl Drop for DisplayServer {
    fn drop(&mut self) {
        self.inputs.close();
        // The server takes half a second at most to tell its pages; without waiting, the process would end before that.
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl DisplayHandle {
    /// Sends a new scene (the fixed layout of kitchen and page) to the pages.
    pub fn build(&self, scene: &DisplayScene) {
        self.scene.send_replace(message::scene(scene));
    }

    /// Sends to the pages what the display shows now, with the time in seconds that a probe or the trial still has.
    pub fn show(&self, sight: &DisplayContent, left_s: Option<f64>) {
        let at_ms = self.began.elapsed().as_secs_f64() * 1000.0;
        self.sight.send_replace(message::sight(sight, left_s.map(|left_s| (at_ms, left_s))));
    }

    pub fn move_robot(&self, pose: &RobotHandPose) {
        self.robot.send_replace(message::robot(pose));
    }

    pub fn counts(&self) -> DisplayCounts {
        self.status.counts()
    }
}
