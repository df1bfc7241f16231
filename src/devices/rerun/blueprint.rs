//! Layout (blueprint) of the Rerun viewer when it opens a stream: the kitchen above; errors and false beliefs,
//! arm and curves below; the moment in words and a list of events at the side; several recordings beside each other.

use std::io;

use re_sdk::blueprint::components::{PanelState, PlayState};
use re_sdk::blueprint::datatypes::{TextLogColumn, TextLogColumnKind, TimelineColumn};
use re_sdk::blueprint::{
    Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView, Spatial3DView,
    StateTimelineView, Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};
use re_sdk::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use re_sdk::{AsComponents, RecordingStream, RecordingStreamBuilder, SerializedComponentBatch};
use re_sdk_types::blueprint::archetypes::{
    EyeControls3D, PlotLegend, ScalarAxis, TextLogColumns, TimeAxis, VisibleTimeRanges, VisualBounds2D,
};
use re_sdk_types::blueprint::components::{Corner2D, LinkAxis};
use re_sdk_types::datatypes::{Range2D, TimeInt, TimeRange, TimeRangeBoundary, VisibleTimeRange};

use crate::scene::{WIDE, has_poses};
use tomcom_core::communication::concept::BenefitUnit;
use tomcom_session::Session;

/// Application name of all streams, by which recordings share one layout in the Rerun viewer.
pub(super) const APPLICATION: &str = "tomcom";
/// The timeline that viewers open with: the trial's clock, as the console shows it. In the list of events the column of
/// times is as wide as this name.
pub const TRIAL_TIME: &str = "trial_clock_time";
/// The timeline of the session's clock.
pub(super) const SESSION_TIME: &str = "session_time";
/// Durations of the gaze's trail and of its last part, in nanoseconds.
const TRAIL_NS: i64 = 1_500_000_000;
const RECENT_NS: i64 = 500_000_000;
/// Durations that looks and curves show before and after the time cursor, and the room for the legend before the curves, in
/// nanoseconds.
const BEFORE_NS: i64 = 45_000_000_000;
const AFTER_NS: i64 = 15_000_000_000;
const LEGEND_NS: i64 = 35_000_000_000;

/// Position of the camera, and the point at which it looks, in metres from the arm's base: the view shows the whole
/// table from the human's side.
const EYE_M: [f32; 3] = [1.3, -1.0, 0.98];
const LOOKED_AT_M: [f32; 3] = [0.3, 0.0, 0.2];
/// Range of the axis of probabilities.
const PROBABILITY: [f64; 2] = [-0.03, 1.03];

/// One of the recordings that a stream shows side by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShownRecording {
    /// Path of the entity that contains all entities of the recording; empty for the top level.
    pub root: String,
    /// Whose recording it is.
    pub title: String,
    /// Number of films beside the kitchen.
    pub films: usize,
    /// Whether the poses of the robot's arm are known.
    pub has_arm: bool,
    /// Unit of the net benefits of signals; `None` if no assistant is asked.
    pub benefit: Option<BenefitUnit>,
}

impl ShownRecording {
    /// A recording alone in a stream, without films.
    pub fn of(session: &Session, title: String) -> ShownRecording {
        let benefit = session.spec.asks_assistant().then(|| session.spec.assistant.concept.name().unit());
        ShownRecording { title, has_arm: has_poses(session), benefit, ..ShownRecording::default() }
    }
}

/// A property of a view: its path in the blueprint, and its components.
type Property = (String, Vec<SerializedComponentBatch>);

/// What a Rerun viewer does when it has opened a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ViewerStart {
    Waiting,
    /// The viewer follows the newest data of a running session.
    Following,
}

/// Layout of a Rerun viewer: the views, and properties that Rerun's own API for views lacks.
pub(super) struct ViewerLayout {
    blueprint: Blueprint,
    properties: Vec<Property>,
}

impl ViewerLayout {
    pub(super) fn from_lanes(lanes: &[ShownRecording], opens: ViewerStart) -> ViewerLayout {
        let mut properties = Vec::new();
        let root: ContainerLike = match lanes {
            [only] => alone(only, &mut properties),
            lanes => Horizontal::new(lanes.iter().map(|lane| beside(lane, &mut properties))).into(),
        };
        let hidden = PanelState::Hidden;
        let time = TimePanel::new().with_state(PanelState::Collapsed).with_timeline(TRIAL_TIME);
        let time = time.with_play_state(match opens {
            ViewerStart::Waiting => PlayState::Paused,
            ViewerStart::Following => PlayState::Following,
        });
        let blueprint = Blueprint::new(root)
            .with_blueprint_panel(BlueprintPanel::from_state(hidden))
            .with_selection_panel(SelectionPanel::from_state(hidden))
            .with_time_panel(time)
            .with_auto_views(false);
        ViewerLayout { blueprint, properties }
    }

    /// Sends the layout before the stream's data. The properties go into the same blueprint (Rerun's layout
    /// description) as the views, before that blueprint is activated.
    pub(super) fn send(self, stream: &RecordingStream) -> io::Result<()> {
        let memory = || RecordingStreamBuilder::new(APPLICATION).enabled(true);
        let (views, kept) = memory().memory().map_err(io::Error::other)?;
        self.blueprint.send(&views, Default::default()).map_err(io::Error::other)?;
        let mut messages = kept.take();
        let named = messages.iter().find_map(|message| match message {
            LogMsg::BlueprintActivationCommand(command) => Some(command.blueprint_id.clone()),
            _ => None,
        });
        let id = named.ok_or_else(|| io::Error::other("the layout has no name"))?;
        let is_it = |message: &LogMsg| *message.store_id() == id;
        messages.retain(|message| is_it(message) && !matches!(message, LogMsg::BlueprintActivationCommand(_)));
        let more = memory().recording_id(id.recording_id().clone()).blueprint();
        let (more, kept) = more.memory().map_err(io::Error::other)?;
        more.set_time_sequence("blueprint", 0);
        for (place, property) in self.properties {
            more.log_serialized_batches(place, false, property).map_err(io::Error::other)?;
        }
        messages.extend(kept.take().into_iter().filter(|message| matches!(message, LogMsg::ArrowMsg(..))));
        let command = BlueprintActivationCommand { blueprint_id: id, make_active: true, make_default: true };
        stream.send_blueprint(messages, command);
        Ok(())
    }
}

fn alone(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let mut views = vec![beliefs(lane, properties)];
    views.extend(benefit(lane, properties));
    views.push(whole(lane, "Probes in the whole trial", &["human/probes/**"], properties));
    if lane.has_arm {
        views.insert(0, arm(lane, properties));
        views.push(series(lane, "Joint angles (degrees)", &["robot/joints/**"], properties));
        views.push(series(lane, "Force (N), hand (cm)", &["robot/force", "robot/hand_away"], properties));
        views.push(whole(lane, "Safety in the whole trial", &["robot/safety/**"], properties));
    }
    let bars = Tabs::new(bars(lane, properties));
    let below = Horizontal::new([bars.into(), Tabs::new(views).into()]).with_column_shares([1.0, 1.0]);
    let left = Vertical::new([seen(lane, properties), below.into()]).with_row_shares([5.0, 3.0]);
    let words = Tabs::new([now(lane), page(lane, "Signals", "signals/page"), about(lane)]);
    let side = Vertical::new([words.into(), happened(lane, properties)]).with_row_shares([1.0, 1.0]);
    Horizontal::new([left.into(), side.into()]).with_column_shares([5.0, 3.0]).into()
}

/// Viewer layout for one of several recordings side by side: what is in words has the whole width of its part.
fn beside(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let mut curves = Vec::from(bars(lane, properties));
    curves.push(beliefs(lane, properties));
    curves.extend(benefit(lane, properties));
    let told = Tabs::new([now(lane), page(lane, "Signals", "signals/page"), about(lane)]);
    let parts = [seen(lane, properties), Tabs::new(curves).into(), told.into(), happened(lane, properties)];
    Vertical::new(parts).with_row_shares([5.0, 3.0, 3.0, 3.0]).into()
}

fn path(lane: &ShownRecording, entities: &str) -> String {
    let path = format!("{}/{entities}", lane.root);
    format!("/{}", path.trim_matches('/'))
}

/// A view of the Rerun viewer with one property set.
fn with(
    view: impl Into<ContainerLike>,
    name: &str,
    property: &dyn AsComponents,
    properties: &mut Vec<Property>,
) -> ContainerLike {
    let view = view.into();
    if let ContainerLike::View(view) = &view {
        properties.push((format!("{}/{name}", view.blueprint_path()), property.as_serialized_batches()));
    }
    view
}

/// The entity of a film, by its number from 0.
pub(super) fn film_entity(lane: &ShownRecording, film: usize) -> String {
    path(lane, &format!("films/{}", film + 1))
}

/// The kitchen, and the films of the recording beside it.
fn seen(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let kitchen = kitchen(lane, properties);
    if lane.films == 0 {
        return kitchen;
    }
    let films = (0..lane.films).map(|film| {
        let (name, entity) = (format!("Film {}", film + 1), film_entity(lane, film));
        Spatial2DView::new(name).with_origin(entity.clone()).with_contents([entity]).into()
    });
    let films = Vertical::new(films.collect::<Vec<ContainerLike>>());
    Horizontal::new([kitchen, films.into()]).with_column_shares([3.0, 2.0]).into()
}

fn kitchen(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let contents = ["kitchen/**", "human/gaze/**"].map(|entities| path(lane, entities));
    let title = if lane.title.is_empty() { "Kitchen".to_string() } else { format!("Kitchen: {}", lane.title) };
    let view = Spatial2DView::new(title).with_origin(path(lane, "kitchen")).with_contents(contents);
    // The display with the labels around it: the viewer by itself takes scaled pictures for larger than they are.
    let (x_range, y_range) = ([-175.0, WIDE + 175.0].into(), [-125.0, WIDE * 9.0 / 16.0 + 110.0].into());
    let view = with(view, "VisualBounds2D", &VisualBounds2D::new(Range2D { x_range, y_range }), properties);
    // Only gaze points are shown for a time, on either of the clocks.
    let mut view = view;
    for (entity, last_ns) in [("human/gaze", TRAIL_NS), ("human/gaze/recent", RECENT_NS)] {
        let range = |timeline: &str| VisibleTimeRange { timeline: timeline.into(), range: cursor(-last_ns, 0) };
        let ranges = VisibleTimeRanges::new([TRIAL_TIME, SESSION_TIME].map(range));
        let place = format!("ViewContents/overrides{}/visualizers", path(lane, entity));
        view = with(view, &place, &ranges, properties);
    }
    view
}

/// A range of time about the viewer's cursor.
fn cursor(from_ns: i64, to_ns: i64) -> TimeRange {
    let [start, end] = [from_ns, to_ns].map(|ns| TimeRangeBoundary::CursorRelative(TimeInt(ns)));
    TimeRange { start, end }
}

fn arm(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let contents = ["robot/**", "human/hand/**"].map(|entities| path(lane, entities));
    let view = Spatial3DView::new("Arm").with_origin(path(lane, "robot")).with_contents(contents);
    let eye = EyeControls3D::new().with_position(EYE_M).with_look_target(LOOKED_AT_M).with_eye_up([0.0, 0.0, 1.0]);
    with(view, "EyeControls3D", &eye, properties)
}

/// A view of curves about the time cursor.
fn series(lane: &ShownRecording, name: &str, entities: &[&str], properties: &mut Vec<Property>) -> ContainerLike {
    let contents: Vec<String> = entities.iter().map(|entities| path(lane, entities)).collect();
    let view = TimeSeriesView::new(name).with_origin(path(lane, "")).with_contents(contents);
    let view = with(view, "PlotLegend", &PlotLegend::new().with_corner(Corner2D::LeftTop), properties);
    // What is not in this time is not in the legend either.
    let range = cursor(-BEFORE_NS, AFTER_NS);
    let shown = |timeline: &str| VisibleTimeRange { timeline: timeline.into(), range };
    let shown = VisibleTimeRanges::new([TRIAL_TIME, SESSION_TIME].map(shown));
    let view = with(view, "VisibleTimeRanges", &shown, properties);
    let axis = TimeAxis::new().with_view_range(cursor(-BEFORE_NS - LEGEND_NS, AFTER_NS));
    with(view, "TimeAxis", &axis, properties)
}

/// A view of belief probabilities of the aspects that were false once: the estimate and, for a simulated participant, its
/// own belief. Below them the errors.
fn beliefs(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let entities = ["human/belief/estimated/**", "human/belief/true/**", "human/errors/**"];
    let view = series(lane, "P(truth)", &entities, properties);
    with(view, "ScalarAxis", &ScalarAxis::new().with_range(PROBABILITY), properties)
}

fn benefit(lane: &ShownRecording, properties: &mut Vec<Property>) -> Option<ContainerLike> {
    let name = match lane.benefit? {
        BenefitUnit::Deviation => "Net benefit, a probability",
        BenefitUnit::Presses | BenefitUnit::None => "Net benefit in presses",
    };
    Some(series(lane, name, &["assistant/benefit/**"], properties))
}

/// A view of states over time, as lanes with words.
fn lanes(lane: &ShownRecording, name: &str, entities: &[&str]) -> StateTimelineView {
    let view = StateTimelineView::new(name).with_origin(path(lane, ""));
    view.with_contents(entities.iter().map(|entities| path(lane, entities)))
}

/// The lanes of all the time, also while data come.
fn whole(lane: &ShownRecording, name: &str, entities: &[&str], properties: &mut Vec<Property>) -> ContainerLike {
    let axis = TimeAxis::new().with_link(LinkAxis::LinkToGlobal);
    with(lanes(lane, name, entities), "TimeAxis", &axis, properties)
}

/// Errors, signals and estimated false beliefs of the whole trial, and the looks, of which a whole trial has too many, about
/// the time cursor.
fn bars(lane: &ShownRecording, properties: &mut Vec<Property>) -> [ContainerLike; 2] {
    let axis = TimeAxis::new().with_view_range(cursor(-BEFORE_NS, AFTER_NS));
    let name = "Whole trial: errors, signals, estimated false beliefs";
    [
        whole(lane, name, &["error", "signal", "wrong_belief/**"], properties),
        with(lanes(lane, "Looks", &["look"]), "TimeAxis", &axis, properties),
    ]
}

fn page(lane: &ShownRecording, name: &str, entity: &str) -> ContainerLike {
    let page = path(lane, entity);
    TextDocumentView::new(name).with_origin(page.clone()).with_contents([page]).into()
}

fn now(lane: &ShownRecording) -> ContainerLike {
    page(lane, "At this moment (scrolls)", "human/now")
}

fn about(lane: &ShownRecording) -> ContainerLike {
    page(lane, "Recording, colours, times", "about")
}

/// A view of the list of events, each with its time on the trial's clock.
fn happened(lane: &ShownRecording, properties: &mut Vec<Property>) -> ContainerLike {
    let lines = path(lane, "happened");
    let view = TextLogView::new("What happened").with_origin(path(lane, "")).with_contents([lines]);
    let column = |kind, visible: bool| TextLogColumn { kind, visible: visible.into() };
    let columns = TextLogColumns::new()
        .with_timeline_columns([TimelineColumn { timeline: TRIAL_TIME.into(), visible: true.into() }])
        .with_text_log_columns([
            column(TextLogColumnKind::Body, true),
            column(TextLogColumnKind::LogLevel, false),
            column(TextLogColumnKind::EntityPath, false),
        ]);
    with(view, "TextLogColumns", &columns, properties)
}
