//! Text log of events, and the net benefit of signals, for Rerun.

use super::EntityUpdate;
use super::entity_content::{self, EntityData, MarkShape, SceneColour, SceneLogLevel, SeriesStyle, slug};
use tomcom_core::communication::offer::{OfferCloseReason, OfferedAdvice};
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Sender, Signal, signals};
use tomcom_core::kitchen::{Agent, AspectId, Kitchen};
use tomcom_core::measures::JudgedPress;
use tomcom_session::event::SignalEndReason;
use tomcom_session::history::wording;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::{Session, TimelineEntry, TimelineEvent, TimestampedEvent};

/// Path of the error marks below the belief curves.
const ERROR_MARKS: &str = "human/errors/marks";
/// Path of the line at the cost of communication, in the plot of net benefits.
const COST_LINE: &str = "assistant/benefit/cost_line";

/// Path of the entity with all lines of the text log.
const HAPPENED: &str = "happened";

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

/// Only the lines of the text log among these updates, in the order of time.
pub fn in_order(rows: &[EntityUpdate]) -> Vec<EntityUpdate> {
    let lines = rows.iter().filter(|row| matches!(row.shown, EntityData::Words { .. }));
    lines.map(|row| EntityUpdate::new(HAPPENED, row.shown.clone())).collect()
}

/// A line of the text log for a new entry of the timeline; presses that were judged errors are marked.
pub fn entry(session: &Session, entry: &TimelineEntry, error: Option<&JudgedPress>) -> EntityUpdate {
    let (who, text) = wording::happening(&session.kitchen, &entry.what);
    let text = if who.is_empty() { text } else { format!("{who}: {text}") };
    match entry.what {
        TimelineEvent::Press { agent, no_effect, .. } => {
            let entity = format!("{}/presses", agent.name());
            match error.filter(|_| agent == Agent::Human) {
                Some(press) => {
                    let text = format!("{text} ({})", wording::error(&session.kitchen, press));
                    say(&entity, SceneLogLevel::Error, text, entity_content::ERROR)
                }
                None if no_effect.is_none() => {
                    say(&entity, SceneLogLevel::Info, text, entity_content::agent_colour(agent))
                }
                None => say(&entity, SceneLogLevel::Warning, text, entity_content::agent_colour(agent)),
            }
        }
        TimelineEvent::Signal { by: Sender::Wizard, .. } => {
            say("wizard/signals", SceneLogLevel::Info, text, entity_content::WIZARD)
        }
        TimelineEvent::Signal { by: Sender::Assistant, .. } => {
            say("assistant/signals", SceneLogLevel::Info, text, entity_content::ASSISTANT)
        }
        TimelineEvent::SignalEnded(SignalEndReason::TakenBack) => {
            say("wizard/signals", SceneLogLevel::Warning, text, entity_content::WIZARD)
        }
        TimelineEvent::ArmStopped { .. } => say("robot/events", SceneLogLevel::Error, text, entity_content::ERROR),
        TimelineEvent::ArmTouched { .. } => say("robot/events", SceneLogLevel::Warning, text, entity_content::ROBOT),
        _ if who == "wizard" || who == "note" => say("wizard/hands", SceneLogLevel::Info, text, entity_content::WIZARD),
        _ => say("trial/events", SceneLogLevel::Info, text, entity_content::QUIET),
    }
}

pub fn protocol(event: &ProtocolEvent) -> EntityUpdate {
    say("trial/events", SceneLogLevel::Info, wording::protocol(event), entity_content::QUIET)
}

/// The judgement of the press in this event, if the press was an error.
pub fn error<'a>(stamped: &TimestampedEvent, judged: &'a [JudgedPress]) -> Option<&'a JudgedPress> {
    let press = judged.binary_search_by_key(&stamped.seq, |press| press.seq).ok().map(|index| &judged[index]);
    press.filter(|press| press.verdict.error)
}

pub fn mark() -> EntityUpdate {
    EntityUpdate::new(ERROR_MARKS, EntityData::Value(0.0))
}

/// Entity updates with the expected saving of each signal before its cost is subtracted, and with the recommendation.
pub fn advice(kitchen: &Kitchen, advice: &Recommendation) -> Vec<EntityUpdate> {
    let mut rows: Vec<EntityUpdate> = advice
        .options
        .iter()
        .map(|option| EntityUpdate::new(benefit(&option.signal), EntityData::Value(option.net)))
        .collect();
    rows.push(EntityUpdate::new(COST_LINE, EntityData::Value(0.0)));
    if let Some(best) = &advice.best {
        let net = advice.top().map_or(0.0, |top| top.net);
        let reason = advice.reason.as_ref().map(|reason| wording::reason(kitchen, reason));
        let why = reason.map_or_else(String::new, |reason| format!("; {}", reason.words()));
        let text = format!("assistant advises: {} (net {net:+.2}){why}", wording::signal(best));
        rows.push(say("assistant/advice", SceneLogLevel::Info, text, entity_content::ASSISTANT));
    }
    if let Some(proposal) = &advice.proposal {
        let text = format!("assistant proposes: {}", wording::proposal(&proposal.presses));
        rows.push(say("assistant/advice", SceneLogLevel::Info, text, entity_content::ASSISTANT));
    }
    rows
}

pub fn offer_opened(offer: &OfferedAdvice) -> EntityUpdate {
    let unseen = if offer.visible { "" } else { " (not visible to a wizard)" };
    let text = format!("offer to the wizard: {}{unseen}", wording::offered(&offer.what));
    say("assistant/offers", SceneLogLevel::Info, text, entity_content::ASSISTANT)
}

pub fn offer_closed(reason: OfferCloseReason) -> EntityUpdate {
    say("assistant/offers", SceneLogLevel::Info, format!("offer closes: {}", reason.words()), entity_content::ASSISTANT)
}
