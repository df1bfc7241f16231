//! One network connection of a participant page. The page identifies itself, and then either takes part (its inputs
//! count) or only watches.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

use axum::extract::ws::Message;
use tokio::sync::watch;
use tokio::time::sleep_until;

use super::message::{MessageFromPage, MessageToPage, PageInput};
use super::server_state::{ActivePage, PageFeed, ServerState};
use crate::page_server::{PageSocket, count};

/// Presses of the same button within this time count as contact bounce, in milliseconds.
const BOUNCE_MS: f64 = 50.0;

/// Connection with a participant page and the page's state.
struct PageConnection {
    socket: PageSocket,
    hub: Arc<ServerState>,
    /// Whether the session was told that the page is lost.
    is_told_lost: bool,
    page: String,
    /// Width and height of the page in pixels, and whether it shows the layout of upright screens.
    size: (u32, u32, bool),
    pressed: u64,
    /// Name of the button that was pressed last, and the time of that press on the server's clock, in milliseconds.
    last: Option<(String, f64)>,
}

/// Serves a participant page until one side closes the connection.
pub(super) async fn serve_page(socket: PageSocket, hub: Arc<ServerState>) {
    let (page, size) = (String::new(), (0, 0, false));
    let mut connection = PageConnection { socket, hub, is_told_lost: false, page, size, pressed: 0, last: None };
    let Some(waits) = connection.identify().await else { return };
    let door = connection.socket.door.clone();
    // Beyond the limit of watching pages, only the page that takes part is admitted to the display.
    if !connection.take_part(waits).await && !connection.socket.place.admit() {
        count(&door.counts.refused);
        return;
    }
    door.counts.pages.fetch_add(1, Ordering::Relaxed);
    connection.run().await;
    door.counts.pages.fetch_sub(1, Ordering::Relaxed);
    if connection.acts() {
        connection.hub.acting.send_replace(None);
        if !connection.is_told_lost {
            connection.report_lost().await;
        }
    }
}

impl PageConnection {
    /// Sends the display texts to a new page, and waits until the page has identified itself. Returns whether the page
    /// wants to watch while another page takes part.
    async fn identify(&mut self) -> Option<bool> {
        self.socket.say(&MessageToPage::Words { words: &self.hub.words }).await?;
        let mut size = self.size;
        let hello = self.socket.identify(|message| match *message {
            MessageFromPage::Hello { width, height, upright, .. }
            | MessageFromPage::Size { width, height, upright } => {
                size = (width, height, upright);
                Ok(())
            }
            _ => Err("unexpected"),
        });
        let MessageFromPage::Hello { page, waits, .. } = hello.await? else { return None };
        (self.page, self.size) = (page, size);
        Some(waits)
    }

    /// Sends a ping to the page, and tells the session once the page is silent; `None` if the page no longer responds.
    async fn keep_alive(&mut self) -> Option<()> {
        let now = Instant::now();
        if self.socket.life.is_silent(now) && !self.socket.life.is_gone(now) && self.acts() && !self.is_told_lost {
            self.is_told_lost = true;
            self.report_lost().await;
        }
        self.socket.keep_alive().await
    }

    /// Lets the page take part if no other page does and the page does not want to wait, or if the page took part
    /// before it was loaded again. Returns whether this page takes part now.
    async fn take_part(&mut self, waits: bool) -> bool {
        let mut took = false;
        self.hub.acting.send_if_modified(|acting| {
            took = acting.as_ref().map_or(!waits, |(_, other)| *other == self.page);
            if took {
                *acting = Some((self.socket.place.number, self.page.clone()));
            }
            took
        });
        if took {
            self.socket.place.reserve(true);
            self.report_size().await;
        }
        took
    }

    /// Reports to the session that a page takes part, with the page's size.
    async fn report_size(&mut self) -> Option<()> {
        let (width_px, height_px, _) = self.size;
        self.hub.change_page(|page| {
            let page = page.get_or_insert_default();
            (page.width_px, page.height_px, page.upright) = self.size;
        });
        self.hub.inputs.send(PageInput::Connected { width_px, height_px }).await.ok()
    }

    /// Reports to the session that the page that took part is lost.
    async fn report_lost(&mut self) {
        self.hub.change_page(|page| *page = None);
        let _ = self.hub.inputs.send(PageInput::Lost { since: self.socket.life.alive() }).await;
    }

    fn acts(&self) -> bool {
        self.hub.acting.borrow().as_ref().is_some_and(|(number, _)| *number == self.socket.place.number)
    }

    /// Sends scene, role and state to the page whenever they change, and handles the page's messages.
    async fn run(&mut self) -> Option<()> {
        let PageFeed { mut scene, mut sight, mut robot } = self.hub.told.clone();
        let (mut acting, inputs) = (self.hub.acting.subscribe(), self.hub.inputs.clone());
        let place = self.socket.place.clone();
        // For a newly connected page, the present content of the display counts as new.
        scene.mark_changed();
        sight.mark_changed();
        robot.mark_changed();
        acting.mark_changed();
        loop {
            let next_sign = self.socket.life.next().into();
            tokio::select! {
                biased;
                () = place.closed() => return None,
                () = inputs.closed() => {
                    self.socket.say_ended().await?;
                    return None;
                }
                said = self.socket.hear() => self.take(said?).await?,
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
                    self.socket.place.reserve(self.acts());
                    self.socket.say(&MessageToPage::Role { acts: self.acts(), free }).await?;
                }
                changed = sight.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut sight).await?;
                }
                changed = robot.changed() => {
                    changed.ok()?;
                    self.pass_on(&mut robot).await?;
                }
                () = sleep_until(next_sign) => self.keep_alive().await?,
            }
        }
    }

    async fn pass_on(&mut self, what: &mut watch::Receiver<Arc<str>>) -> Option<()> {
        let text = what.borrow_and_update().clone();
        if text.is_empty() { Some(()) } else { self.socket.send(&text).await }
    }

    /// Handles a message of the page; `None` if the connection is to be closed.
    async fn take(&mut self, message: Message) -> Option<()> {
        let message = self.socket.read(message)?;
        // It was silent only for a while.
        if self.is_told_lost && !self.socket.life.is_silent(Instant::now()) {
            self.is_told_lost = false;
            if self.acts() {
                self.report_size().await?;
            }
        }
        match message {
            None => Some(()),
            Some(MessageFromPage::Ping { t, took, hidden }) => {
                if self.acts() {
                    let change = |page: &mut ActivePage| page.round_trip_ms = took.or(page.round_trip_ms);
                    self.hub.change_page(|page| page.iter_mut().for_each(change));
                }
                self.socket.pong(t, hidden).await
            }
            Some(MessageFromPage::Voice { there }) => {
                if self.acts() {
                    self.hub.change_page(|page| page.iter_mut().for_each(|page| page.voice = Some(there)));
                }
                Some(())
            }
            Some(MessageFromPage::Size { width, height, upright }) => {
                self.size = (width, height, upright);
                if self.acts() { self.report_size().await } else { Some(()) }
            }
            Some(MessageFromPage::TakePart) => {
                self.take_part(false).await;
                Some(())
            }
            Some(_) if !self.acts() => {
                count(&self.hub.door.counts.refused);
                Some(())
            }
            Some(message) => self.act(message).await,
        }
    }

    /// Passes inputs of the page that takes part on to the session.
    async fn act(&mut self, message: MessageFromPage) -> Option<()> {
        let input = match message {
            MessageFromPage::Press { number, button, at } => {
                if !self.is_new(number, &button, at) {
                    count(&self.hub.door.counts.refused);
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
                self.hub.change_page(|page| page.iter_mut().for_each(|page| page.redraw_ms = Some(took)));
                return Some(());
            }
            MessageFromPage::Hello { .. }
            | MessageFromPage::Ping { .. }
            | MessageFromPage::Size { .. }
            | MessageFromPage::Voice { .. }
            | MessageFromPage::TakePart => return self.socket.fault(),
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
