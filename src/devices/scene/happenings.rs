//! Text log of events, and the net benefit of signals, for Rerun.

use super::EntityUpdate;
use super::beliefs;
use super::entity_content::{self, EntityData, MarkShape, SceneColour, SceneLogLevel, SeriesStyle, slug};
use tomcom_core::communication::offer::{OfferCloseReason, OfferedAdvice};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal, signals};
use tomcom_core::kitchen::{Agent, AspectId, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_session::history::error_reasons::ExplainedError;
use tomcom_session::history::{event_words, wording};
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::{Event, Session, TimelineEntry, TimelineEvent, TimestampedEvent};

/// Path of the error marks below the belief curves.
const ERROR_MARKS: &str = "human/errors/marks";
/// Path of the line at the cost of communication, in the plot of net benefits.
const COST_LINE: &str = "assistant/benefit/cost_line";

/// Path of the entity with all lines of the text log.
const HAPPENED: &str = "happened";
/// Largest number of characters of a line of the text log, which the viewer would cut at the edge of its view.
const LINE: usize = 76;

fn benefit(signal: &Signal) -> String {
    format!("assistant/benefit/{}", slug(signal.target().unwrap_or_default()))
}

/// Entity updates with the names and colours of curves and marks.
pub fn fixed(session: &Session) -> Vec<EntityUpdate> {
    let (kitchen, assistant) = (&session.kitchen, &session.spec.assistant);
    let line = |entity: String, name: String, colour: SceneColour| {
        EntityUpdate::new(entity, EntityData::Line(SeriesStyle { name, colour }))
    };
    let mut rows: Vec<EntityUpdate> = signals(kitchen, session.spec.highlights(kitchen))
        .iter()
        .map(|(_, signal)| {
            let place = signal.location(kitchen);
            let colour =
                place.map_or(entity_content::QUIET, |place| entity_content::of_aspect(AspectId::of_location(place)));
            line(benefit(signal), wording::signal(signal), colour)
        })
        .collect();
    let worth = format!("worth its cost ({}) above this line", assistant.price());
    rows.push(line(COST_LINE.to_string(), worth, entity_content::SIGNAL));
    let marks = SeriesStyle { name: "errors".to_string(), colour: entity_content::ERROR };
    rows.push(EntityUpdate::new(ERROR_MARKS, EntityData::Marks(marks, MarkShape::Cross)));
    rows
}

fn say(entity: &str, level: SceneLogLevel, text: String, colour: SceneColour) -> EntityUpdate {
    EntityUpdate::new(entity, EntityData::Words { level, text, colour })
}

/// Only the lines of the text log among these updates, in the order of time and cut to length; the rows of their own
/// entities have the whole text.
pub fn in_order(rows: &[EntityUpdate]) -> Vec<EntityUpdate> {
    let line = |row: &EntityUpdate| {
        let EntityData::Words { level, text, colour } = &row.shown else { return None };
        Some(say(HAPPENED, *level, short(text), *colour))
    };
    rows.iter().filter_map(line).collect()
}

/// The beginning of a text, in whole words.
fn short(text: &str) -> String {
    let Some((cut, _)) = text.char_indices().nth(LINE) else { return text.to_string() };
    let start = &text[..cut];
    let end = start.rfind(' ').filter(|end| *end > 0).unwrap_or(cut);
    format!("{}…", start[..end].trim_end_matches([',', ';', ':']))
}

/// A line of the text log for a new entry of the timeline; presses that were judged errors are marked.
pub fn entry(session: &Session, entry: &TimelineEntry, error: Option<ShownError<'_>>) -> EntityUpdate {
    let (who, text) = event_words::happening(&session.kitchen, &entry.what);
    let text = if who.is_empty() { text } else { format!("{who}: {text}") };
    match &entry.what {
        &TimelineEvent::Press { agent, no_effect, .. } => {
            let entity = format!("{}/presses", agent.name());
            match error.filter(|_| agent == Agent::Human) {
                Some(error) => {
                    let text = format!("ERROR {}, {text}: {}", error.number, error.why(session));
                    say(&entity, SceneLogLevel::Error, text, entity_content::ERROR)
                }
                None if no_effect.is_none() => {
                    say(&entity, SceneLogLevel::Info, text, entity_content::agent_colour(agent))
                }
                None => say(&entity, SceneLogLevel::Warning, text, entity_content::agent_colour(agent)),
            }
        }
        TimelineEvent::Noted(Event::SignalShown { by: Sender::Wizard, .. }) => {
            say("wizard/signals", SceneLogLevel::Info, text, entity_content::WIZARD)
        }
        TimelineEvent::Noted(Event::SignalShown { by: Sender::Assistant, .. }) => {
            say("assistant/signals", SceneLogLevel::Info, text, entity_content::ASSISTANT)
        }
        TimelineEvent::Noted(Event::SignalEnded { .. }) => {
            say("wizard/signals", SceneLogLevel::Warning, text, entity_content::WIZARD)
        }
        TimelineEvent::Noted(Event::RobotSafety { .. }) => {
            say("robot/events", SceneLogLevel::Error, text, entity_content::ERROR)
        }
        TimelineEvent::Noted(Event::RobotTouched { .. }) => {
            say("robot/events", SceneLogLevel::Warning, text, entity_content::ROBOT)
        }
        _ if who == "wizard" || who == "note" => say("wizard/hands", SceneLogLevel::Info, text, entity_content::WIZARD),
        _ => say("trial/events", SceneLogLevel::Info, text, entity_content::QUIET),
    }
}

/// What a reviewer looks for in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneLandmark {
    Error,
    Signal,
    /// By the estimate.
    FalseBelief,
}

/// The landmark that begins or ends with this update of its lane, with its words; at its end the words are empty. `None`
/// for other updates.
pub fn landmark(row: &EntityUpdate) -> Option<(SceneLandmark, String)> {
    let EntityData::State(text, _) = &row.shown else { return None };
    let (kind, words) = match row.entity.as_str() {
        beliefs::ERRORS => (SceneLandmark::Error, format!("error {text}")),
        beliefs::SIGNALS => (SceneLandmark::Signal, format!("signal: {text}")),
        lane => {
            let aspect = wording::location(lane.strip_prefix(beliefs::WRONG_BELIEFS)?);
            (SceneLandmark::FalseBelief, format!("false belief: {aspect} taken for {text}"))
        }
    };
    Some((kind, if text.is_empty() { String::new() } else { words }))
}

pub fn protocol(event: &ProtocolEvent) -> EntityUpdate {
    say("trial/events", SceneLogLevel::Info, event_words::protocol(event), entity_content::QUIET)
}

/// A press that was an error.
#[derive(Clone, Copy, Debug)]
pub struct ShownError<'a> {
    /// Its number among the errors of the trial, from 1.
    pub number: usize,
    pub press: &'a JudgedPress,
}

impl ShownError<'_> {
    /// Why the press was an error, with its cost and its cause.
    pub fn why(&self, session: &Session) -> String {
        let explained = ExplainedError::among(session, std::slice::from_ref(self.press));
        explained.into_iter().map(|error| error.with_cause).collect()
    }
}

/// The error in this event, if its press was one.
pub fn error<'a>(stamped: &TimestampedEvent, judged: &'a [JudgedPress]) -> Option<ShownError<'a>> {
    let index = judged.binary_search_by_key(&stamped.seq, |press| press.seq).ok()?;
    let press = judged.get(index).filter(|press| press.verdict.error)?;
    let number = judged[..=index].iter().filter(|press| press.verdict.error).count();
    Some(ShownError { number, press })
}

pub fn mark() -> EntityUpdate {
    EntityUpdate::new(ERROR_MARKS, EntityData::Value(0.0))
}

/// The signals whose net benefit is shown.
#[derive(Clone, Debug, Default)]
pub struct AdviceScene {
    /// The signals that were advised so far: a curve begins where its signal is advised first, so that plot and legend have
    /// only those.
    advised: Vec<Signal>,
}

impl AdviceScene {
    /// Entity updates with the net benefits of signals, and with the recommendation in words.
    pub fn follow(&mut self, advice: &Recommendation, told: &str) -> Vec<EntityUpdate> {
        if let Some(best) = advice.best.as_ref().filter(|best| !self.advised.contains(best)) {
            self.advised.push(best.clone());
        }
        let drawn = advice.options.iter().filter(|option| self.advised.contains(&option.signal));
        let mut rows: Vec<EntityUpdate> =
            drawn.map(|option| EntityUpdate::new(benefit(&option.signal), EntityData::Value(option.net))).collect();
        rows.push(EntityUpdate::new(COST_LINE, EntityData::Value(0.0)));
        if !told.is_empty() {
            let text = format!("assistant {told}");
            rows.push(say("assistant/advice", SceneLogLevel::Info, text, entity_content::ASSISTANT));
        }
        rows
    }
}

/// What the assistant recommends, in words; empty if it recommends nothing.
pub fn advised(kitchen: &Kitchen, advice: &Recommendation) -> String {
    let signal = advice.best.as_ref().map(|best| {
        // An external concept can name a signal without its value, and has reasons in its own words.
        let net = advice.top().map_or_else(String::new, |top| format!(" (net {:+.2})", top.net));
        let reason = advice.reason.as_ref().map(|reason| wording::reason(kitchen, reason).words());
        let why = reason.or_else(|| advice.words.clone()).map_or_else(String::new, |reason| format!("; {reason}"));
        format!("advises: {}{net}{why}", wording::signal(best))
    });
    let proposal =
        advice.proposal.as_ref().map(|proposal| format!("proposes: {}", wording::proposal(&proposal.presses)));
    [signal, proposal].into_iter().flatten().collect::<Vec<_>>().join("; ")
}

pub fn offer_opened(offer: &OfferedAdvice) -> EntityUpdate {
    let unseen = if offer.visible { "" } else { " (not visible to a wizard)" };
    let text = format!("offer to the wizard: {}{unseen}", wording::offered(&offer.what));
    say("assistant/offers", SceneLogLevel::Info, text, entity_content::ASSISTANT)
}

pub fn offer_closed(reason: OfferCloseReason) -> EntityUpdate {
    say("assistant/offers", SceneLogLevel::Info, format!("offer closes: {}", reason.words()), entity_content::ASSISTANT)
}
