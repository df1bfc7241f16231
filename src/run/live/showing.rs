//! The wizard's screen, and the record of what it shows.

use std::io;

use super::Live;
use crate::console::screen::screen as on_screen;
use crate::edge::terminal::TerminalScreen;
use crate::run::watch_desk::ComparisonDesk;
use crate::session::{Event, Phase};

impl Live {
    /// Tells the model what time it is.
    pub(super) fn tick(&mut self) {
        self.model.now = self.clock.now();
        self.model.clock = self.model.now;
    }

    pub(super) fn draw(&mut self, screen: &mut TerminalScreen) -> io::Result<()> {
        self.tick();
        if let (Some(newest), Some(compared)) =
            (self.watch.as_ref().and_then(ComparisonDesk::newest), &mut self.model.comparison)
        {
            compared.show(newest);
        }
        let is_ready = screen.is_ready();
        if is_ready {
            self.tell_screen();
        }
        // A terminal that is still busy with the last frame gets this one later.
        self.dirty = !is_ready;
        screen.draw(self.engine.session(), &self.model)?;
        if let Some(signal) = self.undrawn.take_if(|_| is_ready && self.engine.session().phase != Phase::Closed) {
            self.input(Event::SignalDrawn { signal });
        }
        Ok(())
    }

    /// Records what the wizard is about to see, if that is something else than before.
    pub(super) fn tell_screen(&mut self) {
        let now = on_screen(self.engine.session(), &self.model);
        if self.engine.session().phase != Phase::Closed && self.seen.as_ref() != Some(&now) {
            self.seen = Some(now.clone());
            self.input(Event::Screen(now));
        }
    }
}
