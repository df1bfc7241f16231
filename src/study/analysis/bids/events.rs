//! The BIDS table of events: its columns, and what an event puts into them.

use serde::Serialize;

use crate::analysis::bids::recording_tables::PressOutcome;
use crate::analysis::bids::{YES_NO, seconds};
use crate::column::{Levels, TableColumn, columns};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_session::button_box::ButtonBoxEvent;
use tomcom_session::event::{Event, MEANINGS};
use tomcom_session::external::ExternalEvent;
use tomcom_session::film::FilmEvent;
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::probes::{ProbeEvent, ProbeSubject};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::questionnaire::AnswerValue;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::tutorial::TutorialEvent;
use tomcom_session::wall_display::DisplayEvent;

const AGENTS: Levels = &[
    ("human", "The participant"),
    ("participant", "The participant, in the tutorial"),
    ("robot", "The robot that cooks with the participant"),
    ("wizard", "The person at the console, or the script in its place"),
    ("assistant", "The communication concept that acts by itself"),
    ("observer", "Somebody who watched the wizard's screen"),
];
const SIGNALS: Levels = &[
    ("show_recipe", "The recipe of the dish that the order at the place wants"),
    ("highlight", "Directs attention to the place and what lies there"),
    ("propose", "Proposes the next presses of the participant"),
];

/// `with_words`: with the text that somebody typed.
pub(super) fn event_columns(with_words: bool) -> Vec<TableColumn<EventRow>> {
    let mut columns = columns! { |row: EventRow|
        "onset", "s", "Session time: since the beginning of the recording, by a monotonic clock"
            => seconds(row.onset);
        "duration", "s", "Until what the event began is over; 0 for what happens at a moment; n/a where the \
            recording ends before"
            => row.duration.map(|time| if time == SessionTime::ZERO { "0".to_string() } else { seconds(time) });
        "trial_type", MEANINGS, "Kind of the event, as in the log" => row.kind;
        "seq", "", "Number of the event in the log, from 0" => row.seq;
        "trial_time", "s", "The trial's clock, which stands still in pauses; n/a before and after the trial"
            => row.trial_time.map(seconds);
        "what", "", "What exactly happened, for kinds that have several" => &row.cells.what;
        "agent", AGENTS, "Who did it" => &row.cells.agent;
        "button", "", "Name of the button; several are separated by commas: proposed ones, or those of the \
            participant for which the robot waits" => &row.cells.button;
        "effective", YES_NO, "Presses: whether the button did anything"
            => row.outcome.map(|outcome| outcome.effective);
        "error", YES_NO, "Presses of the participant in the trial: whether the press was an error, by the number \
            of presses that it loses" => row.outcome.and_then(|outcome| outcome.error);
        "location", "", "The place that it is about, by its name in the layout" => &row.cells.location;
        "dish", "", "The wanted dish, or the one whose recipe a probe asks for" => &row.cells.dish;
        "content", "", "What lies at the place" => &row.cells.content;
        "signal", SIGNALS, "Kind of the signal that is shown, offered or recommended" => &row.cells.signal;
        "refers_to", "", "Number (seq) of the event that this one is about, answers or follows from"
            => row.cells.refers_to;
        "at", "s", "Session time that the event tells: when the button went down at the display, when the robot \
            will touch the button, when the display drew it, when a fixation began" => row.cells.at.map(seconds);
        "force", "N", "Contact force" => row.cells.force_n;
        "item", "", "Item of a questionnaire, step of the tutorial, phase, aspect of a belief, size of the \
            display, code of an observer, probe and question as in 2.1" => &row.cells.item;
        "answer", "", "Answer to the item: a number, or the ids of the chosen options; of a probe the value, or \
            unsure" => &row.cells.answer;
        "value", "", "The number that the event tells: of robot_safety the faulty joint, clock_jumped \
            milliseconds, tracker seconds or dropped samples (fixations: milliseconds), calibration targets or \
            accuracy in degrees, belief_estimated the log probability of the press, advised and offer_opened the \
            net benefit in presses, probe the number of questions, or how sure an answer is from 1 to 3"
            => row.cells.value;
        "reason", "", "Why, as the log names it" => &row.cells.reason;
    };
    if with_words {
        columns.extend(columns! { |row: EventRow|
            "words", "", "Words that somebody typed, or that a device calls itself by; a ' stands before words that \
                begin with = + - or @, so that no spreadsheet computes them" => &row.cells.words;
        });
    }
    columns
}

#[derive(Debug)]
pub(super) struct EventRow {
    pub onset: SessionTime,
    /// `None` until what the event began is over.
    pub duration: Option<SessionTime>,
    pub kind: &'static str,
    pub seq: u64,
    /// `None` before and after the trial.
    pub trial_time: Option<SessionTime>,
    pub outcome: Option<PressOutcome>,
    pub cells: EventCells,
    /// Whether the row belongs into the table of fixations and blinks instead, if the recording has gaze.
    pub is_of_eyes: bool,
}

/// The cells that follow from the event alone; empty where the event says nothing about the column.
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
    pub words: String,
}

impl EventCells {
    /// `is_words`: whether the event is an answer in the participant's own words.
    pub(super) fn take(&mut self, event: &Event, is_words: bool) {
        if event.kind().starts_with("robot_") {
            self.agent = "robot".to_string();
        }
        match event {
            Event::Protocol(event) => self.take_protocol(event, is_words),
            Event::Tracker(event) => self.take_tracker(event),
            Event::Calibration(event) => self.take_calibration(event),
            Event::Display(event) => self.take_display(event),
            Event::Probe(event) => self.take_probe(event),
            Event::Preflight { overridden, .. } => self.what = if *overridden { "overridden" } else { "" }.to_string(),
            Event::TrialEnded { reason } => self.reason = reason.name().to_string(),
            Event::TrialAborted { reason } | Event::TrialExcluded { reason } => self.words = reason.clone(),
            Event::Marker { note, observer } => {
                self.words = note.clone();
                if let Some(observer) = observer {
                    (self.agent, self.item) = ("observer".to_string(), observer.clone());
                }
            }
            Event::MarkerWorded { note, .. } => self.words = note.clone(),
            Event::Press { agent, button, at_ns, button_box } => {
                (self.agent, self.button, self.at) = (name(agent), button.clone(), *at_ns);
                self.what = if *button_box { "button_box" } else { "" }.to_string();
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
            Event::Film(event) => self.take_film(event),
            Event::ButtonBox(event) => self.take_button_box(event),
            Event::ClockJumped { by_ms } => self.value = Some(*by_ms as f64),
            Event::Screen(screen) => {
                self.what = name(&screen.visibility);
                (self.item, self.answer) = (screen.room.clone(), screen.panels.join(" "));
                self.reason = screen.dialog.clone().unwrap_or_default();
            }
            Event::Unblinded { concepts } => {
                self.item = concepts.iter().map(|concept| concept.name()).collect::<Vec<_>>().join(" ");
            }

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
            Event::RobotStage { stage, .. } => self.what = name(stage),
            Event::RobotConfirmed { stage } => (self.agent, self.what) = ("wizard".to_string(), name(stage)),
            Event::RobotStopped | Event::RobotResumed => self.agent = "wizard".to_string(),
            Event::RobotHeld { by } | Event::RobotReleased { by } | Event::RobotSkipped { by } => self.agent = name(by),
            Event::RobotDriven { by, button } => (self.agent, self.button) = (name(by), button.clone()),

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
                self.reason = advice.words.clone().unwrap_or_default();
                if let Some(signal) = &advice.best {
                    self.take_signal(signal);
                }
                if let Some(proposal) = &advice.proposal {
                    self.button = proposal.presses.join(", ");
                }
            }
            Event::External(event) => {
                (self.agent, self.what) = ("assistant".to_string(), tag(event, "what"));
                match event {
                    ExternalEvent::Began { name: own, .. } => self.answer = own.clone(),
                    ExternalEvent::Believes { for_seq, .. } => self.refers_to = Some(*for_seq),
                    ExternalEvent::Late { for_seq, answer, .. } => {
                        (self.refers_to, self.answer) = (Some(*for_seq), answer.clone());
                    }
                    ExternalEvent::Fault { fault, found, .. } => {
                        (self.item, self.reason) = (name(fault), found.clone());
                    }
                }
            }
            Event::OfferOpened(offer) => {
                self.agent = "assistant".to_string();
                self.what = if offer.visible { "visible" } else { "hidden" }.to_string();
                (self.refers_to, self.value) = (Some(offer.for_seq), offer.worth.map(|worth| worth.net));
                self.item = offer.reason.as_ref().map(|reason| reason.aspect.clone()).unwrap_or_default();
                self.take_signal(&offer.what);
            }

            _ => {}
        }
    }

    pub(super) fn ask_about(&mut self, about: &ProbeSubject) {
        match about {
            ProbeSubject::Location { location } => self.location = location.clone(),
            ProbeSubject::Recipe { dish } => self.dish = dish.clone(),
            ProbeSubject::NextOrder | ProbeSubject::NextPress => self.reason = tag(about, "asks"),
        }
    }

    fn take_signal(&mut self, signal: &Signal) {
        self.location = signal.target().unwrap_or_default().to_string();
        if let Signal::Propose(presses) = signal {
            self.button = presses.join(", ");
        }
        self.signal = signal.kind().tag().to_string();
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

    fn take_button_box(&mut self, event: &ButtonBoxEvent) {
        self.what = tag(event, "what");
        match event {
            ButtonBoxEvent::Connected { device: words } | ButtonBoxEvent::Lost { reason: words } => {
                self.words = words.clone();
            }
            ButtonBoxEvent::Refused { lines, found } => {
                (self.value, self.words) = (Some(*lines as f64), found.clone());
            }
        }
    }

    fn take_film(&mut self, event: &FilmEvent) {
        self.what = tag(event, "what");
        let camera = match event {
            FilmEvent::Began { camera, file, began_ns } => {
                (self.item, self.at) = (file.clone(), Some(*began_ns));
                camera
            }
            FilmEvent::Lost { camera, reason } => {
                self.words = reason.clone();
                camera
            }
            FilmEvent::Back { camera } => camera,
        };
        self.value = Some(f64::from(*camera));
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
