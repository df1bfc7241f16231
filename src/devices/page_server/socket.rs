//! One connection of a page: its identification, its limits and its signs of life.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use serde::Serialize;
use tokio::time::{sleep_until, timeout};

use super::{PageDoor, Place, count, text};
use crate::pairing::PairingVerdict;

/// Time limit for the first message of a page.
const HELLO: Duration = Duration::from_secs(5);
/// Time after which a page that accepts no message is disconnected.
const STUCK: Duration = Duration::from_secs(5);
/// Largest number of pairing codes that a page may try in one connection.
const ATTEMPTS: u32 = 20;
/// Largest rate of messages from a page, per second (a pointer at 120 Hz, and presses).
const PER_SECOND: f64 = 300.0;
/// Number of malformed messages after which a page's connection is closed.
const FAULTS: u32 = 100;

/// What the connection has to know of a room's messages from its pages.
pub(crate) trait PageMessage: Sized {
    /// Parses a message; `None` if it is malformed.
    fn read(text: &str) -> Option<Self>;

    /// Name and pairing code of the page, if the message identifies it.
    fn hello(&self) -> Option<(&str, Option<&str>)>;

    /// Time on the page's clock, in milliseconds, and whether the page is hidden, if the message is a ping.
    fn ping(&self) -> Option<(f64, bool)>;
}

/// Messages that every room sends.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum SocketMessage {
    /// Answer to a page's ping: the time in the ping, and the server's time, both in milliseconds.
    Pong {
        t: f64,
        at: f64,
    },
    /// Result of pairing: "code" asks for the pairing code; "wrong" says that the code was wrong; "locked" says that
    /// the code was not checked, since too many wrong ones came before. The next code is checked after `wait_s`
    /// seconds. Other words are a room's.
    Pairing {
        why: &'static str,
        wait_s: u64,
    },
    Ended,
}

/// A page's WebSocket within the limits of its door.
pub(crate) struct PageSocket {
    socket: WebSocket,
    pub door: Arc<PageDoor>,
    pub place: Place,
    pub life: PageLife,
    faults: u32,
    /// Budget of messages that the page may still send (token bucket), with the time of the budget's last update.
    allowed: (f64, Instant),
}

impl PageSocket {
    pub(super) fn new(socket: WebSocket, door: Arc<PageDoor>, place: Place) -> PageSocket {
        let now = Instant::now();
        PageSocket { socket, door, place, life: PageLife::new(now), faults: 0, allowed: (PER_SECOND, now) }
    }

    /// Waits until the page has identified itself and, if a pairing code is required, sent the right code. `take` gets
    /// everything that the page says meanwhile, except pings; of an identification it can say why it is none, else an
    /// error is a malformed message. Returns the page's last identification.
    pub async fn identify<M: PageMessage>(
        &mut self,
        mut take: impl FnMut(&M) -> Result<(), &'static str>,
    ) -> Option<M> {
        let hello_by = tokio::time::Instant::now() + HELLO;
        let (mut hello, mut attempts) = (None, 0);
        // The typed code, and when it is checked.
        let mut typed: Option<(tokio::time::Instant, String)> = None;
        loop {
            let check_at = typed.as_ref().map_or(hello_by, |(at, _)| *at);
            let message = tokio::select! {
                biased;
                () = self.place.closed() => return None,
                said = self.socket.recv() => said?.ok()?,
                () = sleep_until(hello_by), if hello.is_none() => return None,
                () = sleep_until(check_at), if typed.is_some() => {
                    let (_, code) = typed.take()?;
                    let name = hello.as_ref().and_then(M::hello).map(|(name, _)| name.to_string())?;
                    if self.pair(&name, &code).await? {
                        return hello;
                    }
                    if attempts == ATTEMPTS {
                        return None;
                    }
                    continue;
                }
                () = sleep_until(self.life.next().into()) => {
                    self.keep_alive().await?;
                    continue;
                }
            };
            let Some(message) = self.read::<M>(message)? else { continue };
            if let Some((name, code)) = message.hello() {
                let refused = take(&message).err();
                match (self.door.has_code(), code, refused) {
                    (true, None, _) => self.ask("code").await?,
                    (_, _, Some(why)) => self.ask(why).await?,
                    (false, _, None) => return Some(message),
                    // One code at a time; codes beyond the limit are not even counted.
                    (true, Some(code), None) if typed.is_none() => {
                        attempts += 1;
                        let delay = self.door.pairing_delay(name, code);
                        typed = Some((tokio::time::Instant::now() + delay, code.to_string()));
                    }
                    (true, Some(_), None) => {}
                }
                hello = Some(message);
            } else if hello.is_none() {
                self.fault()?;
            } else if let Some((t, hidden)) = message.ping() {
                // A page that shows the form for the pairing code sends pings, too.
                self.pong(t, hidden).await?;
            } else if take(&message).is_err() {
                self.fault()?;
            }
        }
    }

    /// Asks the page for what its identification lacks.
    async fn ask(&mut self, why: &'static str) -> Option<()> {
        self.say(&SocketMessage::Pairing { why, wait_s: 0 }).await
    }

    /// Checks the page's pairing code, and tells the page if the code is wrong; returns whether the code is right.
    async fn pair(&mut self, page: &str, code: &str) -> Option<bool> {
        let (why, wait) = match self.door.pair(self.place.address, page, code) {
            PairingVerdict::Right => return Some(true),
            PairingVerdict::Wrong(wait) => ("wrong", wait),
            PairingVerdict::Locked(wait) => ("locked", wait),
        };
        count(&self.door.counts.refused);
        let wait_s = wait.as_secs_f64().ceil() as u64;
        self.say(&SocketMessage::Pairing { why, wait_s }).await?;
        Some(false)
    }

    /// Waits for the page's next WebSocket frame; `None` if the connection is closed.
    pub async fn hear(&mut self) -> Option<Message> {
        self.socket.recv().await?.ok()
    }

    /// Parses the page's message, if the WebSocket frame contains a message to be handled; an outer `None` ends the
    /// connection.
    pub fn read<M: PageMessage>(&mut self, message: Message) -> Option<Option<M>> {
        let now = Instant::now();
        self.life.heard(now, matches!(message, Message::Text(_)));
        self.place.heard(now);
        let text = match message {
            Message::Text(text) => text,
            Message::Binary(_) => return self.fault().map(|()| None),
            Message::Ping(_) | Message::Pong(_) => return Some(None),
            Message::Close(_) => return None,
        };
        if !self.is_allowed() {
            count(&self.door.counts.refused);
            return Some(None);
        }
        match M::read(&text) {
            None => self.fault().map(|()| None),
            message => Some(message),
        }
    }

    /// Whether a message is within the rate that hands and pointer can produce; messages beyond that rate are ignored
    /// for a while.
    fn is_allowed(&mut self) -> bool {
        let (allowed, since) = self.allowed;
        let now = Instant::now();
        let allowed = (allowed + PER_SECOND * now.duration_since(since).as_secs_f64()).min(PER_SECOND);
        self.allowed = (if allowed >= 1.0 { allowed - 1.0 } else { allowed }, now);
        allowed >= 1.0
    }

    /// Counts a malformed message; `None` if the page has sent too many of them.
    pub fn fault(&mut self) -> Option<()> {
        count(&self.door.counts.malformed);
        self.faults += 1;
        (self.faults < FAULTS).then_some(())
    }

    /// Sends a ping to the page; `None` if the page no longer responds.
    pub async fn keep_alive(&mut self) -> Option<()> {
        let now = Instant::now();
        if self.life.is_gone(now) {
            return None;
        }
        self.life.pinged = now;
        timeout(STUCK, self.socket.send(Message::Ping(Bytes::new()))).await.ok()?.ok()
    }

    /// Answers a page's ping.
    pub async fn pong(&mut self, t: f64, is_hidden: bool) -> Option<()> {
        self.life.is_hidden = is_hidden;
        self.say(&SocketMessage::Pong { t, at: self.door.now_ms() }).await
    }

    /// Tells the page that the program ends.
    pub async fn say_ended(&mut self) -> Option<()> {
        self.say(&SocketMessage::Ended).await
    }

    pub async fn say(&mut self, message: &impl Serialize) -> Option<()> {
        self.send(&text(message)).await
    }

    pub async fn send(&mut self, text: &str) -> Option<()> {
        let message = Message::Text(Utf8Bytes::from(text));
        timeout(STUCK, self.socket.send(message)).await.ok()?.ok()
    }
}

/// Interval of the server's pings to a page.
const PING: Duration = Duration::from_millis(500);
/// Silence of a page after which the session is told that it is lost; a visible page sends two messages per second.
const LOST: Duration = Duration::from_secs(2);
/// Silence of a browser (no answer to pings) after which its page counts as gone.
const SILENCE: Duration = Duration::from_secs(8);
/// Time without a message after which a visible page counts as hanging.
const VISIBLE: Duration = Duration::from_secs(8);
/// Time without a message after which a hidden page counts as hanging.
const HIDDEN: Duration = Duration::from_secs(90);

/// Times of a page's last signs of life.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PageLife {
    /// Arrival of the last WebSocket frame of any kind, answers to pings included.
    heard: Instant,
    /// Arrival of the last message that the page itself sent (not the browser).
    spoke: Instant,
    pinged: Instant,
    is_hidden: bool,
}

impl PageLife {
    /// Signs of life of a page that has just sent something.
    pub fn new(now: Instant) -> PageLife {
        PageLife { heard: now, spoke: now, pinged: now, is_hidden: false }
    }

    /// Records the arrival of a WebSocket frame; `is_message` says that the page itself sent it.
    pub fn heard(&mut self, now: Instant, is_message: bool) {
        self.heard = now;
        if is_message {
            self.spoke = now;
        }
    }

    /// Time of the server's next ping to the page, or of giving up the page.
    pub fn next(&self) -> Instant {
        (self.pinged + PING).min(self.gone_at())
    }

    /// Last sign of life of the page. A browser answers pings for a page that stands still, or whose connection it has
    /// given up, so of a visible page only its own messages count; the timers of a hidden page are slow.
    pub fn alive(&self) -> Instant {
        if self.is_hidden { self.heard } else { self.spoke }
    }

    /// Whether the page counts as lost, since it has been silent for too long.
    pub fn is_silent(&self, now: Instant) -> bool {
        now >= self.alive() + LOST
    }

    /// Whether the page has been silent for too long.
    pub fn is_gone(&self, now: Instant) -> bool {
        now >= self.gone_at()
    }

    fn gone_at(&self) -> Instant {
        let patience = if self.is_hidden { HIDDEN } else { VISIBLE };
        (self.heard + SILENCE).min(self.spoke + patience)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test: number of seconds, out of six hours, for which a page stays connected.
    fn stays_s(answers: bool, is_hidden: bool, message_s: u64) -> u64 {
        let start = Instant::now();
        let mut life = PageLife::new(start);
        life.is_hidden = is_hidden;
        let hours_s = 6 * 3600;
        let gone = (1..=hours_s).find(|second| {
            let now = start + Duration::from_secs(*second);
            if now >= life.next() && !life.is_gone(now) {
                life.pinged = now;
                if answers {
                    life.heard(now, false);
                }
            }
            if second % message_s == 0 {
                life.heard(now, true);
            }
            life.is_gone(now)
        });
        gone.unwrap_or(hours_s)
    }

    #[test]
    fn a_page_stays_for_hours_as_long_as_its_browser_answers_and_it_says_something() {
        let hours_s = 6 * 3600;
        assert_eq!(stays_s(true, false, 1), hours_s, "a visible page");
        assert_eq!(stays_s(true, true, 60), hours_s, "a hidden page, whose timers are slowed down");
        assert_eq!(stays_s(false, false, hours_s), 8, "a browser that is gone");
        assert_eq!(stays_s(true, false, hours_s), 8, "a visible page that hangs");
        let start = Instant::now();
        let mut life = PageLife::new(start);
        assert!(!life.is_silent(start + Duration::from_millis(1900)) && life.is_silent(start + LOST), "told soon");
        life.heard(start + LOST, false);
        assert!(life.is_silent(start + LOST), "a visible page that says nothing, whose browser answers");
        life.is_hidden = true;
        assert!(!life.is_silent(start + LOST), "a hidden page says something rarely");
        assert_eq!(stays_s(true, true, hours_s), 90, "a hidden page that hangs");
        assert_eq!(stays_s(false, true, 60), 8, "a hidden page whose browser is gone");
    }
}
