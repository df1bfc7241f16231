//! The participant's display in a live session: its content, and its inputs as events of the session.

use super::gaze_events::ago;
use super::presses::{practise, press};
use crate::console::console_model::NoticeLevel;
use crate::console::preflight::ParticipantDisplayHealth;
use crate::run::operator_station::{OperatorStation, PageInput};
use tomcom_core::base::text::printable;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::Agent;
use tomcom_devices::display::{DisplayHandle, ParticipantResponse};
use tomcom_devices::sight::{DisplayContent, RobotHand, RobotHandPose, scene, sight, time_left};
use tomcom_session::admit::admit;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::GazeSource;
use tomcom_session::tutorial::{TutorialEvent, TutorialPageTurner};
use tomcom_session::wall_display::{AnswerDevice, DisplayEvent};
use tomcom_session::{Event, Session};

/// Number of characters that a message to the wizard shows of a name that the participant's page sent.
const SHOWN_NAME: usize = 40;
/// Time by which a page's timer can be early, in seconds: browsers round times.
const EARLY_S: f64 = 0.25;

/// The participant's display during one recording.
pub(super) struct ParticipantDisplay {
    screen: DisplayHandle,
    /// Content that the participant's display shows at present.
    shown: Option<DisplayContent>,
    /// The robot's hand, if the display shows it, with the pose that was sent last.
    hand: Option<RobotHand>,
    told: Option<RobotHandPose>,
}

impl ParticipantDisplay {
    /// The participant's display of the operator's station, if there is one, with the display's state for the wizard.
    pub fn at(station: &OperatorStation) -> (Option<ParticipantDisplay>, Option<ParticipantDisplayHealth>) {
        let display = |screen| ParticipantDisplay { screen, shown: None, hand: None, told: None };
        (station.display.screen().map(display), station.display.health())
    }

    /// Sends the part of the participant's page that stays the same during this session.
    pub fn build(&mut self, session: &Session) {
        self.screen.build(&scene(session));
        (self.hand, self.told) = (RobotHand::new(session), None);
    }

    /// Tells the page where the robot's hand is now, if the hand has moved.
    pub fn move_robot(&mut self, session: &Session, now: SessionTime) {
        let pose = self.hand.as_mut().map(|hand| hand.at(session, now));
        if let Some(pose) = pose.filter(|_| pose != self.told) {
            self.screen.move_robot(&pose);
            self.told = Some(pose);
        }
    }

    /// Sends the content of the participant's page to the display if the content changed.
    pub fn show(&mut self, session: &Session, now: SessionTime) {
        let seen = sight(session);
        if self.shown.as_ref() != Some(&seen) {
            self.screen.show(&seen, time_left(session, now).map(SessionTime::as_secs_f64));
            self.shown = Some(seen);
        }
    }

    /// Updates the display's state that the wizard sees.
    pub fn examine(&self, health: &mut ParticipantDisplayHealth) {
        let counts = self.screen.counts();
        health.page = counts.page.map(|page| [page.width_px, page.height_px]);
        health.upright = counts.page.is_some_and(|page| page.upright);
        health.round_trip_ms = counts.page.and_then(|page| page.round_trip_ms);
        health.redraw_ms = counts.page.and_then(|page| page.redraw_ms);
        health.voice = counts.page.and_then(|page| page.voice);
        (health.watching, health.malformed, health.refused) = (counts.watching, counts.malformed, counts.refused);
    }
}

/// What an input of the participant's page leads to: an event of the session, or a notice to the wizard.
#[derive(Debug, Default)]
pub struct PageEvent {
    pub event: Option<Event>,
    pub notice: Option<(NoticeLevel, String)>,
}

impl PageEvent {
    /// Converts an input of the page that acts for the participant; `now` is the session time.
    pub fn from_input(input: PageInput, session: &Session, now: SessionTime) -> PageEvent {
        let event = match input {
            PageInput::Connected { width_px, height_px } => {
                let text = format!("the participant's display is connected, {width_px}x{height_px} pixels");
                let event = Event::Display(DisplayEvent::Connected { width_px, height_px });
                return PageEvent { event: Some(event), notice: Some((NoticeLevel::Done, text)) };
            }
            PageInput::Lost { .. } => {
                let text = "the participant's display is disconnected: it reconnects by itself, or open its page again";
                let event = Event::Display(DisplayEvent::Lost);
                return PageEvent { event: Some(event), notice: Some((NoticeLevel::Alarm, text.to_string())) };
            }
            PageInput::Press { button, .. } if session.kitchen.button_named(Agent::Human, &button).is_none() => {
                let named: String = printable(&button).chars().take(SHOWN_NAME).collect();
                let text = format!(
                    "the participant's page sent a press of \"{named}\", a button that the kitchen does not have"
                );
                return PageEvent { event: None, notice: Some((NoticeLevel::Refused, text)) };
            }
            PageInput::Press { button, at } => press(button, at, false, session, now),
            PageInput::Pointer { x, y } => {
                let is_gaze = session.spec.participant.gaze == GazeSource::Mouse;
                is_gaze.then(|| Event::Gaze(GazeSample::new(x, y, 1.0)))
            }
            PageInput::Reply(reply) => answered(reply, session, now),
            PageInput::Drawn { cue, at } => Some(Event::Display(DisplayEvent::Drawn { cue, at_ns: ago(now, at) })),
        };
        PageEvent { event, notice: None }
    }
}

/// Converts a reply of the participant to an event of the session; `None` if the reply is not possible now.
fn answered(reply: ParticipantResponse, session: &Session, now: SessionTime) -> Option<Event> {
    match reply {
        ParticipantResponse::Answer { item, answer: Some(given) } => {
            answer(ProtocolEvent::ItemAnswered { item, answer: given }, session)
        }
        ParticipantResponse::Answer { item, answer: None } => answer(ProtocolEvent::ItemSkipped { item }, session),
        // The page goes on from an item only once it is answered, to all answers if each item has one; and only back to an
        // item, the one before or one of all answers.
        ParticipantResponse::Next if is_complete(session) => answer(ProtocolEvent::AnswersShown, session),
        ParticipantResponse::Next if is_answered(session) => session.next_item().and_then(|next| answer(next, session)),
        ParticipantResponse::Back { item } if is_before(session, &item) => {
            answer(ProtocolEvent::ItemShown { item }, session)
        }
        ParticipantResponse::Next | ParticipantResponse::Back { .. } => None,
        // Consent is asked for before a recording begins; a late consent changes nothing.
        ParticipantResponse::Hold { .. } | ParticipantResponse::Consent | ParticipantResponse::Decline => None,
        ParticipantResponse::Confirm => answer(ProtocolEvent::AnswersConfirmed, session),
        ParticipantResponse::Turn { step, forward } => turn(session, &step, forward),
        ParticipantResponse::Choose { step, choice } => practise(session, TutorialEvent::Answered { step, choice }),
        ParticipantResponse::CardsShown { step } => {
            // The page's clock ends the time of the cards, and the session's clock has to agree.
            let is_over = session.tutorial_step().is_some_and(|(shown, state)| {
                let left_s = state.cards_left_s(shown).unwrap_or(0.0);
                now.secs_since(state.shown_since) >= left_s - EARLY_S
            });
            is_over.then(|| practise(session, TutorialEvent::CardsHidden { step })).flatten()
        }
        ParticipantResponse::Believe { probe, question, choice, sure } => {
            believe(session, (probe, question), choice, sure)
        }
    }
}

/// The event by which the participant turns to the next (`forward`) or previous page of the tutorial from this step.
fn turn(session: &Session, step: &str, forward: bool) -> Option<Event> {
    let (tutorial, state) = session.tutorial()?;
    let by = TutorialPageTurner::Participant;
    // A page that participant and wizard turned at the same time is turned only once.
    let from = tutorial.position(step).filter(|&from| from == state.step)?;
    let to = if forward { from + 1 } else { from.checked_sub(1)? };
    practise(
        session,
        match tutorial.steps.get(to) {
            Some(step) => TutorialEvent::Shown { step: step.id.clone(), by },
            None => TutorialEvent::Ended { by },
        },
    )
}

/// Converts the answer to a freeze probe question to an event. Answers that are late or name no choice are ignored
/// without a notice to the wizard.
fn believe(
    session: &Session,
    (probe, question): (u32, u32),
    choice: Option<u16>,
    confidence: Option<u8>,
) -> Option<Event> {
    let open = session.probes.open.as_ref().filter(|open| open.number == probe)?;
    let (_, asked) = open.question().filter(|(index, _)| *index as u32 + 1 == question)?;
    let answer = match choice {
        Some(number) => Some(asked.choices.get(usize::from(number).checked_sub(1)?)?.clone()),
        None => None,
    };
    // Whoever answers also says how sure they are, if that is asked.
    let asks_confidence = session.spec.probes.as_ref().is_some_and(|probes| probes.confidence);
    if confidence.is_some() != (asks_confidence && answer.is_some()) {
        return None;
    }
    let on = AnswerDevice::Display;
    let event = Event::Probe(ProbeEvent::Answered { probe, question, answer, confidence, on });
    admit(session, &event).is_ok().then_some(event)
}

/// Converts an answer to a questionnaire to an event, if participants answer on the display in this session.
fn answer(event: ProtocolEvent, session: &Session) -> Option<Event> {
    (session.spec.display.questionnaire == AnswerDevice::Display).then_some(Event::Protocol(event))
}

/// Whether the shown questionnaire item is answered, or left out.
fn is_answered(session: &Session) -> bool {
    session.protocol.as_ref().is_some_and(|protocol| matches!(protocol.answers.get(protocol.item), Some(Some(_))))
}

/// Whether every item of the questionnaire is answered or left out.
fn is_complete(session: &Session) -> bool {
    session.protocol.as_ref().is_some_and(|protocol| protocol.open_item().is_none())
}

/// Whether the questionnaire has this item before the shown one.
fn is_before(session: &Session, item: &str) -> bool {
    let shown = session.questionnaire().zip(session.protocol.as_ref());
    shown.is_some_and(|(questionnaire, protocol)| {
        questionnaire.items.iter().take(protocol.item).any(|before| before.id == item)
    })
}
