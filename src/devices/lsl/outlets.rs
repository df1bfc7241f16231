//! Outgoing streams of the Lab Streaming Layer: what they are, the samples of each event, and the thread that sends them.

use std::collections::BTreeMap;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Map, Value, json};

use super::configuration::LslError;
use super::gaze_inlet::compare;
use super::library::{LslLibrary, LslOutletHandle};
use super::{COMPARE, LslThreadGuard};
use crate::compared_clock::{ANSWERS, ClockOffsetEstimator};
use crate::lock;
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::concept::BenefitUnit;
use tomcom_core::communication::recommendation::Recommendation;
use tomcom_core::communication::{Signal, signals};
use tomcom_core::kitchen::{Agent, Kitchen, Location};
use tomcom_core::measures::JudgedPress;
use tomcom_core::robot::JOINT_NAMES;
use tomcom_session::event::Event;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::settings::LslOutlet;
use tomcom_session::{Session, SessionSpec, TimelineEvent, TimestampedEvent};

/// Number of packets of samples that may wait to be sent: the packets of 20 seconds at 200 gaze samples per second.
const WAITING: usize = 4096;
/// Time limit within which the LSL library has to offer the streams.
const BEGIN: Duration = Duration::from_secs(10);
/// Time for which streams are still offered after their last sample, if a program reads them, since the library sends
/// from threads of its own.
const LINGER: Duration = Duration::from_millis(500);

/// Numbers of samples sent over LSL, dropped, and refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LslCounts {
    /// Number of samples that the library accepted.
    pub sent: u64,
    /// Number of samples dropped because the sending thread was too slow.
    pub dropped: u64,
    pub refused: u64,
}

/// Samples, each with the instant of the event that it describes.
type Packet = Vec<(Instant, StreamSample)>;

/// LSL streams that are offered to other programs until this value is dropped.
#[derive(Debug)]
pub struct LslStreams {
    pub descriptions: Vec<StreamDescription>,
    /// Queue to the sending thread, which ends with it.
    packets: SyncSender<Packet>,
    counts: Arc<Mutex<LslCounts>>,
    _thread: LslThreadGuard,
}

impl LslStreams {
    /// Offers these LSL streams to other programs.
    ///
    /// # Errors
    /// The LSL library refuses one of the streams, or does not answer.
    pub fn offer(library: LslLibrary, descriptions: Vec<StreamDescription>) -> Result<LslStreams, LslError> {
        let (packets, told) = sync_channel::<Packet>(WAITING);
        let (begun, begins) = channel();
        let (end, done) = channel();
        let (counts, streams) = (Arc::new(Mutex::default()), descriptions.clone());
        let counted = counts.clone();
        let work = move || {
            let offered = streams.iter().map(|stream| Ok((stream.outlet, library.offer(stream)?)));
            let outlets = match offered.collect::<Result<BTreeMap<_, _>, LslError>>() {
                Ok(outlets) => outlets,
                Err(error) => return drop(begun.send(Err(error))),
            };
            if begun.send(Ok(())).is_ok() {
                send(library, &outlets, &told, &counted);
            }
            if outlets.values().any(LslOutletHandle::has_consumers) {
                thread::sleep(LINGER);
            }
            drop(outlets);
            // The side that waits for this thread may already have ended.
            let _ = end.send(());
        };
        thread::Builder::new().name("lsl".to_string()).spawn(work).map_err(|_| LslError::NoThread)?;
        begins.recv_timeout(BEGIN).map_err(|_| LslError::NoThread)??;
        Ok(LslStreams { descriptions, packets, counts, _thread: LslThreadGuard(done) })
    }

    /// Queues samples for sending, or drops the samples if the sending thread is too slow.
    pub fn tell(&self, samples: Packet) {
        if samples.is_empty() {
            return;
        }
        if let Err(TrySendError::Full(samples) | TrySendError::Disconnected(samples)) = self.packets.try_send(samples) {
            lock(&self.counts).dropped += samples.len() as u64;
        }
    }

    pub fn counts(&self) -> LslCounts {
        *lock(&self.counts)
    }
}

/// Sends the queued samples over LSL until the queue is closed.
fn send(
    library: LslLibrary,
    outlets: &BTreeMap<LslOutlet, LslOutletHandle>,
    told: &Receiver<Packet>,
    counts: &Mutex<LslCounts>,
) {
    let mut clock = ClockOffsetEstimator::new();
    (0..ANSWERS).for_each(|_| compare(&mut clock, &library));
    let mut compared = Instant::now();
    loop {
        let packet = match told.recv_timeout(COMPARE) {
            Ok(packet) => packet,
            Err(RecvTimeoutError::Timeout) => Vec::new(),
            Err(RecvTimeoutError::Disconnected) => return,
        };
        if compared.elapsed() >= COMPARE {
            compared = Instant::now();
            compare(&mut clock, &library);
        }
        for (at, sample) in &packet {
            let outlet = outlets.get(&sample.outlet).zip(clock.device_s(*at));
            let is_taken = outlet.is_some_and(|(outlet, time_s)| match &sample.values {
                LslSampleValues::Numbers(values) => outlet.push_numbers(values, time_s),
                LslSampleValues::Texts(values) => outlet.push_texts(values, time_s),
            });
            let mut counts = lock(counts);
            let counter = if is_taken { &mut counts.sent } else { &mut counts.refused };
            *counter += 1;
        }
    }
}

/// Beginning of the names and source identifiers of all LSL streams of this program.
pub const SOURCE: &str = "tomcom";

/// Description of a stream of the Lab Streaming Layer (LSL).
#[derive(Clone, Debug, PartialEq)]
pub struct StreamDescription {
    pub outlet: LslOutlet,
    /// Name of the stream, with the participant's code: `tomcom-markers-P07`.
    pub name: String,
    pub content: &'static str,
    /// Source identifier, by which a recorder finds the stream again after an interruption; contains the name of the
    /// study, if there is one.
    pub source: String,
    pub channels: Vec<StreamChannel>,
    /// Whether the stream's samples are texts; otherwise the samples are numbers.
    pub is_text: bool,
    /// Metadata of the LSL stream, apart from its channels.
    pub about: Vec<MetadataNode>,
}

/// A channel of an LSL stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamChannel {
    pub label: String,
    /// Unit of the channel's values; empty for channels of text.
    pub unit: &'static str,
}

/// An element of an LSL stream's metadata, which LSL keeps as XML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetadataNode {
    pub name: &'static str,
    /// Text of the metadata element; empty if the element contains other elements.
    pub text: String,
    pub inside: Vec<MetadataNode>,
}

impl MetadataNode {
    fn text(name: &'static str, text: impl ToString) -> MetadataNode {
        MetadataNode { name, text: text.to_string(), inside: Vec::new() }
    }

    fn group(name: &'static str, inside: Vec<MetadataNode>) -> MetadataNode {
        MetadataNode { name, text: String::new(), inside }
    }
}

impl StreamDescription {
    /// All metadata of the LSL stream: channels in the form of LSL's conventions, then the rest.
    pub fn metadata(&self) -> Vec<MetadataNode> {
        let channel = |channel: &StreamChannel| {
            let text = |name, text: &str| MetadataNode::text(name, text);
            let fields = vec![text("label", &channel.label), text("unit", channel.unit), text("type", self.content)];
            MetadataNode::group("channel", fields)
        };
        let channels = MetadataNode::group("channels", self.channels.iter().map(channel).collect());
        std::iter::once(channels).chain(self.about.iter().cloned()).collect()
    }
}

/// The LSL streams that a session sends, in the order of the session file. The streams are the same for all trials of a
/// participant.
pub fn describe(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<StreamDescription> {
    let outlets = spec.lsl.iter().flat_map(|lsl| &lsl.outlets);
    outlets.map(|&outlet| description(outlet, spec, kitchen)).collect()
}

fn description(outlet: LslOutlet, spec: &SessionSpec, kitchen: &Kitchen) -> StreamDescription {
    let code = &spec.participant.code;
    let study = spec.step.as_ref().map(|step| step.plan.as_str());
    let texts = |labels: &[&str]| labels.iter().map(|label| stream_channel(*label, "")).collect();
    let numbers = |labels: Vec<String>, unit| labels.into_iter().map(|label| stream_channel(label, unit)).collect();
    let signal_label = |signal: &Signal| format!("{}/{}", signal.kind().tag(), signal.names().join("/"));
    let (content, channels): (_, Vec<StreamChannel>) = match outlet {
        LslOutlet::Markers => ("Markers", texts(&["code"])),
        LslOutlet::Events => ("Events", texts(&["event"])),
        LslOutlet::Presses => ("Presses", texts(&["agent", "button", "effective", "error"])),
        LslOutlet::Beliefs => {
            ("Beliefs", numbers(kitchen.aspects.iter().map(|aspect| aspect.name.clone()).collect(), "probability"))
        }
        LslOutlet::NetBenefit => {
            let unit = match spec.assistant.concept.name().unit() {
                BenefitUnit::Deviation => "probability",
                BenefitUnit::Presses | BenefitUnit::None => "presses",
            };
            ("NetBenefit", numbers(session_signals(spec, kitchen).iter().map(signal_label).collect(), unit))
        }
        LslOutlet::Gaze => {
            let mut channels: Vec<StreamChannel> = numbers(vec!["x".to_string(), "y".to_string()], "normalised");
            channels.push(stream_channel("confidence", "probability"));
            ("Gaze", channels)
        }
        LslOutlet::Arm => ("Joints", numbers(JOINT_NAMES.map(str::to_string).into(), "radians")),
    };
    let source = [Some(SOURCE), study, Some(code), Some(outlet.name())];
    StreamDescription {
        outlet,
        name: format!("{SOURCE}-{}-{code}", outlet.name()),
        content,
        source: source.into_iter().flatten().collect::<Vec<_>>().join("-"),
        channels,
        is_text: matches!(outlet, LslOutlet::Markers | LslOutlet::Events | LslOutlet::Presses),
        about: about(code, study, kitchen),
    }
}

fn stream_channel(label: impl ToString, unit: &'static str) -> StreamChannel {
    StreamChannel { label: label.to_string(), unit }
}

/// All signals that can be sent in a session, in the order of their channels.
fn session_signals(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<Signal> {
    signals(kitchen, spec.highlights(kitchen)).into_iter().map(|(_, signal)| signal).collect()
}

/// Metadata that all LSL streams have: program, participant, study, and layout of the kitchen.
fn about(code: &str, study: Option<&str>, kitchen: &Kitchen) -> Vec<MetadataNode> {
    let text = |name, value: &str| MetadataNode::text(name, value);
    let numbers = |fields: &[(&'static str, f64)]| -> Vec<MetadataNode> {
        fields.iter().map(|(name, value)| MetadataNode::text(name, value)).collect()
    };
    let location = |location: &Location| {
        let area = location.display;
        let places = numbers(&[("x", area.x), ("y", area.y), ("width", area.w), ("height", area.h)]);
        MetadataNode::group("location", [vec![text("name", &location.name)], places].concat())
    };
    let [width_m, height_m] = kitchen.display_m;
    let size = numbers(&[("display_width_m", width_m), ("display_height_m", height_m)]);
    let locations = MetadataNode::group("locations", kitchen.locations.iter().map(location).collect());
    let layout = [vec![text("name", &kitchen.name)], size, vec![locations]].concat();
    let program = vec![text("name", SOURCE), text("version", env!("CARGO_PKG_VERSION"))];
    let mut about = vec![MetadataNode::group("program", program), text("participant", code)];
    about.extend(study.map(|study| text("study", study)));
    about.push(MetadataNode::group("layout", layout));
    about
}

/// Least time between two samples of the beliefs stream if only gaze has changed the beliefs, in seconds.
const BELIEF_STEP_S: f64 = 0.1;

/// A sample of an LSL stream.
#[derive(Clone, Debug, PartialEq)]
pub struct StreamSample {
    pub outlet: LslOutlet,
    pub time: SessionTime,
    pub values: LslSampleValues,
}

/// The values of an LSL sample, one for each channel.
#[derive(Clone, Debug, PartialEq)]
pub enum LslSampleValues {
    /// Values of a sample in a stream of numbers; NaN stands for a missing value.
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

/// Converts the events of a session into samples of its LSL streams.
#[derive(Clone, Debug)]
pub struct LslSampleConverter {
    outlets: Vec<LslOutlet>,
    recording: String,
    /// The signals with a channel for their net benefit, in the order of the channels.
    signals: Vec<Signal>,
    /// The last sample of the beliefs stream, with its session time.
    believed: Option<(SessionTime, Vec<f32>)>,
}

impl LslSampleConverter {
    /// A converter for the LSL streams that the session sends; `recording` is the name of the recording.
    pub fn new(session: &Session, recording: &str) -> LslSampleConverter {
        let outlets = session.spec.lsl.as_ref().map_or(Vec::new(), |lsl| lsl.outlets.clone());
        LslSampleConverter {
            outlets,
            recording: recording.to_string(),
            signals: session_signals(&session.spec, &session.kitchen),
            believed: None,
        }
    }

    /// Samples that name the recording to which the following samples belong; they stand for no event. The samples are
    /// sent at the beginning of a recording and again at the beginning of its trial, since a recorder may have been
    /// started in between.
    pub fn opening(&self, session: &Session, time: SessionTime) -> Vec<StreamSample> {
        let (spec, recording) = (&session.spec, &self.recording);
        let told = json!({
            "kind": "recording",
            "recording": recording,
            "participant": spec.participant.code,
            "condition": spec.trial.condition.name(),
        });
        let text = |outlet, text: String| StreamSample { outlet, time, values: LslSampleValues::Texts(vec![text]) };
        let all =
            [text(LslOutlet::Markers, format!("recording/{recording}")), text(LslOutlet::Events, told.to_string())];
        all.into_iter().filter(|sample| self.outlets.contains(&sample.outlet)).collect()
    }

    /// Samples for events that were just applied to this session. `judged`: every press of the human so far; `belief`:
    /// the belief estimate after the last event.
    pub fn samples(
        &mut self,
        events: &[TimestampedEvent],
        session: &Session,
        judged: &[JudgedPress],
        belief: &BeliefSnapshot,
    ) -> Vec<StreamSample> {
        let mut samples: Vec<StreamSample> = Vec::new();
        for stamped in events {
            if stamped.event == Event::TrialStarted {
                samples.extend(self.opening(session, stamped.time));
            }
            samples.extend(self.event_samples(stamped, session, judged));
        }
        let by_gaze = events.iter().all(|stamped| stamped.event.is_sample());
        samples.extend(self.belief_sample(belief, by_gaze));
        samples.retain(|sample| self.outlets.contains(&sample.outlet));
        samples
    }

    fn event_samples(
        &self,
        stamped: &TimestampedEvent,
        session: &Session,
        judged: &[JudgedPress],
    ) -> Vec<StreamSample> {
        let sample = |outlet, time, values| StreamSample { outlet, time, values };
        let (now, texts) = (stamped.time, |texts: Vec<String>| LslSampleValues::Texts(texts));
        let mut samples = match &stamped.event {
            Event::Gaze(gaze) => {
                let read = session.corrected(*gaze);
                let values = LslSampleValues::Numbers(vec![read.x, read.y, read.confidence]);
                return vec![sample(LslOutlet::Gaze, gaze.taken_ns.unwrap_or(now), values)];
            }
            Event::RobotMoves(arm) => {
                return vec![sample(LslOutlet::Arm, now, LslSampleValues::Numbers(arm.joints.to_vec()))];
            }
            Event::Press { agent, button, at_ns, .. } => {
                let values = texts(press_texts(*agent, button, stamped, session, judged));
                vec![sample(LslOutlet::Presses, at_ns.unwrap_or(now), values)]
            }
            Event::Advised(advice) => {
                vec![sample(LslOutlet::NetBenefit, advice.for_ns, LslSampleValues::Numbers(self.net_benefits(advice)))]
            }
            _ => Vec::new(),
        };
        samples.push(sample(LslOutlet::Markers, now, texts(vec![code(stamped)])));
        samples.push(sample(LslOutlet::Events, now, texts(vec![event_text(stamped)])));
        samples
    }

    /// Net benefit of each signal, in the order of the stream's channels; NaN for signals that cannot be sent now.
    fn net_benefits(&self, advice: &Recommendation) -> Vec<f64> {
        let option = |signal: &Signal| advice.options.iter().find(|option| option.signal == *signal);
        self.signals.iter().map(|signal| option(signal).map_or(f64::NAN, |option| option.net)).collect()
    }

    /// A sample of the beliefs, if the beliefs have changed; while only gaze changes them, at most one sample per
    /// [`BELIEF_STEP_S`].
    fn belief_sample(&mut self, belief: &BeliefSnapshot, by_gaze: bool) -> Option<StreamSample> {
        let is_due = |(at, _): &(SessionTime, Vec<f32>)| !by_gaze || belief.time.secs_since(*at) >= BELIEF_STEP_S;
        let held: Vec<f32> = belief.held.iter().map(|held| held.p_truth).collect();
        if !self.believed.as_ref().is_none_or(|last| is_due(last) && last.1 != held) {
            return None;
        }
        let values = LslSampleValues::Numbers(held.iter().map(|p_truth| f64::from(*p_truth)).collect());
        self.believed = Some((belief.time, held));
        Some(StreamSample { outlet: LslOutlet::Beliefs, time: belief.time, values })
    }
}

/// Texts of a sample about a press: agent, button, whether the press had an effect, and whether it was an error ("yes",
/// "no", or empty for a press that is not judged).
fn press_texts(
    agent: Agent,
    button: &str,
    stamped: &TimestampedEvent,
    session: &Session,
    judged: &[JudgedPress],
) -> Vec<String> {
    let yes = |is_so: bool| if is_so { "yes" } else { "no" }.to_string();
    let mut entries = session.timeline.iter().rev().take_while(|entry| entry.time >= stamped.time);
    let is_effective = entries.any(|entry| match &entry.what {
        TimelineEvent::Press { agent: other, button: id, no_effect, .. } => {
            let is_it = *other == agent && session.kitchen.button(agent, *id).name == button;
            is_it && entry.time == stamped.time && no_effect.is_none()
        }
        _ => false,
    });
    let verdict =
        judged.iter().rev().take_while(|press| press.seq >= stamped.seq).find(|press| press.seq == stamped.seq);
    let error = verdict.map_or(String::new(), |press| yes(press.verdict.error));
    vec![agent.name().to_string(), button.to_string(), yes(is_effective), error]
}

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
        let private = stamped.event.private_fields();
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
    fields.retain(|name, _| !event.private_fields().contains(&name.as_str()));
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
