//! Text of an event for the Lab Streaming Layer: a short code, or the event's JSON.

use serde_json::{Map, Value, json};

use tomcom_session::TimestampedEvent;
use tomcom_session::event::Event;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::tutorial::TutorialEvent;

/// Names of the log's fields whose values become parts of an event's code, in this order.
const PARTS: [&str; 14] = [
    "what", "did", "phase", "agent", "by", "button", "location", "order", "dish", "signal", "best", "mode", "item",
    "reason",
];
/// Name of the JSON field that lists the fields that were left out to protect privacy.
const LEFT_OUT: &str = "left_out";

/// Short code of an event: its kind and what it is about, with slashes between: `press/human/take rice`. Tools such as
/// MNE select events by parts of such codes.
pub fn code(stamped: &TimestampedEvent) -> String {
    let fields = fields(&stamped.event);
    let parts = PARTS.iter().filter_map(|part| part_text(fields.get(*part)?));
    std::iter::once(stamped.event.kind().to_string()).chain(parts).collect::<Vec<_>>().join("/")
}

/// The event as in the log, without text that people typed or answered and without names of devices; its field
/// `left_out` lists the missing fields.
pub fn event_text(stamped: &TimestampedEvent) -> String {
    let mut text = json!({ "seq": stamped.seq, "t_ns": stamped.time });
    if let Value::Object(text) = &mut text {
        text.extend(fields(&stamped.event));
        let private = private_fields(&stamped.event);
        if !private.is_empty() {
            text.insert(LEFT_OUT.to_string(), json!(private));
        }
    }
    text.to_string()
}

/// The fields of an event in the log, without those that are left out for privacy.
fn fields(event: &Event) -> Map<String, Value> {
    let mut fields = match serde_json::to_value(event) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    fields.retain(|name, _| !private_fields(event).contains(&name.as_str()));
    fields
}

/// A value of a field as part of an event's code: a word, several words, or name and content of a variant
/// (`highlight/cooking_pot`); `None` for any other value.
fn part_text(value: &Value) -> Option<String> {
    match value {
        Value::String(word) => Some(word.clone()),
        Value::Object(fields) if fields.len() == 1 => {
            let (name, content) = fields.iter().next()?;
            Some(format!("{name}/{}", part_text(content)?))
        }
        Value::Array(parts) => Some(parts.iter().map(part_text).collect::<Option<Vec<_>>>()?.join("/")),
        _ => None,
    }
}

/// Fields of an event that can identify a person, a computer or its folders; they are left out, since everybody in the
/// network can read an LSL stream.
fn private_fields(event: &Event) -> &'static [&'static str] {
    match event {
        Event::Marker { .. } => &["note"],
        Event::TrialAborted { .. } | Event::TrialExcluded { .. } => &["reason"],
        Event::Preflight { .. } => &["checks"],
        Event::Tracker(TrackerEvent::Connected { .. }) => &["device"],
        Event::Tracker(TrackerEvent::Lost { .. }) => &["reason"],
        Event::Tracker(TrackerEvent::OtherSurfaces { .. }) => &["names"],
        Event::Tracker(TrackerEvent::SeveralStreams { .. }) => &["streams"],
        Event::Protocol(ProtocolEvent::ItemAnswered { .. }) => &["answer"],
        Event::Probe(ProbeEvent::Answered { .. }) => &["answer", "confidence"],
        Event::Protocol(ProtocolEvent::Tutorial(TutorialEvent::Answered { .. })) => &["choice"],
        Event::Protocol(ProtocolEvent::CriterionWaived { .. }) | Event::Probe(ProbeEvent::Skipped { .. }) => {
            &["reason"]
        }
        _ => &[],
    }
}
