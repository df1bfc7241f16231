//! The desk at which a wizard sits: terminal, keys, tracker, and the signals that ask the program to end. It is taken
//! once, and every recording of a series is made at it.

use std::io;
use std::pin::Pin;
use std::time::Duration;

use tokio::sync::mpsc::Receiver;
use tokio::time::sleep;

use super::live::LiveError;
use crate::console::Message;
use crate::console::question::{Question, Reply};
use crate::console::view::theme::Theme;
use crate::edge::display::{Display, PageInput};
use crate::edge::gaze_json::{self, GazeLine};
use crate::edge::terminal::{Hands, Screen, asked_to_end, outlive_file_limits, theme};
use crate::session::SessionSpec;
use crate::session::display::DisplaySpec;
use crate::session::settings::{GazeSource, ParticipantKind};

/// A question is drawn so often.
const REDRAW: Duration = Duration::from_millis(100);

/// What the recordings of a series share.
pub(super) struct Desk {
    pub screen: Screen,
    theme: Theme,
    pub seat: Seat,
    pub tracker: Tracker,
    pub wall: Wall,
}

/// Whoever sits there, and what asks the program to end.
pub(super) struct Seat {
    hands: Hands,
    end: Pin<Box<dyn Future<Output = io::Result<()>>>>,
}

/// The participant's display, if the participant is at one.
pub(super) struct Wall(Option<Display>);

/// Lines of the tracker's program, if the gaze comes from one.
pub(super) struct Tracker(Option<Receiver<GazeLine>>);

impl Desk {
    /// Opens the devices that these settings need, and takes the terminal.
    ///
    /// # Errors
    /// There is no terminal, or nothing can listen for gaze.
    pub async fn take(spec: &SessionSpec) -> Result<Desk, LiveError> {
        let participant = &spec.participant;
        outlive_file_limits().map_err(LiveError::Terminal)?;
        let gaze = match (participant.gaze, participant.gaze_port) {
            (GazeSource::Json, port) => {
                Some(gaze_json::listen(port).await.map_err(|reason| LiveError::Gaze { port, reason })?)
            }
            _ => None,
        };
        let wall = match (participant.kind, &spec.display) {
            (ParticipantKind::Display, DisplaySpec { listen, port, .. }) => {
                let opened = Display::open(*listen, *port).await;
                Some(opened.map_err(|reason| LiveError::Display { address: *listen, port: *port, reason })?)
            }
            _ => None,
        };
        let screen = Screen::take().map_err(LiveError::Terminal)?;
        let theme = theme(&spec.console, screen.ground);
        let seat = Seat { hands: Hands::default(), end: Box::pin(asked_to_end()) };
        Ok(Desk { screen, theme, seat, tracker: Tracker(gaze), wall: Wall(wall) })
    }

    /// Asks before a recording begins; the place of the answer, nothing if the program is to be left.
    ///
    /// # Errors
    /// The terminal is gone.
    pub async fn ask(&mut self, question: &Question) -> Result<Option<usize>, LiveError> {
        loop {
            self.screen.ask(question, self.theme).map_err(LiveError::Terminal)?;
            let message = tokio::select! {
                biased;
                message = self.seat.next() => message,
                // Read all the same, or it would be read later as if it had just come.
                Some(_) = self.tracker.next() => continue,
                Some(_) = self.wall.next() => continue,
                // A terminal that was still busy with a frame gets the question now.
                () = sleep(REDRAW) => continue,
            };
            match message {
                Some(Message::Key(key)) => match question.reply(&key) {
                    Some(Reply::Answer(index)) => return Ok(Some(index)),
                    Some(Reply::Leave) => return Ok(None),
                    None => {}
                },
                Some(_) => {}
                None => return Ok(None),
            }
            if self.screen.is_lost() {
                return Ok(None);
            }
        }
    }
}

impl Seat {
    /// What comes in next; nothing if the program has to end, because it is asked to or because the terminal is gone.
    pub async fn next(&mut self) -> Option<Message> {
        tokio::select! {
            biased;
            _ = &mut self.end => None,
            message = self.hands.next() => message,
        }
    }
}

impl Wall {
    pub fn display(&self) -> Option<&Display> {
        self.0.as_ref()
    }

    /// The next input of the participant's page; never, if there is none.
    pub async fn next(&mut self) -> Option<PageInput> {
        match &mut self.0 {
            Some(display) => display.next().await,
            None => std::future::pending().await,
        }
    }
}

impl Tracker {
    /// The next line of the gaze input; never, if there is none.
    pub async fn next(&mut self) -> Option<GazeLine> {
        match &mut self.0 {
            Some(lines) => lines.recv().await,
            None => std::future::pending().await,
        }
    }
}
