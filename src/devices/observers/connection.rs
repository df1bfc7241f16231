//! One connection of an observer's page: frames to it, remarks from it.

use std::future::pending;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::ws::Message;
use serde::{Deserialize, Serialize};
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::oneshot;
use tokio::time::sleep_until;

use super::{MOST_OBSERVERS, ObserverRoom, Remark, ScreenFrame};
use crate::page_server::{PageMessage, PageSocket, count};
use tomcom_session::person_code;

/// Longest remark, in characters.
const MAX_REMARK: usize = 500;
/// Longest name of a page, code of an observer, or pairing code, in bytes.
const MAX_TEXT: usize = 64;
/// Least time between two remarks of an observer.
const BETWEEN: Duration = Duration::from_secs(1);

/// A message from an observer's page.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum MessageFromObserver {
    /// First message of a page, with which it identifies itself.
    Hello {
        page: String,
        /// Code of the observer; empty if it is not known yet.
        observer: String,
        code: Option<String>,
    },
    Ping {
        /// Time on the page's clock, in milliseconds.
        t: f64,
        #[serde(default)]
        hidden: bool,
    },
    Remark {
        /// Number of the remark among all remarks of this page.
        number: u64,
        note: String,
    },
}

impl PageMessage for MessageFromObserver {
    fn read(text: &str) -> Option<MessageFromObserver> {
        let message: MessageFromObserver = serde_json::from_str(text).ok()?;
        let is_fine = match &message {
            MessageFromObserver::Hello { page, observer, code } => {
                !page.is_empty()
                    && [Some(page), Some(observer), code.as_ref()].into_iter().flatten().all(|text| is_short(text))
            }
            MessageFromObserver::Ping { t, .. } => t.is_finite() && t.abs() < 1e13,
            MessageFromObserver::Remark { note, .. } => {
                !note.trim().is_empty() && note.chars().count() <= MAX_REMARK && !note.chars().any(char::is_control)
            }
        };
        is_fine.then_some(message)
    }

    fn hello(&self) -> Option<(&str, Option<&str>)> {
        match self {
            MessageFromObserver::Hello { page, code, .. } => Some((page, code.as_deref())),
            _ => None,
        }
    }

    fn ping(&self) -> Option<(f64, bool)> {
        match self {
            MessageFromObserver::Ping { t, hidden } => Some((*t, *hidden)),
            _ => None,
        }
    }
}

fn is_short(text: &str) -> bool {
    text.len() <= MAX_TEXT && !text.chars().any(char::is_control)
}

/// A message to an observer's page other than a frame.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum MessageToObserver<'a> {
    /// The page is let in, as this observer.
    Welcome { observer: &'a str },
    /// So many observers watch already that this one is refused.
    Full { most: usize },
    /// Whether the remark with this number is in the recording; else why not.
    Remark { number: u64, refused: Option<String> },
}

/// An observer whose page is let in.
struct Observer<'a> {
    socket: PageSocket,
    room: &'a ObserverRoom,
    code: String,
    /// The frame that the page shows.
    shown: Option<Arc<ScreenFrame>>,
    /// The remark, by its number, whose answer the page waits for.
    asked: Option<(u64, oneshot::Receiver<Result<(), String>>)>,
    /// When the page sent its last remark.
    remarked: Option<Instant>,
}

/// Serves an observer's page until one side closes the connection.
pub(super) async fn serve_observer(mut socket: PageSocket, room: &ObserverRoom) {
    let hello = socket.identify(|message| match message {
        MessageFromObserver::Hello { observer, .. } if person_code::fault(observer).is_none() => Ok(()),
        MessageFromObserver::Hello { .. } => Err("observer"),
        _ => Err("unexpected"),
    });
    let Some(MessageFromObserver::Hello { observer: code, .. }) = hello.await else { return };
    if !socket.place.admit() {
        count(&room.door.counts.refused);
        let _ = socket.say(&MessageToObserver::Full { most: MOST_OBSERVERS }).await;
        return;
    }
    room.door.counts.pages.fetch_add(1, Ordering::Relaxed);
    let mut observer = Observer { socket, room, code, shown: None, asked: None, remarked: None };
    observer.run().await;
    room.door.counts.pages.fetch_sub(1, Ordering::Relaxed);
}

impl Observer<'_> {
    /// Sends what changes on the wizard's screen, and handles the page's messages.
    async fn run(&mut self) -> Option<()> {
        self.socket.say(&MessageToObserver::Welcome { observer: &self.code }).await?;
        let (mut newest, remarks) = (self.room.newest.clone(), self.room.remarks.clone());
        let place = self.socket.place.clone();
        newest.mark_changed();
        loop {
            let next_sign = self.socket.life.next().into();
            tokio::select! {
                biased;
                () = place.closed() => return None,
                answer = answered(&mut self.asked) => {
                    let number = self.asked.take().map_or(0, |(number, _)| number);
                    self.answer(number, answer.err()).await?;
                }
                () = remarks.closed() => {
                    self.socket.say_ended().await?;
                    return None;
                }
                said = self.socket.hear() => self.take(said?).await?,
                changed = newest.changed() => {
                    changed.ok()?;
                    // While it is sent, the console goes on: the next frame to be sent is the newest one then.
                    let frame = newest.borrow_and_update().clone();
                    if let Some(change) = frame.since(self.shown.as_ref()) {
                        self.socket.say(&change).await?;
                    }
                    self.shown = Some(frame);
                }
                () = sleep_until(next_sign) => self.socket.keep_alive().await?,
            }
        }
    }

    async fn take(&mut self, message: Message) -> Option<()> {
        match self.socket.read(message)? {
            None => Some(()),
            Some(MessageFromObserver::Ping { t, hidden }) => self.socket.pong(t, hidden).await,
            Some(MessageFromObserver::Remark { number, note }) => self.remark(number, note).await,
            Some(MessageFromObserver::Hello { .. }) => self.socket.fault(),
        }
    }

    /// Passes a remark on to the session, which answers it.
    async fn remark(&mut self, number: u64, note: String) -> Option<()> {
        let now = Instant::now();
        let is_fast = self.remarked.replace(now).is_some_and(|last| now < last + BETWEEN);
        if is_fast || self.asked.is_some() {
            return self.answer(number, Some("one remark in a second, please: send it again".to_string())).await;
        }
        let (answer, asked) = oneshot::channel();
        let remark = Remark { observer: self.code.clone(), note: note.trim().to_string(), answer };
        match self.room.remarks.try_send(remark) {
            Ok(()) => {
                self.asked = Some((number, asked));
                Some(())
            }
            Err(TrySendError::Full(_)) => {
                self.answer(number, Some("too many remarks wait: send it again".to_string())).await
            }
            Err(TrySendError::Closed(_)) => self.answer(number, Some(NOT_NOW.to_string())).await,
        }
    }

    async fn answer(&mut self, number: u64, refused: Option<String>) -> Option<()> {
        self.socket.say(&MessageToObserver::Remark { number, refused }).await
    }
}

/// Why a remark is in no recording if nobody answered it.
const NOT_NOW: &str = "nothing is recorded now: send it again once a recording has begun";

/// Waits until the session has answered the remark that waits, if one does.
async fn answered(asked: &mut Option<(u64, oneshot::Receiver<Result<(), String>>)>) -> Result<(), String> {
    match asked {
        Some((_, answer)) => answer.await.unwrap_or_else(|_| Err(NOT_NOW.to_string())),
        None => pending().await,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_message_of_an_observer_is_refused() {
        let read = MessageFromObserver::read;
        assert!(read(r#"{"kind": "hello", "page": "a1", "observer": "", "code": null}"#).is_some());
        assert!(read(r#"{"kind": "ping", "t": 12.5, "hidden": true}"#).is_some());
        assert!(read(r#"{"kind": "remark", "number": 1, "note": "Looks at the pot."}"#).is_some());
        let long = format!(r#"{{"kind": "remark", "number": 1, "note": "{}"}}"#, "x".repeat(MAX_REMARK + 1));
        for wrong in [
            "",
            "[]",
            r#"{"kind": "hello", "page": "", "observer": "O1", "code": null}"#,
            r#"{"kind": "hello", "page": "a", "width": 800, "height": 600, "code": null}"#,
            r#"{"kind": "remark", "number": 1, "note": "  "}"#,
            r#"{"kind": "remark", "number": 1, "note": "two\nlines"}"#,
            r#"{"kind": "remark", "number": 1, "note": "a", "observer": "W1"}"#,
            r#"{"kind": "press", "number": 1, "button": "cut", "at": 12.5}"#,
            r#"{"kind": "take_part"}"#,
            &long,
        ] {
            assert_eq!(read(wrong), None, "{wrong}");
        }
    }
}
