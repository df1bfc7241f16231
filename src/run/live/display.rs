//! The participant's display in a live session: what it is shown, and what comes from it.

use std::time::Instant;

use super::Live;
use crate::base::time::SessionTime;
use crate::console::display::DisplayHealth;
use crate::console::notice::NoticeLevel;
use crate::display::{DisplayUpdate, scene, sight};
use crate::edge::display::{Display, PageScreen};
use crate::gaze::GazeSample;
use crate::kitchen::Agent;
use crate::run::desk::{OperatorDesk, PageInput};
use crate::session::display::{Answering, DisplayEvent};
use crate::session::protocol::ProtocolEvent;
use crate::session::settings::GazeSource;
use crate::session::{Event, Phase};

/// The display of this recording.
pub(super) struct ParticipantDisplay {
    screen: PageScreen,
    /// What it shows.
    shown: Option<DisplayUpdate>,
}

impl ParticipantDisplay {
    /// The display at the desk, if there is one; with what the wizard has to know of it.
    pub fn at(desk: &OperatorDesk) -> (Option<ParticipantDisplay>, Option<DisplayHealth>) {
        let health = |display: &Display| DisplayHealth {
            url: display.url(),
            code: display.code().map(str::to_string),
            ..DisplayHealth::default()
        };
        let display = desk.wall.display();
        (display.map(|display| ParticipantDisplay { screen: display.screen(), shown: None }), display.map(health))
    }
}

impl Live {
    /// Builds the display for this recording.
    pub(super) fn build_display(&mut self) {
        if let Some(display) = &self.display {
            display.screen.build(&scene(self.engine.session()));
        }
        self.look_at_display();
        // The page may have been there before this recording.
        let page = self.model.display.as_ref().and_then(|display| display.page);
        if let Some([width_px, height_px]) = page {
            self.input(Event::Display(DisplayEvent::Connected { width_px, height_px }));
        }
        self.show_participant();
    }

    /// Shows what the participant may see now, if that is something else than before.
    pub(super) fn show_participant(&mut self) {
        if let Some(display) = &mut self.display {
            let now = sight(self.engine.session());
            if display.shown.as_ref() != Some(&now) {
                display.screen.show(&now);
                display.shown = Some(now);
            }
        }
    }

    /// Tells the wizard how the display is.
    pub(super) fn look_at_display(&mut self) {
        let (Some(display), Some(health)) = (&self.display, &mut self.model.display) else { return };
        let counts = display.screen.counts();
        health.page = counts.page.map(|page| [page.width_px, page.height_px]);
        health.round_trip_ms = counts.page.and_then(|page| page.round_trip_ms);
        health.redraw_ms = counts.page.and_then(|page| page.redraw_ms);
        (health.watching, health.malformed, health.refused) = (counts.watching, counts.malformed, counts.refused);
    }

    /// Takes what the page that acts says.
    pub(super) fn hear(&mut self, input: PageInput) {
        if self.engine.session().phase == Phase::Closed {
            return;
        }
        match input {
            PageInput::Connected { width_px, height_px } => {
                self.input(Event::Display(DisplayEvent::Connected { width_px, height_px }));
                self.model
                    .say(NoticeLevel::Done, format!("the participant's display is there, {width_px}x{height_px}"));
            }
            PageInput::Lost => {
                self.input(Event::Display(DisplayEvent::Lost));
                self.model.say(
                    NoticeLevel::Alarm,
                    "the participant's display is gone: it comes back by itself, or open it again",
                );
            }
            PageInput::Press { button, at } => self.press(button, at),
            PageInput::Pointer { x, y } => {
                if self.engine.session().spec.participant.gaze == GazeSource::Mouse {
                    self.input(Event::Gaze(GazeSample::new(x, y, 1.0)));
                }
            }
            PageInput::Answer { item, rated: Some(answer) } => {
                self.answer(ProtocolEvent::ItemAnswered { item, answer });
            }
            PageInput::Answer { item, rated: None } => self.answer(ProtocolEvent::ItemSkipped { item }),
            PageInput::Back { item } => self.answer(ProtocolEvent::ItemShown { item }),
            PageInput::Confirm => self.answer(ProtocolEvent::AnswersConfirmed),
            PageInput::Drawn { cue, at } => {
                let at_ns = self.session_time_of(at);
                self.input(Event::Display(DisplayEvent::Drawn { cue, at_ns }));
            }
        }
    }

    /// A press of the participant. It is stamped when it is taken, since the log's time never runs back, and what became
    /// of the kitchen until then was there before it; when the button went down stands beside it.
    fn press(&mut self, button: String, at: Instant) {
        if self.engine.session().kitchen.button_named(Agent::Human, &button).is_none() {
            self.model.say(NoticeLevel::Refused, "the display told a button that the kitchen does not have");
            return;
        }
        let at_ns = Some(self.session_time_of(at));
        self.input(Event::Press { agent: Agent::Human, button, at_ns });
    }

    /// Answers come from the display only where the session says so.
    fn answer(&mut self, event: ProtocolEvent) {
        if self.engine.session().spec.display.questionnaire == Answering::Display {
            self.input(Event::Protocol(event));
        }
    }

    /// The session time of a moment that is a little ago.
    fn session_time_of(&mut self, at: Instant) -> SessionTime {
        let now = self.clock.now();
        let age_ns = Instant::now().saturating_duration_since(at).as_nanos() as u64;
        SessionTime(now.0.saturating_sub(age_ns))
    }
}
