//! The observers' page of the wizard's screen at the operator's station.

use std::net::SocketAddr;

use ratatui::CompletedFrame;

use crate::console::preflight::ObserverStatus;
use crate::console::view::theme::Theme;
use crate::run::error::LiveError;
use crate::run::event_loop::or_never;
use crate::run::screen_frame::frame_of;
pub(in crate::run) use tomcom_devices::observers::Remark;
use tomcom_devices::observers::{MOST_OBSERVERS, ObserverServer};

/// The server of the observers' page, if the program was started with one.
#[derive(Default)]
pub(in crate::run) struct StationObservers(Option<ObserverServer>);

impl StationObservers {
    /// Starts the server of the observers' page at this address, if there is one.
    ///
    /// # Errors
    /// The address cannot be opened.
    pub async fn open(address: Option<SocketAddr>) -> Result<StationObservers, LiveError> {
        let Some(at) = address else { return Ok(StationObservers(None)) };
        let opened = ObserverServer::open(at).await;
        opened.map(|server| StationObservers(Some(server))).map_err(|reason| LiveError::Observers { at, reason })
    }

    /// Shows the frame that was drawn to the observers.
    pub fn show(&self, drawn: &CompletedFrame<'_>, theme: Theme) {
        if let Some(server) = &self.0 {
            server.show(frame_of(drawn.buffer, theme.ground));
        }
    }

    /// Waits for the next remark of an observer; waits forever if there are no observers.
    pub async fn next(&mut self) -> Option<Remark> {
        or_never(self.0.as_mut().map(ObserverServer::next)).await
    }

    /// Drops the remarks that came before the shell that now begins: nobody records them any more.
    pub fn refuse_waiting(&mut self) {
        if let Some(server) = &mut self.0 {
            server.refuse_waiting();
        }
    }

    /// What tells the state of the observers' page to the wizard; `None` if there is no such page.
    pub fn status(&self) -> Option<Box<dyn Fn() -> ObserverStatus>> {
        let server = self.0.as_ref()?;
        let (url, code, count) = (server.url(), server.code().map(str::to_string), server.count());
        Some(Box::new(move || ObserverStatus {
            url: url.clone(),
            code: code.clone(),
            watching: count.watching(),
            most: MOST_OBSERVERS as u64,
        }))
    }
}
