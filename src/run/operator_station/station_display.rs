//! The participant's display at the operator's station.

use std::time::Instant;

use crate::console::preflight::ParticipantDisplayHealth;
use crate::run::error::LiveError;
use crate::run::event_loop::or_never;
use tomcom_core::base::time::SessionTime;
pub(in crate::run) use tomcom_devices::display::PageInput;
use tomcom_devices::display::{DisplayHandle, DisplayServer, ParticipantResponse};
use tomcom_devices::sight::page_language::DisplayWords;
use tomcom_devices::sight::{ConsentHold, consent_sight, scene, sight};
use tomcom_session::settings::ParticipantKind;
use tomcom_session::{Session, SessionSpec};

/// The server of the participant's display, if the session has one.
#[derive(Default)]
pub(in crate::run) struct StationDisplay(Option<DisplayServer>);

impl StationDisplay {
    /// Starts the server of the participant's display, if the session has a display.
    ///
    /// # Errors
    /// The network address of the display's server cannot be opened.
    pub async fn open(spec: &SessionSpec) -> Result<StationDisplay, LiveError> {
        if spec.participant.kind != ParticipantKind::Display {
            return Ok(StationDisplay(None));
        }
        let (address, port) = (spec.display.listen, spec.display.port);
        let opened = DisplayServer::open(address, port, &DisplayWords::for_display(&spec.display)).await;
        opened.map(|display| StationDisplay(Some(display))).map_err(|reason| LiveError::Display {
            address,
            port,
            reason,
        })
    }

    /// What shows content on the participant's display; `None` if the session has no display.
    pub fn screen(&self) -> Option<DisplayHandle> {
        self.0.as_ref().map(DisplayServer::screen)
    }

    /// State of the participant's display for the wizard, before a page is connected; `None` if the session has no display.
    pub fn health(&self) -> Option<ParticipantDisplayHealth> {
        self.0.as_ref().map(|display| ParticipantDisplayHealth {
            url: display.url(),
            code: display.code().map(str::to_string),
            ..ParticipantDisplayHealth::default()
        })
    }

    /// A function that says, whenever it is called, what is to be opened, while no page is connected.
    pub fn missing_page(&self) -> Box<dyn Fn() -> Option<String>> {
        let Some((health, screen)) = self.health().zip(self.screen()) else { return Box::new(|| None) };
        Box::new(move || health.missing().filter(|_| screen.counts().page.is_none()))
    }

    /// Lets the participant's page welcome a participant before the recording, or ask for consent to `text`; returns
    /// whether it asks. A page that stayed open thanks the participant before.
    pub fn welcome(&self, session: &Session, text: Option<&str>) -> bool {
        let screen = self.screen();
        if let Some(screen) = &screen {
            screen.build(&scene(session));
            screen.show(&text.map_or_else(|| sight(session), |text| consent_sight(session, text)), None);
        }
        text.is_some() && screen.is_some()
    }

    /// Waits for the next input of the participant's page; waits forever if there is no page.
    pub async fn next(&mut self) -> Option<PageInput> {
        or_never(self.0.as_mut().map(DisplayServer::next)).await
    }
}

/// When the page that took part was last heard of, if the input says that it is lost.
pub(in crate::run) fn lost_since(input: &PageInput) -> Option<Instant> {
    match input {
        PageInput::Lost { since } => Some(*since),
        _ => None,
    }
}

/// Handles an input of the participant's page while it asks for consent; returns what the wizard is told of it.
pub(in crate::run) fn take_consent_input(
    input: &PageInput,
    button: &mut ConsentHold,
    now: SessionTime,
) -> Option<&'static str> {
    match input {
        PageInput::Reply(ParticipantResponse::Hold { held }) => button.hold(*held, now),
        PageInput::Reply(ParticipantResponse::Consent) if !button.tell(now) => {
            return Some("the page sent a consent, but its button was not held long enough: not counted");
        }
        PageInput::Reply(ParticipantResponse::Decline) => {
            return Some("the participant chose \"I do not agree\" on the display: talk with them, then answer here");
        }
        // The button of another page, or of one that was loaded again, is not held.
        PageInput::Connected { .. } | PageInput::Lost { .. } => *button = ConsentHold::default(),
        _ => {}
    }
    None
}
