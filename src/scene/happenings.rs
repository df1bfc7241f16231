//! What happened, in words, and what signals would be worth.

use super::Row;
use super::colours::{self, Colour};
use super::shown::{Level, Series, Shown, slug};
use crate::base::words::count;
use crate::communication::recommendation::Recommendation;
use crate::communication::{Sender, signals};
use crate::console::words;
use crate::kitchen::Agent;
use crate::measures::JudgedPress;
use crate::session::event::SignalEnd;
use crate::session::protocol::ProtocolEvent;
use crate::session::{Entry, Happening, Session, Stamped};

/// The marks of errors, along the bottom of the beliefs.
const ERROR_MARKS: &str = "human/errors/marks";
/// Above this line a signal is worth more than it costs.
const COST_LINE: &str = "assistant/benefit/cost_line";

fn benefit(target: &str) -> String {
    format!("assistant/benefit/{}", slug(target))
}

/// How the series are drawn.
pub fn fixed(session: &Session) -> Vec<Row> {
    let (kitchen, assistant) = (&session.kitchen, &session.spec.assistant);
    let line = |entity: String, name: String, colour: Colour| Row::new(entity, Shown::Line(Series { name, colour }));
    let mut rows: Vec<Row> = signals(kitchen, session.spec.signals.own_hand)
        .iter()
        .enumerate()
        .map(|(nth, (_, signal))| line(benefit(signal.target()), words::signal(signal), colours::of_series(nth)))
        .collect();
    rows.push(line(COST_LINE.to_string(), format!("cost of a signal ({})", assistant.price()), colours::SIGNAL));
    let marks = Series { name: "errors".to_string(), colour: colours::ERROR };
    rows.push(Row::new(ERROR_MARKS, Shown::Marks(marks)));
    rows
}

fn say(entity: &str, level: Level, text: String, colour: Colour) -> Row {
    Row::new(entity, Shown::Words { level, text, colour })
}

/// A new entry of the timeline.
pub fn entry(session: &Session, entry: &Entry) -> Row {
    let (who, text) = words::happening(&session.kitchen, &entry.what);
    match entry.what {
        Happening::Press { agent, effective, .. } => {
            let level = if effective { Level::Info } else { Level::Warning };
            say(&format!("{}/presses", agent.name()), level, text, colours::of(agent))
        }
        Happening::Signal { by: Sender::Wizard, .. } => say("wizard/signals", Level::Info, text, colours::WIZARD),
        Happening::Signal { by: Sender::Assistant, .. } => {
            say("assistant/signals", Level::Info, text, colours::ASSISTANT)
        }
        Happening::SignalEnded(SignalEnd::TakenBack) => say("wizard/signals", Level::Warning, text, colours::WIZARD),
        _ if who == "wizard" || who == "note" => say("wizard/hands", Level::Info, text, colours::WIZARD),
        _ => {
            let text = if who.is_empty() { text } else { format!("{who} {text}") };
            say("trial/events", Level::Info, text, colours::QUIET)
        }
    }
}

/// What happened around the trial.
pub fn protocol(event: &ProtocolEvent) -> Row {
    say("trial/events", Level::Info, words::protocol(event), colours::QUIET)
}

/// The press that was just judged, if it was an error.
pub fn error(session: &Session, stamped: &Stamped, judged: &[JudgedPress]) -> Vec<Row> {
    let press = judged.binary_search_by_key(&stamped.seq, |press| press.seq).ok().map(|index| judged[index]);
    let Some(press) = press.filter(|press| press.verdict.error) else { return Vec::new() };
    let pressed = session.timeline.iter().rev().find_map(|entry| match entry.what {
        Happening::Press { agent: Agent::Human, button, .. } => {
            Some(words::button(&session.kitchen, Agent::Human, button))
        }
        _ => None,
    });
    let lost = count(press.verdict.regret.unsigned_abs(), "press", "presses");
    let text = format!("error: {} loses {lost}", pressed.unwrap_or_default());
    vec![say("human/errors", Level::Error, text, colours::ERROR), Row::new(ERROR_MARKS, Shown::Value(0.0))]
}

/// What signals are worth without their cost, and what the assistant would say.
pub fn advice(advice: &Recommendation) -> Vec<Row> {
    let mut rows: Vec<Row> = advice
        .options
        .iter()
        .map(|option| Row::new(benefit(option.signal.target()), Shown::Value(option.net)))
        .collect();
    rows.push(Row::new(COST_LINE, Shown::Value(0.0)));
    if let Some(best) = &advice.best {
        let net = advice.top().map_or(0.0, |top| top.net);
        let why = advice.reason.as_ref().map_or_else(String::new, |reason| format!("; {}", reason.words()));
        let text = format!("advises: {} (net {net:+.2}){why}", words::signal(best));
        rows.push(say("assistant/advice", Level::Info, text, colours::ASSISTANT));
    }
    rows
}
