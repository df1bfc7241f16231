//! Presses of the participant, by the page or by the button box.

use std::time::Instant;

use super::gaze_events::ago;
use super::live_session::Live;
use crate::console::console_model::NoticeLevel;
use tomcom_core::base::time::SessionTime;
use tomcom_core::kitchen::Agent;
use tomcom_devices::button_box::ButtonBoxMessage;
use tomcom_session::admit::admit;
use tomcom_session::button_box::ButtonBoxEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::BellOccasion;
use tomcom_session::tracker::DeviceConnection;
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::{Event, Session, TrialPhase};

impl Live {
    /// Takes what the button box tells. The page says itself where a press does nothing; of the box, the wizard is told.
    pub(super) fn take_button_box(&mut self, message: ButtonBoxMessage) {
        if self.engine.session().phase == TrialPhase::Closed {
            return;
        }
        let told = match message {
            ButtonBoxMessage::Press(button, at) => return self.take_box_press(button, at),
            ButtonBoxMessage::Connected => {
                let device = self.engine.session().spec.participant.button_box.clone();
                ButtonBoxEvent::Connected { device: device.unwrap_or_default() }
            }
            ButtonBoxMessage::Lost(reason) => ButtonBoxEvent::Lost { reason },
            ButtonBoxMessage::Refused(lines, found) => ButtonBoxEvent::Refused { lines, found },
        };
        match &told {
            // One that was there before the recording is told in the head line alone.
            ButtonBoxEvent::Connected { .. } => {
                if let DeviceConnection::Lost { .. } = self.engine.session().button_box.link {
                    self.model.say(NoticeLevel::Done, told.words());
                }
            }
            ButtonBoxEvent::Refused { .. } => self.model.warn(told.words()),
            ButtonBoxEvent::Lost { .. } => {
                self.model.say(NoticeLevel::Alarm, told.words());
                if self.engine.session().is_running() {
                    self.ring(BellOccasion::Display);
                }
            }
        }
        self.input(Event::ButtonBox(told));
    }

    fn take_box_press(&mut self, button: String, at: Instant) {
        let (session, words) = (self.engine.session(), format!("the button box pressed {button}"));
        match press(button, at, true, session, self.clock.now()) {
            None => self.model.warn(format!("{words}: nobody asks for it now")),
            Some(event) => {
                if matches!(event, Event::Press { .. }) && !session.is_running() {
                    self.model.warn(format!("{words}: it counts while the trial runs"));
                }
                self.input(event);
            }
        }
    }
}

/// The event of a press of this button of the kitchen; `None` where presses do nothing: in a freeze probe, and in a step of
/// the tutorial that does not ask for this one. The event has the time of reception, since time in the log never
/// decreases; the time at which the button went down is recorded in addition.
pub(super) fn press(
    button: String,
    at: Instant,
    button_box: bool,
    session: &Session,
    now: SessionTime,
) -> Option<Event> {
    // A press that reaches the program after the freeze probe began is ignored.
    if session.probes.open.is_some() {
        return None;
    }
    if session.tutorial_step().is_some() {
        return practise(session, TutorialEvent::Pressed { button });
    }
    Some(Event::Press { agent: Agent::Human, button, at_ns: Some(ago(now, at)), button_box })
}

/// The event of an input to the tutorial. Impossible inputs lead to none: they came late, or were presses in a step without
/// presses.
pub(super) fn practise(session: &Session, event: TutorialEvent) -> Option<Event> {
    let event = Event::Protocol(ProtocolEvent::Tutorial(event));
    admit(session, &event).is_ok().then_some(event)
}
