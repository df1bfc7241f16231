//! The cells of the BIDS table of events that follow from a logged event.

use serde::Serialize;

use super::tsv::{or_nothing, seconds};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::offer::OfferedCommunication;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::event::Event;
use tomcom_session::probes::{ProbeEvent, ProbeSubject};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::wall_display::DisplayEvent;

/// The cells of an event's row in the BIDS table that follow from the event alone; a cell is empty where the event says
/// nothing about the column.
#[derive(Debug, Default)]
pub(super) struct EventCells {
    pub what: String,
    pub agent: String,
    pub button: String,
    pub location: String,
    pub dish: String,
    pub content: String,
    pub signal: String,
    pub refers_to: Option<u64>,
    pub at: Option<SessionTime>,
    pub force_n: Option<f64>,
    pub item: String,
    pub answer: String,
    pub value: Option<f64>,
    pub reason: String,
    /// Text that somebody typed, such as a note of the wizard.
    pub words: String,
}

impl EventCells {
    /// The cells of an event's row. `is_words`: whether the event is an answer in the participant's own words.
    pub(super) fn from_event(event: &Event, is_words: bool) -> EventCells {
        let mut cells = EventCells::default();
        match event {
            Event::Protocol(event) => cells.take_protocol(event, is_words),
            Event::Tracker(event) => cells.take_tracker(event),
            Event::Calibration(event) => cells.take_calibration(event),
            Event::Display(event) => cells.take_display(event),
            Event::Probe(event) => cells.take_probe(event),
            Event::ParticipantBelieves(_) | Event::BeliefEstimated(_) | Event::Advised(_) | Event::OfferOpened(_) => {
                cells.take_advice(event);
            }
            Event::RobotIntends { .. }
            | Event::RobotAborts { .. }
            | Event::RobotIdles { .. }
            | Event::RobotMoves(_)
            | Event::RobotSafety { .. }
            | Event::RobotTouched { .. }
            | Event::RobotStopped
            | Event::RobotResumed
            | Event::RobotHeld { .. }
            | Event::RobotReleased { .. }
            | Event::RobotSkipped { .. }
            | Event::RobotDriven { .. } => cells.take_robot(event),
            event => cells.take_trial(event),
        }
        cells
    }

    /// Fills in the state aspect that the question of a freeze probe is about.
    pub(super) fn ask_about(&mut self, about: &ProbeSubject) {
        match about {
            ProbeSubject::Location { location } => self.location = location.clone(),
            ProbeSubject::Recipe { dish } => self.dish = dish.clone(),
            ProbeSubject::NextOrder | ProbeSubject::NextPress => self.reason = tag(about, "asks"),
        }
    }

    /// The cells of the event's row from the column `location` on, in the order of the columns.
    pub(super) fn rest(&self) -> [String; 11] {
        [
            self.location.clone(),
            self.dish.clone(),
            self.content.clone(),
            self.signal.clone(),
            or_nothing(self.refers_to),
            or_nothing(self.at.map(seconds)),
            or_nothing(self.force_n),
            self.item.clone(),
            self.answer.clone(),
            or_nothing(self.value),
            self.reason.clone(),
        ]
    }

    fn take_signal(&mut self, signal: &Signal) {
        self.location = signal.target().unwrap_or_default().to_string();
        if let Signal::Propose(presses) = signal {
            self.button = presses.join(", ");
        }
        self.signal = match signal {
            Signal::ShowRecipe(_) => "show_recipe",
            Signal::Highlight(_) => "highlight",
            Signal::Propose(_) => "propose",
        }
        .to_string();
    }

    fn take_trial(&mut self, event: &Event) {
        match event {
            Event::Preflight { overridden, .. } => self.what = if *overridden { "overridden" } else { "" }.to_string(),
            Event::TrialEnded { reason } => self.reason = reason.name().to_string(),
            Event::TrialAborted { reason } | Event::TrialExcluded { reason } => self.words = reason.clone(),
            Event::Marker { note } => self.words = note.clone(),
            Event::Press { agent, button, at_ns } => {
                (self.agent, self.button, self.at) = (name(agent), button.clone(), *at_ns);
            }
            Event::OrderShown { order, dish } => (self.location, self.dish) = (order.clone(), dish.clone()),
            Event::OrderCleared { order } => self.location = order.clone(),
            Event::KitchenCorrected { location, content } => {
                self.agent = "wizard".to_string();
                (self.location, self.content) = (location.clone(), content.clone());
            }
            Event::SignalShown { by, signal, offer } => {
                self.agent = name(by);
                self.take_signal(signal);
                self.refers_to = *offer;
            }
            Event::SignalDrawn { signal } => self.refers_to = Some(*signal),
            Event::SignalEnded { reason } => self.reason = name(reason),
            Event::OfferClosed { offer, reason } => (self.refers_to, self.reason) = (Some(*offer), name(reason)),
            Event::HumanWaits { silent_ns } => {
                (self.agent, self.value) = ("human".to_string(), Some(silent_ns.as_secs_f64()));
            }
            Event::ClockJumped { by_ms } => self.value = Some(*by_ms as f64),
            Event::Screen(screen) => {
                self.what = name(&screen.visibility);
                (self.item, self.answer) = (screen.room.clone(), screen.panels.join(" "));
                self.reason = screen.dialog.clone().unwrap_or_default();
            }
            Event::Unblinded { concepts } => {
                self.item = concepts.iter().map(|concept| concept.name()).collect::<Vec<_>>().join(" ");
            }
            _ => {}
        }
    }

    fn take_robot(&mut self, event: &Event) {
        self.agent = "robot".to_string();
        match event {
            Event::RobotIntends { button, until_ns, .. } => (self.button, self.at) = (button.clone(), Some(*until_ns)),
            Event::RobotAborts { button, reason } => (self.button, self.reason) = (button.clone(), name(reason)),
            Event::RobotIdles { reason, waits_for } => {
                (self.reason, self.button) = (name(reason), waits_for.join(", "))
            }
            Event::RobotMoves(sample) => (self.what, self.force_n) = (name(&sample.phase), Some(sample.force_n)),
            Event::RobotSafety { mode, force_n, joint } => {
                (self.what, self.force_n, self.value) = (name(mode), *force_n, joint.map(f64::from));
            }
            Event::RobotTouched { force_n } => self.force_n = Some(*force_n),
            Event::RobotStopped | Event::RobotResumed => self.agent = "wizard".to_string(),
            Event::RobotHeld { by } | Event::RobotReleased { by } | Event::RobotSkipped { by } => self.agent = name(by),
            Event::RobotDriven { by, button } => (self.agent, self.button) = (name(by), button.clone()),
            _ => {}
        }
    }

    fn take_advice(&mut self, event: &Event) {
        match event {
            Event::ParticipantBelieves(belief) => {
                self.agent = "human".to_string();
                self.what = belief.origin.as_ref().map(name).unwrap_or_default();
                (self.item, self.reason) = (belief.targets.join(" "), belief.cause.clone());
            }
            Event::BeliefEstimated(estimate) => {
                (self.refers_to, self.value) = (Some(estimate.press), Some(estimate.log_p));
            }
            Event::Advised(advice) => {
                self.agent = "assistant".to_string();
                self.refers_to = Some(advice.for_seq);
                self.value = advice.options.first().map(|option| option.net);
                self.item = advice.reason.as_ref().map(|reason| reason.aspect.clone()).unwrap_or_default();
                if let Some(signal) = &advice.best {
                    self.take_signal(signal);
                }
                if let Some(proposal) = &advice.proposal {
                    self.button = proposal.presses.join(", ");
                }
            }
            Event::OfferOpened(offer) => {
                self.agent = "assistant".to_string();
                self.what = if offer.visible { "visible" } else { "hidden" }.to_string();
                (self.refers_to, self.value) = (Some(offer.for_seq), offer.worth.map(|worth| worth.net));
                self.item = offer.reason.as_ref().map(|reason| reason.aspect.clone()).unwrap_or_default();
                match &offer.what {
                    OfferedCommunication::Signal(signal) => self.take_signal(signal),
                    OfferedCommunication::Presses(presses) => self.button = presses.join(", "),
                }
            }
            _ => {}
        }
    }

    fn take_protocol(&mut self, event: &ProtocolEvent, is_words: bool) {
        // The event's name in the log; for an event of the tutorial, the name of its step.
        self.what = tag(event, "what");
        match event {
            ProtocolEvent::ConsentGiven { on, digest, .. } => {
                (self.reason, self.item) = (name(on), digest.clone());
            }
            ProtocolEvent::PhaseStarted { phase, number } => {
                (self.item, self.value) = (phase.name().to_string(), Some(*number as f64));
            }
            ProtocolEvent::Ticked { step, done } => {
                (self.item, self.answer) = (step.to_string(), u8::from(*done).to_string());
            }
            ProtocolEvent::Tutorial(event) => self.take_tutorial(event),
            ProtocolEvent::ItemShown { item } | ProtocolEvent::ItemSkipped { item } => self.item = item.clone(),
            ProtocolEvent::ItemAnswered { item, answer } => {
                self.item = item.clone();
                match answer {
                    AnswerValue::Text(words) if is_words => self.words = words.clone(),
                    answer => self.answer = answer.cell(),
                }
            }
            ProtocolEvent::CriterionChecked { met, orders, presses, errors } => {
                self.answer = if *met { "met" } else { "not met" }.to_string();
                self.item = format!("orders={orders} presses={presses} errors={errors}");
            }
            ProtocolEvent::CriterionWaived { reason } => self.words = reason.clone(),
            ProtocolEvent::AnswersShown | ProtocolEvent::AnswersConfirmed => {}
        }
    }

    fn take_tutorial(&mut self, event: &TutorialEvent) {
        self.what = format!("tutorial_{}", tag(event, "did"));
        match event {
            TutorialEvent::Shown { step, by } => {
                (self.item, self.agent) = (step.clone(), by.name().to_string());
            }
            TutorialEvent::Pressed { button } => {
                (self.button, self.agent) = (button.clone(), "participant".to_string());
            }
            TutorialEvent::CardsHidden { step } => self.item = step.clone(),
            TutorialEvent::Answered { step, choice } => {
                (self.item, self.answer) = (step.clone(), choice.to_string());
                self.agent = "participant".to_string();
            }
            TutorialEvent::Ended { by } => self.agent = by.name().to_string(),
        }
    }

    fn take_tracker(&mut self, event: &TrackerEvent) {
        self.what = tag(event, "what");
        match event {
            TrackerEvent::Connected { device: words } | TrackerEvent::Lost { reason: words } => {
                self.words = words.clone()
            }
            TrackerEvent::OtherSurfaces { names } => self.words = names.join(", "),
            TrackerEvent::SeveralStreams { streams } => self.words = streams.join(", "),
            TrackerEvent::Stamps { fault } => {
                self.reason = fault.map_or(String::new(), StampFault::words);
            }
            TrackerEvent::Recording { state } => self.reason = name(state),
            TrackerEvent::Dropped(counts) => self.value = Some(counts.sum() as f64),
            TrackerEvent::Fixation { duration_ms, began_ns, .. } => {
                (self.value, self.at) = (Some(*duration_ms), Some(*began_ns));
            }
            TrackerEvent::ClockSet { by_s, uncertain_since_ns } => {
                (self.value, self.at) = (Some(*by_s), Some(*uncertain_since_ns));
            }
            TrackerEvent::Blink { closed, taken_ns, .. } => {
                self.what = if *closed { "eyes_closed" } else { "eyes_opened" }.to_string();
                self.at = Some(*taken_ns);
            }
            TrackerEvent::DisplayFound | TrackerEvent::DisplayLost => {}
        }
    }

    fn take_calibration(&mut self, event: &GazeCheckEvent) {
        self.what = tag(event, "what");
        self.value = match event {
            GazeCheckEvent::Begun { targets } => Some(targets.len() as f64),
            GazeCheckEvent::TargetShown { target } => Some(*target as f64),
            GazeCheckEvent::Measured { found } => found.as_ref().map(|found| found.accuracy_deg),
            GazeCheckEvent::Carried { found, .. } => Some(found.accuracy_deg),
            _ => None,
        };
        if let GazeCheckEvent::Accepted { corrected } | GazeCheckEvent::Carried { corrected, .. } = event {
            self.answer = if *corrected { "corrected" } else { "as it is" }.to_string();
        }
    }

    fn take_probe(&mut self, event: &ProbeEvent) {
        self.what = tag(event, "did");
        match event {
            ProbeEvent::Requested => self.agent = "wizard".to_string(),
            ProbeEvent::Delayed { reason, .. } | ProbeEvent::Dropped { reason, .. } => self.reason = name(reason),
            ProbeEvent::Begun { origin, questions, .. } => {
                (self.reason, self.value) = (name(origin), Some(questions.len() as f64));
            }
            ProbeEvent::Asked { probe, question } => self.item = format!("{probe}.{question}"),
            ProbeEvent::Answered { probe, question, answer, confidence, .. } => {
                self.agent = "human".to_string();
                self.item = format!("{probe}.{question}");
                self.answer = answer.clone().unwrap_or_else(|| "unsure".to_string());
                self.value = confidence.map(f64::from);
            }
            ProbeEvent::Skipped { reason, .. } => {
                (self.agent, self.words) = ("wizard".to_string(), reason.clone());
            }
            ProbeEvent::Closed { reason, .. } => self.reason = name(reason),
            ProbeEvent::Ended { .. } => {}
        }
    }

    fn take_display(&mut self, event: &DisplayEvent) {
        self.what = tag(event, "what");
        match event {
            DisplayEvent::Connected { width_px, height_px } => self.item = format!("{width_px}x{height_px}"),
            DisplayEvent::Drawn { cue, at_ns } => (self.refers_to, self.at) = (Some(*cue), Some(*at_ns)),
            DisplayEvent::Lost => {}
        }
    }
}

/// The name under which the log writes a value, for example a button's or an event's.
pub(super) fn name(value: &impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_string)).unwrap_or_default()
}

/// The value of the field `key` that tells the variants of an event apart in the log.
fn tag(event: &impl Serialize, key: &str) -> String {
    let record = serde_json::to_value(event).unwrap_or_default();
    record.get(key).and_then(|value| value.as_str()).unwrap_or_default().to_string()
}
