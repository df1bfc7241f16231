//! Parser of Pupil Capture's messages: gaze and fixations on a surface, blinks, and the state of Capture's recorder.
//! Payloads are msgpack maps. Memory use is bounded by a multiple of the payloads' length; valid parts of a partly
//! invalid message are used.

use rmpv::Value;
use rmpv::decode::read_value_with_max_depth;

use super::eye_events::FixationFragment;
use crate::gaze_input::MAX_SECONDS;

/// Largest nesting depth of a Capture message.
const MAX_DEPTH: usize = 16;
/// Largest number of items in a datum of a Capture message.
const MAX_ITEMS: usize = 4096;
/// Longest surface name that is passed on, in bytes.
const MAX_NAME: usize = 100;

/// Prefix of the topics of Capture's messages about surfaces; the surface's name follows.
pub const SURFACES: &str = "surfaces.";
/// Topic of annotations, to which Capture's annotation plugin subscribes.
pub const ANNOTATION: &str = "annotation";
/// Further topics of Capture's messages that the program subscribes to.
pub const TOPICS: [&str; 4] = ["fixations", "blinks", STARTED, STOPPED];
const STARTED: &str = "notify.recording.started";
const STOPPED: &str = "notify.recording.stopped";

/// A gaze sample on a surface, as Capture sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceGaze {
    /// Position of the gaze in fractions of the surface, origin at the bottom left, y up; can lie outside of the
    /// surface.
    pub norm_pos: [f64; 2],
    /// Capture's confidence in the sample, from 0 to 1; NaN if Capture does not know it.
    pub confidence: f64,
    /// Time of the sample in Pupil time, in seconds.
    pub timestamp: f64,
}

/// Onset or offset of a blink, as Capture sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PupilBlink {
    /// Whether the lids closed (onset); false if the lids opened (offset).
    pub is_onset: bool,
    /// Capture's confidence in the blink, 0 to 1.
    pub confidence: f64,
    /// Time of the blink's onset or offset in Pupil time, in seconds.
    pub timestamp: f64,
}

/// Notification of Capture's recorder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CaptureNotification {
    /// The recorder began a recording under this session name.
    Started(String),
    /// The recorder ended its recording.
    Stopped,
}

/// Content of a message from Capture after parsing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PupilMessage {
    pub sees_surface: bool,
    /// Gaze samples in the message, in the order in which they were taken.
    pub gaze: Vec<SurfaceGaze>,
    /// Windows of fixations in the message, with positions on the surface, not yet on the display.
    pub fixations: Vec<FixationFragment>,
    /// Onset or offset of a blink, if the message contains one.
    pub blink: Option<PupilBlink>,
    pub other_surface: Option<String>,
    /// Notification of Capture's recorder, if the message contains one.
    pub recorder: Option<CaptureNotification>,
    /// Number of malformed items in the message; 1 if the whole message is malformed.
    pub malformed: u64,
}

/// Parses a Capture message with this topic; topics without a subscription are ignored.
pub fn read(topic: &[u8], payload: &[u8], surface: &str) -> PupilMessage {
    let Ok(topic) = std::str::from_utf8(topic) else { return PupilMessage::default() };
    let surface_seen = topic.strip_prefix(SURFACES);
    if let Some(name) = surface_seen.filter(|name| *name != surface) {
        let other_surface = (1..=MAX_NAME).contains(&name.len()).then(|| name.to_string());
        return PupilMessage { other_surface, ..PupilMessage::default() };
    }
    if surface_seen.is_none() && !TOPICS.contains(&topic) {
        return PupilMessage::default();
    }
    let malformed = || PupilMessage { malformed: 1, ..PupilMessage::default() };
    let mut rest = payload;
    let found = match read_value_with_max_depth(&mut rest, MAX_DEPTH) {
        Ok(found @ Value::Map(_)) if rest.is_empty() => found,
        _ => return malformed(),
    };
    let read = match topic {
        "fixations" => fixation(&found, false)
            .map(|fixation| PupilMessage { fixations: vec![fixation], ..PupilMessage::default() }),
        "blinks" if is_undecided(&found) => Some(PupilMessage::default()),
        "blinks" => blink(&found).map(|blink| PupilMessage { blink: Some(blink), ..PupilMessage::default() }),
        STARTED | STOPPED => {
            recorder(topic, &found).map(|news| PupilMessage { recorder: Some(news), ..PupilMessage::default() })
        }
        _ => Some(of_surface(&found)),
    };
    read.unwrap_or_else(malformed)
}

fn of_surface(datum: &Value) -> PupilMessage {
    let mut told = PupilMessage { sees_surface: true, ..PupilMessage::default() };
    for item in items(datum, "gaze_on_surfaces", &mut told.malformed) {
        match gaze(item) {
            Some(gaze) => told.gaze.push(gaze),
            None => told.malformed += 1,
        }
    }
    // Samples of the two eyes are interleaved in a message, and not always in the order of time.
    told.gaze.sort_by(|a, b| a.timestamp.total_cmp(&b.timestamp));
    for item in items(datum, "fixations_on_surfaces", &mut told.malformed) {
        match fixation(item, true) {
            Some(fixation) => told.fixations.push(fixation),
            None => told.malformed += 1,
        }
    }
    told
}

/// The list with this name in a datum; empty if missing; something other than a list is counted as malformed.
fn items<'a>(datum: &'a Value, name: &str, malformed: &mut u64) -> &'a [Value] {
    match field(datum, name) {
        Some(Value::Array(items)) => {
            *malformed += items.len().saturating_sub(MAX_ITEMS) as u64;
            &items[..items.len().min(MAX_ITEMS)]
        }
        None => &[],
        Some(_) => {
            *malformed += 1;
            &[]
        }
    }
}

fn gaze(item: &Value) -> Option<SurfaceGaze> {
    Some(SurfaceGaze { norm_pos: place(item)?, confidence: gaze_confidence(item)?, timestamp: time(item)? })
}

fn fixation(item: &Value, is_on_surface: bool) -> Option<FixationFragment> {
    let (begin_s, duration_ms) = (time(item)?, number(item, "duration").filter(|duration| *duration >= 0.0)?);
    Some(FixationFragment {
        id: field(item, "id")?.as_u64()?,
        at: if is_on_surface { Some(place(item)?) } else { None },
        span_s: [begin_s, begin_s + duration_ms / 1000.0],
        dispersion_deg: number(item, "dispersion").filter(|dispersion| *dispersion >= 0.0)?,
        confidence: confidence(item)?,
    })
}

fn blink(item: &Value) -> Option<PupilBlink> {
    let is_onset = match field(item, "type")?.as_str()? {
        "onset" => true,
        "offset" => false,
        _ => return None,
    };
    Some(PupilBlink { is_onset, confidence: confidence(item)?, timestamp: time(item)? })
}

/// Whether Capture sent NaN as its confidence. The blink detector does so while a pupil's confidence is NaN, whatever the
/// lids do.
fn is_undecided(item: &Value) -> bool {
    field(item, "confidence").and_then(Value::as_f64).is_some_and(f64::is_nan)
}

fn recorder(topic: &str, item: &Value) -> Option<CaptureNotification> {
    match topic {
        STARTED => Some(CaptureNotification::Started(field(item, "session_name")?.as_str()?.to_string())),
        _ => Some(CaptureNotification::Stopped),
    }
}

fn field<'a>(item: &'a Value, name: &str) -> Option<&'a Value> {
    item.as_map()?.iter().find(|(key, _)| key.as_str() == Some(name)).map(|(_, value)| value)
}

/// The value of a field that is a finite number; integers are converted.
fn number(item: &Value, name: &str) -> Option<f64> {
    field(item, name)?.as_f64().filter(|value| value.is_finite())
}

fn place(item: &Value) -> Option<[f64; 2]> {
    let [x, y] = field(item, "norm_pos")?.as_array()?.as_slice() else { return None };
    let place = [x.as_f64()?, y.as_f64()?];
    // Points outside of the surface are valid up to this distance from it.
    place.iter().all(|value| value.abs() < 1e3).then_some(place)
}

fn confidence(item: &Value) -> Option<f64> {
    number(item, "confidence").filter(|value| (0.0..=1.0).contains(value))
}

/// The confidence of a gaze sample; NaN if Capture does not know it, as where a pupil was lost.
fn gaze_confidence(item: &Value) -> Option<f64> {
    if is_undecided(item) { Some(f64::NAN) } else { confidence(item) }
}

/// The Pupil time of a datum, in seconds from an arbitrary origin, so that it can be negative; `None` if the time does not
/// fit into nanoseconds.
fn time(item: &Value) -> Option<f64> {
    number(item, "timestamp").filter(|value| value.abs() < MAX_SECONDS)
}

pub fn start_plugin(name: &str) -> Vec<u8> {
    let text = |text: &str| Value::from(text);
    encode(vec![
        (text("subject"), text("start_plugin")),
        (text("name"), text(name)),
        (text("args"), Value::Map(Vec::new())),
    ])
}

/// The payload of an annotation at this Pupil time, which is `late_s` seconds after the event that it describes.
pub fn annotation(label: &str, timestamp: f64, late_s: f64) -> Vec<u8> {
    let text = |text: &str| Value::from(text);
    encode(vec![
        (text("topic"), text(ANNOTATION)),
        (text("label"), text(label)),
        (text("timestamp"), Value::from(timestamp)),
        (text("duration"), Value::from(0.0)),
        (text("source"), text("tomcom")),
        (text("late_s"), Value::from(late_s)),
    ])
}

fn encode(map: Vec<(Value, Value)>) -> Vec<u8> {
    let mut bytes = Vec::new();
    rmpv::encode::write_value(&mut bytes, &Value::Map(map)).expect("a vector takes every byte");
    bytes
}
