//! Descriptions of the LSL streams: names, channels and metadata.

use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::signals;
use tomcom_core::kitchen::{Kitchen, Location};
use tomcom_core::robot::JOINT_NAMES;
use tomcom_session::SessionSpec;
use tomcom_session::settings::LslOutlet;

/// Beginning of the names and source identifiers of all LSL streams of this program.
pub const SOURCE: &str = "tomcom";

/// Description of a stream of the Lab Streaming Layer (LSL).
#[derive(Clone, Debug, PartialEq)]
pub struct StreamDescription {
    /// Which of the program's LSL streams is described.
    pub outlet: LslOutlet,
    /// Name of the stream, with the participant's code: `tomcom-markers-P07`.
    pub name: String,
    /// Content type of the stream, as LSL names it.
    pub content: &'static str,
    /// Source identifier, by which a recorder finds the stream again after an interruption; contains the name of the
    /// study, if there is one.
    pub source: String,
    /// Channels of the LSL stream.
    pub channels: Vec<StreamChannel>,
    /// Whether the stream's samples are texts; otherwise the samples are numbers.
    pub is_text: bool,
    /// Metadata of the LSL stream, apart from its channels.
    pub about: Vec<MetadataNode>,
}

/// A channel of an LSL stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamChannel {
    /// Name of the channel, as recorders show it.
    pub label: String,
    /// Unit of the channel's values; empty for channels of text.
    pub unit: &'static str,
}

/// An element of an LSL stream's metadata, which LSL keeps as XML.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MetadataNode {
    /// Name of the metadata element.
    pub name: &'static str,
    /// Text of the metadata element; empty if the element contains other elements.
    pub text: String,
    /// Metadata elements inside this element.
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
    let texts = |labels: &[&str]| labels.iter().map(|label| channel(*label, "")).collect();
    let numbers = |labels: Vec<String>, unit| labels.into_iter().map(|label| channel(label, unit)).collect();
    let (content, channels): (_, Vec<StreamChannel>) = match outlet {
        LslOutlet::Markers => ("Markers", texts(&["code"])),
        LslOutlet::Events => ("Events", texts(&["event"])),
        LslOutlet::Presses => ("Presses", texts(&["agent", "button", "effective", "error"])),
        LslOutlet::Beliefs => {
            ("Beliefs", numbers(kitchen.aspects.iter().map(|aspect| aspect.name.clone()).collect(), "probability"))
        }
        LslOutlet::NetBenefit => ("NetBenefit", numbers(signal_labels(spec, kitchen), net_benefit_unit(spec))),
        LslOutlet::Gaze => {
            let mut channels: Vec<StreamChannel> = numbers(vec!["x".to_string(), "y".to_string()], "normalised");
            channels.push(channel("confidence", "probability"));
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

fn channel(label: impl ToString, unit: &'static str) -> StreamChannel {
    StreamChannel { label: label.to_string(), unit }
}

/// All signals that can be sent in a session, in the order of their channels.
pub(super) fn session_signals(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<Signal> {
    signals(kitchen, spec.highlights(kitchen)).into_iter().map(|(_, signal)| signal).collect()
}

fn signal_labels(spec: &SessionSpec, kitchen: &Kitchen) -> Vec<String> {
    let label = |signal: Signal| match signal {
        Signal::ShowRecipe(order) => format!("show_recipe/{order}"),
        Signal::Highlight(location) => format!("highlight/{location}"),
        Signal::Propose(presses) => format!("propose/{}", presses.join("/")),
    };
    session_signals(spec, kitchen).into_iter().map(label).collect()
}

/// Unit of the channels with the net benefit of signals: presses, except for the concept ToM, which computes deviations
/// of beliefs only.
fn net_benefit_unit(spec: &SessionSpec) -> &'static str {
    if spec.assistant.concept == ConceptName::Tom { "probability" } else { "presses" }
}

/// Metadata that all LSL streams have: program, participant, study, and layout of the kitchen.
fn about(code: &str, study: Option<&str>, kitchen: &Kitchen) -> Vec<MetadataNode> {
    let text = |name, value: &str| MetadataNode::text(name, value);
    let mut about = vec![
        MetadataNode::group("program", vec![text("name", SOURCE), text("version", env!("CARGO_PKG_VERSION"))]),
        text("participant", code),
    ];
    about.extend(study.map(|study| text("study", study)));
    let location = |location: &Location| {
        let area = location.display;
        let number = |name, value: f64| MetadataNode::text(name, value);
        let fields = vec![
            text("name", &location.name),
            number("x", area.x),
            number("y", area.y),
            number("width", area.w),
            number("height", area.h),
        ];
        MetadataNode::group("location", fields)
    };
    let [width_m, height_m] = kitchen.display_m;
    about.push(MetadataNode::group(
        "layout",
        vec![
            text("name", &kitchen.name),
            MetadataNode::text("display_width_m", width_m),
            MetadataNode::text("display_height_m", height_m),
            MetadataNode::group("locations", kitchen.locations.iter().map(location).collect()),
        ],
    ));
    about
}
