//! What comes in: messages of the terminal, the assistant's answers, gaze.

use super::Live;
use crate::communication::recommendation::Recommendation;
use crate::console::{Command, Message, update};
use crate::gaze::GazeSample;
use crate::run::leaving::Leaving;
use crate::session::Event;

impl Live {
    /// Takes a message of the terminal; how the wizard leaves the recording, if that is what it says.
    pub(super) fn take(&mut self, message: Message) -> Option<Leaving> {
        self.tick();
        self.dirty |= !matches!(message, Message::Pointer(..));
        match update(&mut self.model, self.engine.session(), message) {
            Some(Command::Input(event)) => self.input(event),
            Some(Command::Start(preflight)) => {
                self.input(preflight);
                self.input(Event::TrialStarted);
            }
            Some(Command::Quit) => return Some(Leaving::Quit),
            Some(Command::Next) => return Some(Leaving::Next),
            Some(Command::Redo) => return Some(Leaving::Redo),
            Some(Command::Move(_) | Command::Code) | None => {}
        }
        None
    }

    pub(super) fn input(&mut self, event: Event) {
        let is_gaze = matches!(event, Event::Gaze(_));
        let outcome = self.engine.input(self.clock.now(), event);
        self.record(&outcome.events);
        if let Some(reason) = outcome.refused.filter(|_| !is_gaze) {
            update(&mut self.model, self.engine.session(), Message::Refused(reason));
        }
    }

    /// Takes the assistant's answer; one that comes when the trial is over is of no use any more.
    pub(super) fn advise(&mut self, advice: Recommendation) {
        let outcome = self.engine.input(self.clock.now(), Event::Advised(advice));
        self.record(&outcome.events);
    }

    /// The pointer as a gaze sample; nobody has moved it yet: no sample.
    pub(super) fn look(&mut self) {
        if let Some([x, y]) = self.model.pointer {
            self.input(Event::Gaze(GazeSample::new(x, y, 1.0)));
        }
    }
}
