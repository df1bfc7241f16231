//! Rerun: this file and `rerun/layout.rs` alone know it. Moments of a scene become rows of a stream, which goes to a file, to viewers that
//! connect to a server of the program, or both.
//!
//! The program never connects to a viewer: one that is slow or stopped would hold up the stream, and the file with it.
//! Viewers connect to the program (`rerun/viewer_server.rs`), and take what is kept for them.

mod blueprint;
mod kept_messages;
mod viewer_server;

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use nalgebra::Isometry3;
use re_sdk::log::ChunkBatcherConfig;
use re_sdk::sink::FileSink;
use re_sdk::web_viewer::WebViewerConfig;
use re_sdk::{AsComponents, RecordingStream, RecordingStreamBuilder, SerializedComponentBatch};
use re_sdk_types::archetypes;
use re_sdk_types::components::{Color, FillMode, InterpolationMode, MarkerShape, TextLogLevel};
use re_sdk_types::datatypes::Quaternion;

use self::blueprint::{APPLICATION, ViewerLayout, ViewerStart};
pub use self::blueprint::{StreamLane, TRIAL_TIME};
use self::viewer_server::ViewerServer;
use crate::arm::link::{CollisionSolid, LinkShape};
use crate::base::printable::{printable, printable_lines};
use crate::base::time::SessionTime;
use crate::scene::entity_content::{LogLevel, MarkShape, SceneArea, SceneDisc, ScenePoint, SceneSeries};
use crate::scene::{EntityData, EntityUpdate, SceneUpdate};

/// The version of Rerun that streams are written with; viewers of the same version read them.
pub const VERSION: &str = "0.36.3";
/// In nanoseconds.
const MS: u64 = 1_000_000;
/// What viewers see is so old at most.
const PIECE: Duration = Duration::from_millis(300);
/// Pieces of a file are so long, in session time. Every piece of every entity costs some 2 kB in the file beside its rows, and
/// some 6 kB of memory until the file's index is written at its end.
const PIECE_OF_FILE: SessionTime = SessionTime(60_000_000_000);
/// Rows that wait for the end of their piece, in bytes of one entity and of all.
const WAITING_BYTES: u64 = 1 << 20;
const WAITING_IN_ALL: u64 = 16 << 20;
/// For viewers that connect later so much is kept, in bytes.
const KEPT_BYTES: usize = 64 << 20;
/// Nothing of it is forgotten where a recording is only looked at.
const ALL_BYTES: usize = usize::MAX;
/// Of the gaze, viewers of a running session get at most one sample in this time: eyes cannot follow more.
const GAZE_EVERY: SessionTime = SessionTime(33_000_000);

/// Radius of the mark where somebody looks, and half the width of the circle around it, in millimetres.
const SIGHT_MM: f32 = 9.0;
const LINE_MM: f32 = 2.0;

/// What a stream is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StreamIdentity {
    /// Tells it from all other streams.
    pub id: String,
    /// What the viewer calls it.
    pub name: String,
}

/// Where a stream goes.
#[derive(Clone, Debug, Default)]
pub struct StreamOutlets {
    /// The file that is written, if one is.
    pub file: Option<PathBuf>,
    /// Where viewers connect; `true`: they are given all of it, however much that is.
    pub server: Option<(SocketAddr, bool)>,
    /// Viewers that connect play from this moment of the trial's clock on; else they wait at the beginning, or follow.
    pub at: Option<SessionTime>,
}

/// A stream that is being written: to each of its outlets by itself, so that none holds up another.
pub struct RerunWriter {
    streams: Vec<OpenStream>,
}

/// One of the streams.
struct OpenStream {
    stream: RecordingStream,
    /// Its pieces end at multiples of this; none: it hands rows on by the clock.
    piece: Option<SessionTime>,
    /// The number of the present piece.
    nth: u64,
    /// Gaze is thinned to one sample in this time.
    gaze_every: SessionTime,
    /// When gaze was shown last.
    gaze_at: Option<SessionTime>,
}

impl RerunWriter {
    /// Opens a stream that goes to these outlets, and lays it out: opened in a viewer, it shows these lanes side by side.
    ///
    /// # Errors
    /// The file cannot be made, or the address is none of this machine.
    pub fn open(identity: &StreamIdentity, outlets: &StreamOutlets, lanes: &[StreamLane]) -> io::Result<RerunWriter> {
        let mut streams = Vec::new();
        if let Some(path) = &outlets.file {
            let stream = stream(identity, Duration::MAX)?;
            stream.set_sinks((FileSink::new(path).map_err(io::Error::other)?,));
            ViewerLayout::from_lanes(lanes, ViewerStart::Waiting).send(&stream)?;
            streams.push(OpenStream::new(stream, Some(PIECE_OF_FILE), SessionTime::ZERO));
        }
        if let Some((address, all)) = outlets.server {
            let stream = stream(identity, PIECE)?;
            let kept = if all { ALL_BYTES } else { KEPT_BYTES };
            stream.set_sink(Box::new(ViewerServer::open(address, kept)?));
            let opens = match outlets.at {
                Some(at) => ViewerStart::From(at),
                None if all => ViewerStart::Waiting,
                None => ViewerStart::Following,
            };
            ViewerLayout::from_lanes(lanes, opens).send(&stream)?;
            streams.push(OpenStream::new(stream, None, if all { SessionTime::ZERO } else { GAZE_EVERY }));
        }
        Ok(RerunWriter { streams })
    }

    /// Writes what stays as it is.
    pub fn fixed(&self, lane: &StreamLane, rows: &[EntityUpdate]) {
        for row in rows {
            let (entity, components) = written(lane, row);
            self.streams.iter().for_each(|one| one.log(&entity, true, &components));
        }
    }

    /// Writes a moment; the number of its rows.
    pub fn moment(&mut self, lane: &StreamLane, moment: &SceneUpdate) -> u64 {
        self.streams.iter_mut().for_each(|one| one.go_to(moment));
        for row in &moment.rows {
            let (entity, components) = written(lane, row);
            let is_gaze = matches!(row.shown, EntityData::Sight { .. });
            for one in &mut self.streams {
                if !is_gaze || one.shows_gaze(moment.time) {
                    one.log(&entity, false, &components);
                }
            }
        }
        moment.rows.len() as u64
    }

    /// Ends the file, if there is one; viewers that are connected keep what they have.
    pub fn finish(&self) {
        self.streams.iter().for_each(|one| one.stream.finalize_deferred_sinks());
    }
}

impl OpenStream {
    fn new(stream: RecordingStream, piece: Option<SessionTime>, gaze_every: SessionTime) -> OpenStream {
        OpenStream { stream, piece, nth: 0, gaze_every, gaze_at: None }
    }

    /// What is written from now on is of this moment.
    fn go_to(&mut self, moment: &SceneUpdate) {
        let nth = self.piece.map_or(0, |piece| moment.time.0 / piece.0);
        if nth != self.nth {
            self.nth = nth;
            // It fails where the file cannot be written, which its end tells.
            let _ = self.stream.flush_async();
        }
        let nanoseconds = |time: u64| re_sdk::TimeCell::from_duration_nanos(i64::try_from(time).unwrap_or(i64::MAX));
        // Whole milliseconds are read more easily, and nothing is shown that is closer together.
        self.stream.set_time(TRIAL_TIME, nanoseconds(moment.trial.0 / MS * MS));
        self.stream.set_time("session_time", nanoseconds(moment.time.0));
        self.stream.set_time_sequence("step", i64::try_from(moment.step).unwrap_or(i64::MAX));
    }

    /// Whether a sample of gaze at this time is shown.
    fn shows_gaze(&mut self, time: SessionTime) -> bool {
        let shows = self.gaze_at.is_none_or(|last| time - last >= self.gaze_every);
        if shows {
            self.gaze_at = Some(time);
        }
        shows
    }

    fn log(&self, entity: &str, is_fixed: bool, components: &[SerializedComponentBatch]) {
        // It fails where components cannot be written down, and these can.
        let _ = self.stream.log_serialized_batches(entity, is_fixed, components.iter().cloned());
    }
}

/// A row as Rerun writes it: its entity, and what that shows.
fn written(lane: &StreamLane, row: &EntityUpdate) -> (String, Vec<SerializedComponentBatch>) {
    let entity = match lane.root.as_str() {
        "" => row.entity.clone(),
        root => format!("{root}/{}", row.entity),
    };
    let parts = parts(&row.shown);
    (entity, parts.iter().flat_map(|part| part.as_serialized_batches()).collect())
}

/// A stream that goes nowhere yet. Its rows are handed on in pieces of this length, by the clock.
fn stream(identity: &StreamIdentity, piece: Duration) -> io::Result<RecordingStream> {
    let config = ChunkBatcherConfig {
        flush_tick: piece,
        flush_num_bytes: WAITING_BYTES,
        max_bytes_in_flight: WAITING_IN_ALL,
        ..ChunkBatcherConfig::DEFAULT
    };
    // The environment variable of Rerun's tools does not switch it off.
    let stream = RecordingStreamBuilder::new(APPLICATION)
        .recording_id(identity.id.as_str())
        .recording_name(identity.name.as_str())
        .enabled(true)
        .batcher_config(config)
        .buffered()
        .map_err(io::Error::other)?;
    // Times are those of the session alone.
    stream.set_log_time_enabled(false);
    stream.set_log_tick_enabled(false);
    Ok(stream)
}

/// Where viewers connect to a server.
pub fn uri(address: SocketAddr) -> String {
    format!("rerun+http://{address}/proxy")
}

/// A server of the viewer for browsers, until it is dropped.
pub struct WebViewer {
    _server: Box<dyn std::any::Any>,
}

impl WebViewer {
    /// Serves the viewer on this port of this machine.
    ///
    /// # Errors
    /// The port is taken.
    pub fn serve(port: u16) -> io::Result<WebViewer> {
        let config = WebViewerConfig {
            bind_ip: "127.0.0.1".to_string(),
            web_port: port.into(),
            open_browser: false,
            ..WebViewerConfig::default()
        };
        let server = re_sdk::serve_web_viewer(config).map_err(io::Error::other)?;
        Ok(WebViewer { _server: Box::new(server) })
    }
}

type Part = Box<dyn AsComponents>;

/// What Rerun calls it.
fn parts(shown: &EntityData) -> Vec<Part> {
    match shown {
        EntityData::Areas(areas) => vec![Box::new(areas_in_2d(areas))],
        EntityData::Discs(discs) => vec![Box::new(discs_in_2d(discs))],
        EntityData::Sight { at, around, colour } => sight_in_2d(*at, *around, colour_of(*colour)),
        EntityData::Points(points) => vec![Box::new(points_in_3d(points))],
        EntityData::Solids(solids, colour) => solids_in_3d(solids, colour_of(*colour)),
        EntityData::Place(place) => vec![Box::new(transform(place))],
        EntityData::Value(value) => vec![Box::new(archetypes::Scalars::single(*value))],
        EntityData::Line(SceneSeries { name, colour }) => {
            let line = archetypes::SeriesLines::new().with_names([name.as_str()]).with_colors([colour_of(*colour)]);
            vec![Box::new(line.with_widths([2.0]).with_interpolation_mode(InterpolationMode::StepAfter))]
        }
        EntityData::QuietLine(SceneSeries { name, colour }) => {
            let line = archetypes::SeriesLines::new().with_names([name.as_str()]).with_colors([colour_of(*colour)]);
            vec![Box::new(line.with_widths([1.0]).with_interpolation_mode(InterpolationMode::StepAfter))]
        }
        EntityData::Marks(SceneSeries { name, colour }, shape) => {
            let shape = match shape {
                MarkShape::Cross => MarkerShape::Cross,
                MarkShape::Circle => MarkerShape::Circle,
                MarkShape::Diamond => MarkerShape::Diamond,
            };
            let marks = archetypes::SeriesPoints::new().with_names([name.as_str()]).with_colors([colour_of(*colour)]);
            vec![Box::new(marks.with_markers([shape]).with_marker_sizes([4.0]))]
        }
        EntityData::Words { level, text, colour } => {
            let level = match level {
                LogLevel::Info => TextLogLevel::INFO,
                LogLevel::Warning => TextLogLevel::WARN,
                LogLevel::Error => TextLogLevel::ERROR,
            };
            vec![Box::new(archetypes::TextLog::new(&*printable(text)).with_level(level).with_color(colour_of(*colour)))]
        }
        EntityData::Page(text) => vec![Box::new(archetypes::TextDocument::from_markdown(&*printable_lines(text)))],
        EntityData::State(text) => vec![Box::new(archetypes::StateChange::single(&*printable(text)))],
    }
}

fn colour_of([red, green, blue, opacity]: [u8; 4]) -> Color {
    Color::from_unmultiplied_rgba(red, green, blue, opacity)
}

fn areas_in_2d(areas: &[SceneArea]) -> archetypes::Boxes2D {
    let corners = areas.iter().map(|area| [area.left as f32, area.top as f32]);
    let sizes = areas.iter().map(|area| [area.width as f32, area.height as f32]);
    archetypes::Boxes2D::from_mins_and_sizes(corners, sizes)
        .with_colors(areas.iter().map(|area| colour_of(area.colour)))
        .with_radii(areas.iter().map(|area| area.line as f32))
}

fn discs_in_2d(discs: &[SceneDisc]) -> archetypes::Points2D {
    archetypes::Points2D::new(discs.iter().map(|disc| disc.at.map(|length| length as f32)))
        .with_radii(discs.iter().map(|disc| disc.radius as f32))
        .with_colors(discs.iter().map(|disc| colour_of(disc.colour)))
        .with_labels(discs.iter().map(|disc| disc.words.as_str()))
        .with_show_labels(true)
}

/// One row of two archetypes: a point, and the circle around it.
fn sight_in_2d(at: [f64; 2], around: f64, colour: Color) -> Vec<Part> {
    let at = at.map(|length| length as f32);
    let circle = archetypes::Ellipses2D::from_half_sizes([[around as f32; 2]]).with_centers([at]).with_colors([colour]);
    let point = archetypes::Points2D::new([at]).with_radii([SIGHT_MM]).with_colors([colour]);
    vec![Box::new(circle.with_line_radii([LINE_MM])), Box::new(point)]
}

fn points_in_3d(points: &[ScenePoint]) -> archetypes::Points3D {
    archetypes::Points3D::new(points.iter().map(|point| point.at_m.map(|length| length as f32)))
        .with_radii(points.iter().map(|point| point.radius_m as f32))
        .with_colors(points.iter().map(|point| colour_of(point.colour)))
        .with_labels(points.iter().map(|point| point.words.as_str()))
}

fn metres(place: &Isometry3<f64>) -> [f32; 3] {
    place.translation.vector.cast::<f32>().into()
}

fn turn(place: &Isometry3<f64>) -> Quaternion {
    Quaternion::from_xyzw(place.rotation.cast::<f32>().coords.into())
}

fn transform(place: &Isometry3<f64>) -> archetypes::Transform3D {
    archetypes::Transform3D::from_translation_rotation(metres(place), turn(place))
}

/// Shapes of one kind are one archetype.
fn solids_in_3d(solids: &[CollisionSolid], colour: Color) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    let (mut cylinders, mut boxes, mut balls) = (Vec::new(), Vec::new(), Vec::new());
    for CollisionSolid { shape, link_from_solid: place } in solids {
        match shape {
            LinkShape::Cylinder { radius_m, length_m } => cylinders.push((place, *radius_m as f32, *length_m as f32)),
            LinkShape::Box { half_m } => boxes.push((place, half_m.map(|length| length as f32))),
            LinkShape::Sphere { radius_m } => balls.push((place, *radius_m as f32)),
        }
    }
    if !cylinders.is_empty() {
        let all = || cylinders.iter();
        let shapes = archetypes::Cylinders3D::from_lengths_and_radii(all().map(|one| one.2), all().map(|one| one.1));
        let placed = shapes.with_centers(all().map(|one| metres(one.0))).with_quaternions(all().map(|one| turn(one.0)));
        parts.push(Box::new(placed.with_colors([colour]).with_fill_mode(FillMode::Solid)));
    }
    if !boxes.is_empty() {
        let all = || boxes.iter();
        let shapes =
            archetypes::Boxes3D::from_centers_and_half_sizes(all().map(|one| metres(one.0)), all().map(|one| one.1));
        let placed = shapes.with_quaternions(all().map(|one| turn(one.0)));
        parts.push(Box::new(placed.with_colors([colour]).with_fill_mode(FillMode::Solid)));
    }
    if !balls.is_empty() {
        let all = || balls.iter();
        let shapes = archetypes::Points3D::new(all().map(|one| metres(one.0)));
        parts.push(Box::new(shapes.with_radii(all().map(|one| one.1)).with_colors([colour])));
    }
    parts
}
