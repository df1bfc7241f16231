//! The desk at which a wizard sits: terminal, keys, tracker, and the signals that ask the program to end. It is taken
//! once, and every recording of a series is made at it.

use std::io;
use std::pin::Pin;

use tokio::sync::mpsc::Receiver;

use super::live::LiveError;
use crate::console::Message;
use crate::edge::gaze_json::{self, GazeLine};
use crate::edge::terminal::{Hands, Screen, asked_to_end, outlive_file_limits};
use crate::session::settings::{GazeSource, ParticipantSpec};

/// What the recordings of a series share.
pub(super) struct Desk {
    pub screen: Screen,
    hands: Hands,
    end: Pin<Box<dyn Future<Output = io::Result<()>>>>,
    /// Lines of the tracker's program, if the gaze comes from one.
    gaze: Option<Receiver<GazeLine>>,
}

impl Desk {
    /// Opens the devices that this participant needs, and takes the terminal.
    ///
    /// # Errors
    /// There is no terminal, or nothing can listen for gaze.
    pub async fn take(participant: &ParticipantSpec) -> Result<Desk, LiveError> {
        outlive_file_limits().map_err(LiveError::Terminal)?;
        let gaze = match (participant.gaze, participant.gaze_port) {
            (GazeSource::Json, port) => {
                Some(gaze_json::listen(port).await.map_err(|reason| LiveError::Gaze { port, reason })?)
            }
            _ => None,
        };
        let screen = Screen::take(participant.gaze == GazeSource::Mouse).map_err(LiveError::Terminal)?;
        Ok(Desk { screen, hands: Hands::default(), end: Box::pin(asked_to_end()), gaze })
    }

    /// What comes in next; nothing if the program has to end, because it is asked to or because the terminal is gone.
    pub async fn next(&mut self) -> Option<Arrival> {
        tokio::select! {
            biased;
            _ = &mut self.end => None,
            message = self.hands.next() => message.map(Arrival::Message),
            Some(line) = receive(&mut self.gaze) => Some(Arrival::Gaze(line)),
        }
    }
}

/// Something that comes in at the desk.
pub(super) enum Arrival {
    Message(Message),
    Gaze(GazeLine),
}

/// The next line of the gaze input; never, if there is none.
async fn receive(gaze: &mut Option<Receiver<GazeLine>>) -> Option<GazeLine> {
    match gaze {
        Some(lines) => lines.recv().await,
        None => std::future::pending().await,
    }
}
