//! What comes in: messages of the terminal, the assistant's answers, gaze.

use super::Live;
use crate::communication::recommendation::Recommendation;
use crate::console::{ConsoleCommand, ConsoleMessage, update};
use crate::gaze::GazeSample;
use crate::run::leaving::LeavingReason;
use crate::session::Event;

impl Live {
    /// Takes a message of the terminal; how the wizard leaves the recording, if that is what it says.
    pub(super) fn take(&mut self, message: ConsoleMessage) -> Option<LeavingReason> {
        self.tick();
        self.dirty |= !matches!(message, ConsoleMessage::Pointer(..));
        match update(&mut self.model, self.engine.session(), message) {
            Some(ConsoleCommand::Input(event)) => self.input(event),
            Some(ConsoleCommand::Start(preflight)) => {
                self.input(preflight);
                self.input(Event::TrialStarted);
            }
            Some(ConsoleCommand::Quit) => return Some(LeavingReason::Quit),
            Some(ConsoleCommand::Next) => return Some(LeavingReason::Next),
            Some(ConsoleCommand::Redo) => return Some(LeavingReason::Redo),
            Some(ConsoleCommand::Move(_) | ConsoleCommand::Code) | None => {}
        }
        None
    }

    pub(super) fn input(&mut self, event: Event) {
        let is_gaze = matches!(event, Event::Gaze(_));
        let outcome = self.engine.input(self.clock.now(), event);
        self.record(&outcome.events);
        if let Some(reason) = outcome.refused.filter(|_| !is_gaze) {
            update(&mut self.model, self.engine.session(), ConsoleMessage::Refused(reason));
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
