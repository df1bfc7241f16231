//! One connection: a page that says who it is, then acts or watches.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use tokio::sync::watch;
use tokio::time::{sleep, timeout};

use super::PageInput;
use super::code::is_code;
use super::message::{FromPage, ToPage, read, text};
use super::server::ServerState;
use super::status::{ActivePage, count};

/// A page says who it is within this time.
const HELLO: Duration = Duration::from_secs(5);
/// Who has to type a code first, within this one.
const TYPING: Duration = Duration::from_secs(120);
/// A page pings every second; one that is silent so long is gone.
const SILENCE: Duration = Duration::from_secs(8);
/// A page that takes nothing for so long is gone.
const STUCK: Duration = Duration::from_secs(5);
/// After a wrong code a page waits so long.
const WRONG: Duration = Duration::from_secs(1);
/// So many messages a second, and so many at once: a pointer at 120 Hz, and presses.
const PER_SECOND: f64 = 300.0;
/// After so many messages that were none, a connection is closed.
const FAULTS: u32 = 100;
/// The same button within so many milliseconds is a contact that bounces.
const BOUNCE_MS: f64 = 50.0;

/// A page at the other end.
struct Talk {
    socket: WebSocket,
    hub: Arc<ServerState>,
    number: u64,
    page: String,
    size: ActivePage,
    faults: u32,
    /// Messages that it may send at once now, and since when that is so.
    allowed: (f64, Instant),
    /// The number of its last press.
    pressed: u64,
    /// The last press of its button and when, on the server's clock.
    last: Option<(String, f64)>,
}

/// Talks with a page until one of the two ends it.
pub(super) async fn talk(socket: WebSocket, hub: Arc<ServerState>, number: u64) {
    let allowed = (PER_SECOND, Instant::now());
    let (page, size) = (String::new(), ActivePage::default());
    let mut talk = Talk { socket, hub, number, page, size, faults: 0, allowed, pressed: 0, last: None };
    let Some(waits) = talk.greet().await else { return };
    talk.hub.status.pages.fetch_add(1, Ordering::Relaxed);
    talk.take_seat(waits).await;
    talk.run().await;
    talk.hub.status.pages.fetch_sub(1, Ordering::Relaxed);
    talk.leave_seat().await;
}

impl Talk {
    /// Gives the page its words, and waits for it to say who it is; where a code is asked for, until it is right. Whether it
    /// waits for another page.
    async fn greet(&mut self) -> Option<bool> {
        self.say(&ToPage::Words { words: self.hub.words.clone() }).await?;
        loop {
            let Some(FromPage::Hello { page, width, height, code, waits }) = self.first().await? else {
                self.fault()?;
                continue;
            };
            (self.page, self.size.width_px, self.size.height_px) = (page, width, height);
            let Some(wanted) = self.hub.code.clone() else { return Some(waits) };
            match code {
                Some(code) if is_code(&code, &wanted) => return Some(waits),
                Some(_) => {
                    count(&self.hub.status.refused);
                    // Nobody finds a code by trying.
                    sleep(WRONG).await;
                    self.say(&ToPage::Pairing { why: "wrong" }).await?;
                }
                None => self.say(&ToPage::Pairing { why: "code" }).await?,
            }
        }
    }

    /// A message before the page is let in. Who is asked for a code has time to type it.
    async fn first(&mut self) -> Option<Option<FromPage>> {
        let patience = if self.hub.code.is_some() { TYPING } else { HELLO };
        match timeout(patience, self.socket.recv()).await {
            Ok(Some(Ok(Message::Text(text)))) => Some(read(&text)),
            Ok(Some(Ok(Message::Close(_)) | Err(_)) | None) | Err(_) => None,
            Ok(Some(Ok(_))) => Some(None),
        }
    }

    /// Counts a message that was none; nothing, if it was one too many.
    fn fault(&mut self) -> Option<()> {
        count(&self.hub.status.malformed);
        self.faults += 1;
        (self.faults < FAULTS).then_some(())
    }

    /// The first page acts, unless it waits for another; one that is loaded again acts in the place of itself.
    async fn take_seat(&mut self, waits: bool) {
        let mut took = false;
        self.hub.acting.send_if_modified(|acting| {
            took = acting.as_ref().map_or(!waits, |(_, other)| *other == self.page);
            if took {
                *acting = Some((self.number, self.page.clone()));
            }
            took
        });
        if took {
            self.tell_size().await;
        }
    }

    /// Says that the page which acts is there, of this size.
    async fn tell_size(&mut self) -> Option<()> {
        let ActivePage { width_px, height_px, .. } = self.size;
        self.hub.status.page(|page| {
            let page = page.get_or_insert_default();
            (page.width_px, page.height_px) = (width_px, height_px);
        });
        self.hub.inputs.send(PageInput::Connected { width_px, height_px }).await.ok()
    }

    async fn leave_seat(&mut self) {
        let left = self.acts();
        if left {
            self.hub.acting.send_replace(None);
            self.hub.status.page(|page| *page = None);
            let _ = self.hub.inputs.send(PageInput::Lost).await;
        }
    }

    fn acts(&self) -> bool {
        self.hub.acting.borrow().as_ref().is_some_and(|(number, _)| *number == self.number)
    }

    /// Tells scene, role and sight whenever they change, and takes what the page says.
    async fn run(&mut self) -> Option<()> {
        let (mut scene, mut sight) = (self.hub.scene.clone(), self.hub.sight.clone());
        let mut acting = self.hub.acting.subscribe();
        // What is there already is new to this page.
        scene.mark_changed();
        sight.mark_changed();
        acting.mark_changed();
        let mut heard = Instant::now();
        loop {
            tokio::select! {
                biased;
                said = self.socket.recv() => {
                    heard = Instant::now();
                    self.hear(said?.ok()?).await?;
                }
                changed = scene.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut scene).await?;
                    // A page that is built anew shows nothing yet.
                    sight.mark_changed();
                }
                changed = acting.changed() => {
                    changed.ok()?;
                    let free = acting.borrow_and_update().is_none();
                    self.say(&ToPage::Role { acts: self.acts(), free }).await?;
                }
                changed = sight.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut sight).await?;
                }
                () = sleep(SILENCE.saturating_sub(heard.elapsed())) => return None,
            }
        }
    }

    async fn pass_on(&mut self, what: &mut watch::Receiver<Arc<str>>) -> Option<()> {
        let text = what.borrow_and_update().clone();
        if text.is_empty() { Some(()) } else { self.send(&text).await }
    }

    async fn say(&mut self, message: &ToPage) -> Option<()> {
        self.send(&text(message)).await
    }

    async fn send(&mut self, text: &str) -> Option<()> {
        let message = Message::Text(Utf8Bytes::from(text));
        timeout(STUCK, self.socket.send(message)).await.ok()?.ok()
    }

    /// Takes what the page says; nothing, if it is to be left.
    async fn hear(&mut self, message: Message) -> Option<()> {
        let text = match message {
            Message::Text(text) => text,
            Message::Binary(_) => return self.fault(),
            Message::Ping(_) | Message::Pong(_) => return Some(()),
            Message::Close(_) => return None,
        };
        if !self.is_allowed() {
            count(&self.hub.status.refused);
            return Some(());
        }
        match read(&text) {
            None => self.fault(),
            Some(FromPage::Ping { t, took }) => {
                if self.acts() {
                    let change = |page: &mut ActivePage| page.round_trip_ms = took.or(page.round_trip_ms);
                    self.hub.status.page(|page| page.iter_mut().for_each(change));
                }
                self.say(&ToPage::Pong { t, at: self.hub.now_ms() }).await
            }
            Some(FromPage::Size { width, height }) => {
                (self.size.width_px, self.size.height_px) = (width, height);
                if self.acts() { self.tell_size().await } else { Some(()) }
            }
            Some(FromPage::TakePart) => {
                self.take_seat(false).await;
                Some(())
            }
            Some(_) if !self.acts() => {
                count(&self.hub.status.refused);
                Some(())
            }
            Some(message) => self.act(message).await,
        }
    }

    /// A page that sends more than hands and pointer can is not listened to for a while.
    fn is_allowed(&mut self) -> bool {
        let (allowed, since) = self.allowed;
        let now = Instant::now();
        let allowed = (allowed + PER_SECOND * now.duration_since(since).as_secs_f64()).min(PER_SECOND);
        self.allowed = (if allowed >= 1.0 { allowed - 1.0 } else { allowed }, now);
        allowed >= 1.0
    }

    /// Passes on what the page that acts says.
    async fn act(&mut self, message: FromPage) -> Option<()> {
        let input = match message {
            FromPage::Press { number, button, at } => {
                if !self.is_new(number, &button, at) {
                    count(&self.hub.status.refused);
                    return Some(());
                }
                PageInput::Press { button, at: self.hub.moment(at) }
            }
            // A pointer that cannot be taken now is soon elsewhere.
            FromPage::Pointer { x, y } => {
                let _ = self.hub.inputs.try_send(PageInput::Pointer { x, y });
                return Some(());
            }
            FromPage::Answer { item, rated } => PageInput::Answer { item, rated },
            FromPage::Back { item } => PageInput::Back { item },
            FromPage::Confirm => PageInput::Confirm,
            FromPage::Drawn { cue, at } => PageInput::Drawn { cue, at: self.hub.moment(at) },
            FromPage::Redrawn { took } => {
                let change = |page: &mut ActivePage| page.redraw_ms = Some(took);
                self.hub.status.page(|page| page.iter_mut().for_each(change));
                return Some(());
            }
            FromPage::Hello { .. } | FromPage::Ping { .. } | FromPage::Size { .. } | FromPage::TakePart => {
                return self.fault();
            }
        };
        self.hub.inputs.send(input).await.ok()
    }

    /// Whether a press is a press of its own: not one that was said before, nor a contact that bounces.
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
