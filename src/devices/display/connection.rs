//! One network connection of a participant page. The page identifies itself, and then either takes part (its inputs
//! count) or only watches.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use tokio::sync::watch;
use tokio::time::{sleep_until, timeout};

use super::message::{MessageFromPage, MessageToPage, PageInput, read, text};
use super::server_state::{ActivePage, PageFeed, ServerState, count};
use crate::connection_table::ConnectionHandle;
use crate::pairing::PairingVerdict;

/// Time limit for the first message of a participant page.
const HELLO: Duration = Duration::from_secs(5);
/// Time after which a page that accepts no message is disconnected.
const STUCK: Duration = Duration::from_secs(5);
/// Largest number of pairing codes that a page may try in one connection.
const ATTEMPTS: u32 = 20;
/// Largest rate of messages from a page, per second (a pointer at 120 Hz, and presses).
const PER_SECOND: f64 = 300.0;
/// Number of malformed messages after which a page's connection is closed.
const FAULTS: u32 = 100;
/// Presses of the same button within this time count as contact bounce, in milliseconds.
const BOUNCE_MS: f64 = 50.0;

/// Connection with a participant page and the page's state.
struct PageConnection {
    socket: WebSocket,
    hub: Arc<ServerState>,
    place: Arc<ConnectionHandle>,
    life: PageLife,
    /// Whether the session was told that the page is lost.
    is_told_lost: bool,
    page: String,
    waits: bool,
    size: ActivePage,
    faults: u32,
    /// Budget of messages that the page may still send (token bucket), with the time of the budget's last update.
    allowed: (f64, Instant),
    pressed: u64,
    /// Name of the button that was pressed last, and the time of that press on the server's clock, in milliseconds.
    last: Option<(String, f64)>,
}

/// Serves a participant page until one side closes the connection.
pub(super) async fn serve_page(socket: WebSocket, hub: Arc<ServerState>, place: Arc<ConnectionHandle>) {
    let now = Instant::now();
    let (page, size, life) = (String::new(), ActivePage::default(), PageLife::new(now));
    let (waits, faults, allowed, pressed) = (false, 0, (PER_SECOND, now), 0);
    let (is_told_lost, last) = (false, None);
    let mut connection =
        PageConnection { socket, hub, place, life, is_told_lost, page, waits, size, faults, allowed, pressed, last };
    let Some(waits) = connection.identify().await else { return };
    // Beyond the limit of watching pages, only the page that takes part is admitted to the display.
    if !connection.take_part(waits).await && !connection.place.admit() {
        count(&connection.hub.status.refused);
        return;
    }
    connection.hub.status.pages.fetch_add(1, Ordering::Relaxed);
    connection.run().await;
    connection.hub.status.pages.fetch_sub(1, Ordering::Relaxed);
    connection.stop_taking_part().await;
}

impl PageConnection {
    /// Sends the display texts to a new page, and waits until the page has identified itself and, if a pairing code is
    /// required, sent the right code. Returns whether the page wants to watch while another page takes part.
    async fn identify(&mut self) -> Option<bool> {
        self.say(&MessageToPage::Words { words: self.hub.words.clone() }).await?;
        let hello_by = tokio::time::Instant::now() + HELLO;
        let (mut has_said, mut attempts) = (false, 0);
        // The typed code, and when it is checked.
        let mut typed: Option<(tokio::time::Instant, String)> = None;
        loop {
            let check_at = typed.as_ref().map_or(hello_by, |(at, _)| *at);
            let message = tokio::select! {
                biased;
                () = self.place.closed() => return None,
                said = self.socket.recv() => said?.ok()?,
                () = sleep_until(hello_by), if !has_said => return None,
                () = sleep_until(check_at), if typed.is_some() => {
                    let (_, code) = typed.take()?;
                    if self.pair(&code).await? {
                        return Some(self.waits);
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
            match self.message(message)? {
                None => {}
                Some(MessageFromPage::Hello { page, width, height, upright, code, waits }) => {
                    self.page = page;
                    self.note_size(width, height, upright);
                    self.waits = waits;
                    if !self.hub.has_code() {
                        return Some(waits);
                    }
                    has_said = true;
                    match code {
                        // One code at a time; codes beyond the limit are not even counted.
                        Some(code) if typed.is_none() => {
                            attempts += 1;
                            let delay = self.hub.pairing_delay(&self.page, &code);
                            typed = Some((tokio::time::Instant::now() + delay, code));
                        }
                        Some(_) => {}
                        None => self.say(&MessageToPage::Pairing { why: "code", wait_s: 0 }).await?,
                    }
                }
                // A page that shows the form for the pairing code sends pings, too.
                Some(MessageFromPage::Ping { t, hidden, .. }) if has_said => self.pong(t, hidden).await?,
                Some(MessageFromPage::Size { width, height, upright }) if has_said => {
                    self.note_size(width, height, upright)
                }
                Some(_) => self.fault()?,
            }
        }
    }

    /// Checks the page's pairing code, and tells the page if the code is wrong; returns whether the code is right.
    async fn pair(&mut self, code: &str) -> Option<bool> {
        let (why, wait) = match self.hub.pair(self.place.address(), &self.page, code) {
            PairingVerdict::Right => return Some(true),
            PairingVerdict::Wrong(wait) => ("wrong", wait),
            PairingVerdict::Locked(wait) => ("locked", wait),
        };
        count(&self.hub.status.refused);
        let wait_s = wait.as_secs_f64().ceil() as u64;
        self.say(&MessageToPage::Pairing { why, wait_s }).await?;
        Some(false)
    }

    /// Parses the page's message, if the WebSocket frame contains a message to be handled; an outer `None` ends the
    /// connection.
    fn message(&mut self, message: Message) -> Option<Option<MessageFromPage>> {
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
            count(&self.hub.status.refused);
            return Some(None);
        }
        match read(&text) {
            None => self.fault().map(|()| None),
            message => Some(message),
        }
    }

    /// Sends a ping to the page; `None` if the page no longer responds.
    async fn keep_alive(&mut self) -> Option<()> {
        let now = Instant::now();
        if self.life.is_gone(now) {
            return None;
        }
        if self.life.is_silent(now) && self.acts() && !self.is_told_lost {
            self.is_told_lost = true;
            self.report_lost().await;
        }
        self.life.pinged(now);
        timeout(STUCK, self.socket.send(Message::Ping(Bytes::new()))).await.ok()?.ok()
    }

    async fn pong(&mut self, t: f64, is_hidden: bool) -> Option<()> {
        self.life.hide(is_hidden);
        self.say(&MessageToPage::Pong { t, at: self.hub.now_ms() }).await
    }

    /// Counts a malformed message; `None` if the page has sent too many of them.
    fn fault(&mut self) -> Option<()> {
        count(&self.hub.status.malformed);
        self.faults += 1;
        (self.faults < FAULTS).then_some(())
    }

    /// Lets the page take part if no other page does and the page does not want to wait, or if the page took part
    /// before it was loaded again. Returns whether this page takes part now.
    async fn take_part(&mut self, waits: bool) -> bool {
        let mut took = false;
        self.hub.acting.send_if_modified(|acting| {
            took = acting.as_ref().map_or(!waits, |(_, other)| *other == self.page);
            if took {
                *acting = Some((self.place.number, self.page.clone()));
            }
            took
        });
        if took {
            self.place.reserve(true);
            self.report_size().await;
        }
        took
    }

    /// Keeps the size of the page in pixels, and whether the page shows the layout of upright screens.
    fn note_size(&mut self, width_px: u32, height_px: u32, upright: bool) {
        self.size = ActivePage { width_px, height_px, upright, ..self.size };
    }

    /// Reports to the session that a page takes part, with the page's size.
    async fn report_size(&mut self) -> Option<()> {
        let ActivePage { width_px, height_px, upright, .. } = self.size;
        self.hub.status.page(|page| {
            let page = page.get_or_insert_default();
            (page.width_px, page.height_px, page.upright) = (width_px, height_px, upright);
        });
        self.hub.inputs.send(PageInput::Connected { width_px, height_px }).await.ok()
    }

    /// Reports to the session that the page that took part is lost.
    async fn report_lost(&mut self) {
        self.hub.status.page(|page| *page = None);
        let _ = self.hub.inputs.send(PageInput::Lost { since: self.life.heard }).await;
    }

    async fn stop_taking_part(&mut self) {
        if self.acts() {
            self.hub.acting.send_replace(None);
            if !self.is_told_lost {
                self.report_lost().await;
            }
        }
    }

    fn acts(&self) -> bool {
        self.hub.acting.borrow().as_ref().is_some_and(|(number, _)| *number == self.place.number)
    }

    /// Sends scene, role and state to the page whenever they change, and handles the page's messages.
    async fn run(&mut self) -> Option<()> {
        let PageFeed { mut scene, mut sight, mut robot } = self.hub.told.clone();
        let (mut acting, inputs) = (self.hub.acting.subscribe(), self.hub.inputs.clone());
        // For a newly connected page, the present content of the display counts as new.
        scene.mark_changed();
        sight.mark_changed();
        robot.mark_changed();
        acting.mark_changed();
        loop {
            tokio::select! {
                biased;
                () = self.place.closed() => return None,
                () = inputs.closed() => {
                    self.say(&MessageToPage::Ended).await?;
                    return None;
                }
                said = self.socket.recv() => {
                    let said = said?.ok()?;
                    // It was silent only for a while.
                    if std::mem::take(&mut self.is_told_lost) && self.acts() {
                        self.report_size().await?;
                    }
                    self.take(said).await?;
                }
                changed = scene.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut scene).await?;
                    // After a new scene a page shows no state of the kitchen, so the state is sent again.
                    sight.mark_changed();
                    robot.mark_changed();
                }
                changed = acting.changed() => {
                    changed.ok()?;
                    let free = acting.borrow_and_update().is_none();
                    self.place.reserve(self.acts());
                    self.say(&MessageToPage::Role { acts: self.acts(), free }).await?;
                }
                changed = sight.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut sight).await?;
                }
                changed = robot.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut robot).await?;
                }
                () = sleep_until(self.life.next().into()) => self.keep_alive().await?,
            }
        }
    }

    async fn pass_on(&mut self, what: &mut watch::Receiver<Arc<str>>) -> Option<()> {
        let text = what.borrow_and_update().clone();
        if text.is_empty() { Some(()) } else { self.send(&text).await }
    }

    async fn say(&mut self, message: &MessageToPage) -> Option<()> {
        self.send(&text(message)).await
    }

    async fn send(&mut self, text: &str) -> Option<()> {
        let message = Message::Text(Utf8Bytes::from(text));
        timeout(STUCK, self.socket.send(message)).await.ok()?.ok()
    }

    /// Handles a message of the page; `None` if the connection is to be closed.
    async fn take(&mut self, message: Message) -> Option<()> {
        match self.message(message)? {
            None => Some(()),
            Some(MessageFromPage::Ping { t, took, hidden }) => {
                if self.acts() {
                    let change = |page: &mut ActivePage| page.round_trip_ms = took.or(page.round_trip_ms);
                    self.hub.status.page(|page| page.iter_mut().for_each(change));
                }
                self.pong(t, hidden).await
            }
            Some(MessageFromPage::Voice { there }) => {
                if self.acts() {
                    self.hub.status.page(|page| page.iter_mut().for_each(|page| page.voice = Some(there)));
                }
                Some(())
            }
            Some(MessageFromPage::Size { width, height, upright }) => {
                self.note_size(width, height, upright);
                if self.acts() { self.report_size().await } else { Some(()) }
            }
            Some(MessageFromPage::TakePart) => {
                self.take_part(false).await;
                Some(())
            }
            Some(_) if !self.acts() => {
                count(&self.hub.status.refused);
                Some(())
            }
            Some(message) => self.act(message).await,
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

    /// Passes inputs of the page that takes part on to the session.
    async fn act(&mut self, message: MessageFromPage) -> Option<()> {
        let input = match message {
            MessageFromPage::Press { number, button, at } => {
                if !self.is_new(number, &button, at) {
                    count(&self.hub.status.refused);
                    return Some(());
                }
                PageInput::Press { button, at: self.hub.moment(at) }
            }
            // Pointer positions may be dropped, since newer positions follow at once.
            MessageFromPage::Pointer { x, y } => {
                let _ = self.hub.inputs.try_send(PageInput::Pointer { x, y });
                return Some(());
            }
            MessageFromPage::Reply(reply) => PageInput::Reply(reply),
            MessageFromPage::Drawn { cue, at } => PageInput::Drawn { cue, at: self.hub.moment(at) },
            MessageFromPage::Redrawn { took } => {
                let change = |page: &mut ActivePage| page.redraw_ms = Some(took);
                self.hub.status.page(|page| page.iter_mut().for_each(change));
                return Some(());
            }
            MessageFromPage::Hello { .. }
            | MessageFromPage::Ping { .. }
            | MessageFromPage::Size { .. }
            | MessageFromPage::Voice { .. }
            | MessageFromPage::TakePart => {
                return self.fault();
            }
        };
        self.hub.inputs.send(input).await.ok()
    }

    /// Whether a press is a new press: neither a repeated message nor contact bounce of the button.
    fn is_new(&mut self, number: u64, button: &str, at: f64) -> bool {
        let bounces = self.last.as_ref().is_some_and(|(last, when)| last == button && (at - when).abs() < BOUNCE_MS);
        let is_new = number > self.pressed && !bounces;
        if is_new {
            self.pressed = number;
            self.last = Some((button.to_string(), at));
        }
        is_new
    }
}

/// Interval of the server's pings to a page.
const PING: Duration = Duration::from_millis(500);
/// Silence of a browser (no answer to pings) after which the session is told that the page is lost, and after which it
/// counts as gone.
const LOST: Duration = Duration::from_secs(2);
const SILENCE: Duration = Duration::from_secs(8);
/// Time without a message after which a visible page counts as hanging; a visible page sends two messages per second.
const VISIBLE: Duration = Duration::from_secs(8);
/// Time without a message after which a hidden page counts as hanging.
const HIDDEN: Duration = Duration::from_secs(90);

/// Times of a participant page's last signs of life.
#[derive(Clone, Copy, Debug)]
pub(super) struct PageLife {
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

    pub fn hide(&mut self, is_hidden: bool) {
        self.is_hidden = is_hidden;
    }

    pub fn pinged(&mut self, now: Instant) {
        self.pinged = now;
    }

    /// Time of the server's next ping to the page, or of giving up the page.
    pub fn next(&self) -> Instant {
        (self.pinged + PING).min(self.gone_at())
    }

    /// Whether the page counts as lost, since the browser has been silent for too long.
    pub fn is_silent(&self, now: Instant) -> bool {
        now >= self.heard + LOST
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
        life.hide(is_hidden);
        let hours_s = 6 * 3600;
        let gone = (1..=hours_s).find(|second| {
            let now = start + Duration::from_secs(*second);
            if now >= life.next() && !life.is_gone(now) {
                life.pinged(now);
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
        let (start, mut life) = (Instant::now(), PageLife::new(Instant::now()));
        life.heard(start, false);
        assert!(!life.is_silent(start + Duration::from_millis(1900)) && life.is_silent(start + LOST), "told soon");
        assert_eq!(stays_s(true, true, hours_s), 90, "a hidden page that hangs");
        assert_eq!(stays_s(false, true, 60), 8, "a hidden page whose browser is gone");
    }
}
