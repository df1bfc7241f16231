//! The participant's display at the desk.

use crate::display::page_language::DisplayWords;
use crate::edge::display::Display;
pub(in crate::run) use crate::edge::display::PageInput;
use crate::run::error::LiveError;
use crate::session::SessionSpec;
use crate::session::settings::ParticipantKind;

/// The participant's display, if the session has one.
#[derive(Default)]
pub(in crate::run) struct WallDisplay(Option<Display>);

impl WallDisplay {
    /// Starts the server of the display, if the session has one.
    ///
    /// # Errors
    /// The address cannot be opened.
    pub async fn open(spec: &SessionSpec) -> Result<WallDisplay, LiveError> {
        if spec.participant.kind != ParticipantKind::Display {
            return Ok(WallDisplay(None));
        }
        let (address, port) = (spec.display.listen, spec.display.port);
        let opened = Display::open(address, port, &DisplayWords::for_display(&spec.display)).await;
        opened.map(|display| WallDisplay(Some(display))).map_err(|reason| LiveError::Display { address, port, reason })
    }

    /// The display.
    pub fn display(&self) -> Option<&Display> {
        self.0.as_ref()
    }

    /// Waits for the next input of the participant's page; forever if there is none.
    pub async fn next(&mut self) -> Option<PageInput> {
        match &mut self.0 {
            Some(display) => display.next().await,
            None => std::future::pending().await,
        }
    }
}
