//! Output for the viewer program Rerun; only this module and its submodules use Rerun's SDK. Updates of a 3D scene
//! become rows of a stream, which goes to a file, to viewers that connect to a server of this program, or both.
//!
//! This program never connects to a viewer: a slow or stopped viewer would delay the stream, and the file with it.
//! Viewers connect to the program instead (`rerun/viewer_server.rs`), and read the messages that are kept for them.

mod blueprint;
mod kept_messages;
mod viewer_page;
mod viewer_server;

use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use nalgebra::Isometry3;
use re_sdk::log::{ChunkBatcherConfig, TimeColumn};
use re_sdk::sink::FileSink;
use re_sdk::{AsComponents, RecordingStream, RecordingStreamBuilder, SerializedComponentBatch};
use re_sdk_types::AnyValues;
use re_sdk_types::archetypes;
use re_sdk_types::components::{
    Color, FillMode, InterpolationMode, MarkerShape, MediaType, Text, TextLogLevel, VideoTimestamp,
};
use re_sdk_types::datatypes::Quaternion;

use self::blueprint::{APPLICATION, SESSION_TIME, ViewerLayout, ViewerStart, film_entity};
pub use self::blueprint::{ShownRecording, TRIAL_TIME};
pub use self::viewer_page::WebViewer;
use self::viewer_server::ViewerServer;
use crate::scene::entity_content::{
    MarkShape, SceneArea, SceneLabel, SceneLogLevel, ScenePicture, ScenePoint, SeriesStyle,
};
use crate::scene::{EntityData, EntityUpdate, SceneUpdate};
use tomcom_arm::kinematics::{CollisionSolid, LinkShape};
use tomcom_core::base::text::{printable, printable_lines};
use tomcom_core::base::time::SessionTime;

/// Version of Rerun with which streams are written; viewers of the same version can read the streams.
pub const VERSION: &str = "0.36.3";
/// The timeline of events, beside those of the clocks.
const STEP: &str = "step";
/// The timeline whose only row is the last one of the stream: a viewer that has it has the whole stream.
const END: &str = "end";
/// A millisecond in nanoseconds.
const MS: u64 = 1_000_000;
/// Largest delay with which connected viewers get data.
const PIECE: Duration = Duration::from_millis(300);
/// Duration of a piece (chunk) of a stream file, in session time. Every piece of every entity costs some 2 kB in the
/// file besides its rows, and some 6 kB of memory until the index at the end of the file is written.
const PIECE_OF_FILE: SessionTime = SessionTime(120_000_000_000);
/// Largest size of rows that wait for the end of their piece of the stream, in bytes: of one entity, and of all.
const WAITING_BYTES: u64 = 1 << 20;
const WAITING_IN_ALL: u64 = 16 << 20;
/// Size of the past data that is kept for viewers that connect later, in bytes.
const KEPT_BYTES: usize = 32 << 20;
/// Least time between two gaze samples that viewers of a running session get; more frequent samples could not be seen.
const GAZE_EVERY: SessionTime = SessionTime(33_000_000);

/// Radius of a gaze point, and half the line width of the circle around the newest one.
const SIGHT: f32 = 4.0;
const LINE: f32 = 2.0;
/// Radius of the gaze points of the last moment.
const RECENT: f32 = 8.0;
/// Opacity of pictures: the viewer draws the transparent parts of pictures black that are wholly opaque.
const OPACITY: f32 = 0.999;
/// Drawing order of pictures of the lowest layer: below outlines and labels.
const LOWEST: f32 = -20.0;

/// Identity of a Rerun stream: id and name, and what a viewer shows as properties of its recordings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StreamIdentity {
    pub id: String,
    pub name: String,
    /// For each recording a title, and facts with their names.
    pub facts: Vec<(String, Vec<(&'static str, String)>)>,
}

/// A moment of a film: the time in the film, on the trial's clock, and of the session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmFrame {
    pub film: SessionTime,
    pub trial: SessionTime,
    pub session: SessionTime,
}

/// Outputs of a Rerun stream: a file, a server, or both.
#[derive(Clone, Debug, Default)]
pub struct StreamOutlets {
    pub file: Option<PathBuf>,
    /// Address of the server for viewers.
    pub server: Option<SocketAddr>,
}

/// Writer of a Rerun stream. The writer serves each output independently, so that no output delays another.
pub struct RerunWriter {
    streams: Vec<OpenStream>,
}

/// Rerun stream to one of its outputs, file or server.
struct OpenStream {
    stream: RecordingStream,
    /// Duration of the stream's pieces in session time; `None` if rows are passed on by the wall clock instead.
    piece: Option<SessionTime>,
    /// Index of the present piece (chunk) of the stream.
    nth: u64,
    /// Least time between two gaze samples that the stream contains.
    gaze_every: SessionTime,
    /// Time of the last gaze sample in the stream.
    gaze_at: Option<SessionTime>,
    now: [i64; 3],
    sights: Sights,
}

/// Gaze samples of one entity, which are written together at the end of their piece: a recording of hours has millions,
/// and a row for each would take most of the time.
#[derive(Default)]
struct Sights {
    entity: String,
    times: Vec<[i64; 3]>,
    at: Vec<[f32; 2]>,
    colours: Vec<Color>,
}

impl RerunWriter {
    /// Opens a stream to these outputs, and sends the stream's layout, in which a viewer shows these recordings side by
    /// side.
    ///
    /// # Errors
    /// The file cannot be created, or the address does not belong to this machine.
    pub fn open(
        identity: &StreamIdentity,
        outlets: &StreamOutlets,
        lanes: &[ShownRecording],
    ) -> io::Result<RerunWriter> {
        let mut streams = Vec::new();
        if let Some(path) = &outlets.file {
            let stream = stream(identity, Duration::MAX)?;
            stream.set_sinks((FileSink::new(path).map_err(io::Error::other)?,));
            ViewerLayout::from_lanes(lanes, ViewerStart::Waiting).send(&stream)?;
            streams.push(OpenStream::new(stream, Some(PIECE_OF_FILE), SessionTime::ZERO));
        }
        if let Some(address) = outlets.server {
            let stream = stream(identity, PIECE)?;
            stream.set_sink(Box::new(ViewerServer::open(address, KEPT_BYTES)?));
            ViewerLayout::from_lanes(lanes, ViewerStart::Following).send(&stream)?;
            streams.push(OpenStream::new(stream, None, GAZE_EVERY));
        }
        Ok(RerunWriter { streams })
    }

    /// Writes rows that hold for the whole stream, without a time.
    pub fn fixed(&self, lane: &ShownRecording, rows: &[EntityUpdate]) {
        for row in rows {
            let (entity, components) = (entity(lane, row), components(row));
            self.streams.iter().for_each(|one| one.log(&entity, true, &components));
            if let EntityData::SightRadius(radius) = row.shown {
                let circle = archetypes::Ellipses2D::update_fields().with_half_sizes([[radius as f32; 2]]);
                let circle = circle.with_line_radii([LINE]).as_serialized_batches();
                let dot = archetypes::Points2D::update_fields().with_radii([RECENT]).as_serialized_batches();
                for one in &self.streams {
                    one.log(&around(&entity), true, &circle);
                    one.log(&recent(&entity), true, &dot);
                }
            }
        }
    }

    /// Writes the rows of a scene update to the stream; returns the number of rows.
    pub fn moment(&mut self, lane: &ShownRecording, moment: &SceneUpdate) -> u64 {
        self.streams.iter_mut().for_each(|one| one.go_to(moment));
        for row in &moment.rows {
            let entity = entity(lane, row);
            let sight = match row.shown {
                EntityData::Sight { at, colour } => Some((at, colour_of(colour))),
                _ => None,
            };
            // A file gets gaze samples together with the others of their piece, viewers get each of them at once.
            if let Some(sight) = sight {
                let files = self.streams.iter_mut().filter(|one| one.piece.is_some());
                files.for_each(|one| one.see(&entity, moment.time, sight));
            }
            let is_at_once = |one: &OpenStream| sight.is_none() || one.piece.is_none();
            if !self.streams.iter().any(is_at_once) {
                continue;
            }
            let (components, circle) = (components(row), sight.map(|sight| [circle(sight)]));
            for one in self.streams.iter_mut().filter(|one| is_at_once(one)) {
                if sight.is_some() && !one.shows_gaze(moment.time) {
                    continue;
                }
                one.log(&entity, matches!(row.shown, EntityData::WholePage(_)), &components);
                if let Some(circle) = &circle {
                    one.log(&around(&entity), false, &batches(circle));
                    one.log(&recent(&entity), false, &components);
                }
            }
        }
        moment.rows.len() as u64
    }

    /// Writes a film (MP4), by its number from 0, with the moments at which its frames are seen.
    pub fn film(&mut self, lane: &ShownRecording, film: usize, content: Vec<u8>, frames: &[FilmFrame]) {
        let entity = film_entity(lane, film);
        let asset = archetypes::AssetVideo::from_file_contents(content, None::<MediaType>).as_serialized_batches();
        let whole = |time: SessionTime| i64::try_from(time.0).unwrap_or(i64::MAX);
        let times = frames.iter().map(|frame| VideoTimestamp::from_nanos(whole(frame.film)));
        let frames_of = archetypes::VideoFrameReference::update_fields().with_many_timestamp(times);
        let timelines = || {
            [
                TimeColumn::new_duration_nanos(
                    TRIAL_TIME,
                    frames.iter().map(|frame| whole(frame.trial)).collect::<Vec<i64>>(),
                ),
                TimeColumn::new_duration_nanos(
                    SESSION_TIME,
                    frames.iter().map(|frame| whole(frame.session)).collect::<Vec<i64>>(),
                ),
            ]
        };
        for one in &self.streams {
            one.log(&entity, true, &asset);
            // Writing fails only if components cannot be serialised, and these components can.
            if let Ok(columns) = frames_of.clone().columns_of_unit_batches() {
                let _ = one.stream.send_columns(entity.as_str(), timelines(), columns);
            }
        }
    }

    /// Closes the stream's file, to which nothing is written any more; returns false if there is none. Viewers still get
    /// the stream.
    pub fn close_file(&mut self) -> bool {
        let before = self.streams.len();
        self.streams.retain(|one| one.piece.is_none());
        self.streams.len() < before
    }

    /// Completes the stream's file, if there is one; connected viewers keep the data that they have.
    pub fn finish(&mut self) {
        self.streams.iter_mut().for_each(|one| {
            one.write_sights();
            // What waits is written before the row that says that all is there.
            let _ = one.stream.flush_blocking();
            one.stream.reset_time();
            one.stream.set_time_sequence(END, 0);
            one.log(END, false, &archetypes::Scalars::single(0.0).as_serialized_batches());
            one.stream.finalize_deferred_sinks();
        });
    }
}

impl OpenStream {
    fn new(stream: RecordingStream, piece: Option<SessionTime>, gaze_every: SessionTime) -> OpenStream {
        OpenStream { stream, piece, nth: 0, gaze_every, gaze_at: None, now: [0; 3], sights: Sights::default() }
    }

    /// Sets the time of the rows that are written to the stream next.
    fn go_to(&mut self, moment: &SceneUpdate) {
        let nth = self.piece.map_or(0, |piece| moment.time.0 / piece.0);
        if nth != self.nth {
            self.nth = nth;
            self.write_sights();
            // Errors of the stream's file are reported when the file is completed.
            let _ = self.stream.flush_async();
        }
        // The timeline shows whole milliseconds, which are easier to read; no two updates are closer together.
        self.now = [whole(moment.trial.ms() * MS), whole(moment.time.0), whole(moment.step)];
        let [trial, session, step] = self.now;
        self.stream.set_time(TRIAL_TIME, re_sdk::TimeCell::from_duration_nanos(trial));
        self.stream.set_time(SESSION_TIME, re_sdk::TimeCell::from_duration_nanos(session));
        self.stream.set_time_sequence(STEP, step);
    }

    /// Keeps a gaze sample until the end of its piece.
    fn see(&mut self, entity: &str, time: SessionTime, (at, colour): ([f64; 2], Color)) {
        if !self.shows_gaze(time) {
            return;
        }
        if self.sights.entity != entity {
            self.write_sights();
            self.sights.entity = entity.to_string();
        }
        self.sights.times.push(self.now);
        self.sights.at.push(at.map(|length| length as f32));
        self.sights.colours.push(colour);
    }

    /// Writes the gaze samples that wait.
    fn write_sights(&mut self) {
        let Sights { entity, times, at, colours } = std::mem::take(&mut self.sights);
        if times.is_empty() {
            return;
        }
        let indexes = |of: &[usize]| {
            let timeline = |index: usize| of.iter().map(|&nth| times[nth][index]).collect::<Vec<i64>>();
            [
                TimeColumn::new_duration_nanos(TRIAL_TIME, timeline(0)),
                TimeColumn::new_duration_nanos(SESSION_TIME, timeline(1)),
                TimeColumn::new_sequence(STEP, timeline(2)),
            ]
        };
        // A circle at every sample would cost as much again as the points.
        let (all, mut some) = ((0..times.len()).collect::<Vec<usize>>(), vec![0]);
        for &nth in &all {
            if some.last().is_some_and(|&last| times[nth][1] - times[last][1] >= GAZE_EVERY.0 as i64) {
                some.push(nth);
            }
        }
        let points = archetypes::Points2D::update_fields().with_positions(at.iter().copied());
        let circles = archetypes::Ellipses2D::update_fields().with_centers(some.iter().map(|&nth| at[nth]));
        let (points, circles) =
            (points.with_colors(colours.iter().copied()), circles.with_colors(some.iter().map(|&nth| colours[nth])));
        let dots = archetypes::Points2D::update_fields().with_positions(some.iter().map(|&nth| at[nth]));
        let dots = dots.with_colors(some.iter().map(|&nth| colours[nth]));
        // Writing fails only if components cannot be serialised, and these components can.
        if let Ok(points) = points.columns_of_unit_batches() {
            let _ = self.stream.send_columns(entity.as_str(), indexes(&all), points);
        }
        if let (Ok(circles), Ok(dots)) = (circles.columns_of_unit_batches(), dots.columns_of_unit_batches()) {
            let _ = self.stream.send_columns(around(&entity), indexes(&some), circles);
            let _ = self.stream.send_columns(recent(&entity), indexes(&some), dots);
        }
    }

    /// Whether a gaze sample at this time is written to the stream (samples that come too fast are left out).
    fn shows_gaze(&mut self, time: SessionTime) -> bool {
        let shows = self.gaze_at.is_none_or(|last| time - last >= self.gaze_every);
        if shows {
            self.gaze_at = Some(time);
        }
        shows
    }

    fn log(&self, entity: &str, is_fixed: bool, components: &[SerializedComponentBatch]) {
        // Logging fails only if components cannot be serialised, and these components can.
        let _ = self.stream.log_serialized_batches(entity, is_fixed, components.iter().cloned());
    }
}

impl Drop for OpenStream {
    fn drop(&mut self) {
        self.write_sights();
    }
}

fn entity(lane: &ShownRecording, row: &EntityUpdate) -> String {
    match lane.root.as_str() {
        "" => row.entity.clone(),
        root => format!("{root}/{}", row.entity),
    }
}

fn components(row: &EntityUpdate) -> Vec<SerializedComponentBatch> {
    batches(&parts(&row.shown))
}

fn batches(parts: &[Part]) -> Vec<SerializedComponentBatch> {
    parts.iter().flat_map(|part| part.as_serialized_batches()).collect()
}

/// A Rerun stream without an output yet. The stream passes rows on in pieces of this duration of the wall clock.
fn stream(identity: &StreamIdentity, piece: Duration) -> io::Result<RecordingStream> {
    let config = ChunkBatcherConfig {
        flush_tick: piece,
        flush_num_bytes: WAITING_BYTES,
        max_bytes_in_flight: WAITING_IN_ALL,
        ..ChunkBatcherConfig::DEFAULT
    };
    // The stream is enabled even if the environment variable of Rerun's SDK turns streams off.
    let stream = RecordingStreamBuilder::new(APPLICATION)
        .recording_id(identity.id.as_str())
        .recording_name(identity.name.as_str())
        .enabled(true)
        .batcher_config(config)
        .buffered()
        .map_err(io::Error::other)?;
    // The stream contains only times of the session, not times of Rerun's SDK.
    stream.set_log_time_enabled(false);
    stream.set_log_tick_enabled(false);
    for (recording, facts) in &identity.facts {
        let facts = facts
            .iter()
            .fold(AnyValues::default(), |facts, (name, value)| facts.with_component::<Text>(*name, [value.as_str()]));
        stream.send_property(recording.as_str(), &facts).map_err(io::Error::other)?;
    }
    Ok(stream)
}

/// Address of a server in the form that Rerun's viewers expect.
pub fn uri(address: SocketAddr) -> String {
    format!("rerun+http://{address}/proxy")
}

type Part = Box<dyn AsComponents>;

/// Rerun's archetypes (kinds of graphical elements) that show these data of an entity.
fn parts(shown: &EntityData) -> Vec<Part> {
    match shown {
        EntityData::Areas(areas) => vec![Box::new(areas_in_2d(areas))],
        EntityData::Labels(labels) => vec![Box::new(labels_in_2d(labels))],
        EntityData::Picture(picture) => picture_in_2d(picture),
        EntityData::Sight { at, colour } => {
            let point = archetypes::Points2D::update_fields().with_positions([at.map(|length| length as f32)]);
            vec![Box::new(point.with_colors([colour_of(*colour)]))]
        }
        EntityData::SightRadius(_) => {
            vec![Box::new(archetypes::Points2D::update_fields().with_radii([SIGHT]))]
        }
        EntityData::Points(points) => vec![Box::new(points_in_3d(points))],
        EntityData::Solids(solids, colour) => solids_in_3d(solids, colour_of(*colour)),
        EntityData::Place(place) => vec![Box::new(transform(place))],
        EntityData::Value(value) => vec![Box::new(archetypes::Scalars::single(*value))],
        // A curve ends at a row without a number.
        EntityData::NoValue => vec![Box::new(archetypes::Scalars::new(std::iter::empty::<f64>()))],
        EntityData::Line(SeriesStyle { name, colour }) => {
            let line = archetypes::SeriesLines::update_fields().with_names([name.as_str()]).with_widths([2.0]);
            let line = line.with_interpolation_mode(InterpolationMode::StepAfter);
            vec![Box::new(line.with_colors([colour_of(*colour)]))]
        }
        EntityData::Marks(SeriesStyle { name, colour }, shape) => {
            let shape = match shape {
                MarkShape::Cross => MarkerShape::Cross,
                MarkShape::Diamond => MarkerShape::Diamond,
            };
            let marks = archetypes::SeriesPoints::update_fields().with_names([name.as_str()]);
            let marks = marks.with_markers([shape]).with_marker_sizes([4.0]);
            vec![Box::new(marks.with_colors([colour_of(*colour)]))]
        }
        EntityData::Words { level, text, colour } => {
            let level = match level {
                SceneLogLevel::Info => TextLogLevel::INFO,
                SceneLogLevel::Warning => TextLogLevel::WARN,
                SceneLogLevel::Error => TextLogLevel::ERROR,
            };
            vec![Box::new(
                archetypes::TextLog::new(&*printable_lines(text)).with_level(level).with_color(colour_of(*colour)),
            )]
        }
        EntityData::Page(text) | EntityData::WholePage(text) => {
            vec![Box::new(archetypes::TextDocument::from_markdown(&*printable_lines(text)))]
        }
        EntityData::State(text, colour) => state(&printable(text), colour_of(*colour)),
    }
}

/// A state of a lane with the colour of its bar; without a text, the end of the one before.
fn state(text: &str, colour: Color) -> Vec<Part> {
    let change: Part = Box::new(archetypes::StateChange::single(text));
    let style: Part = Box::new(archetypes::StateConfiguration::new().with_values([text]).with_colors([colour]));
    if text.is_empty() { vec![change] } else { vec![change, style] }
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

fn labels_in_2d(labels: &[SceneLabel]) -> archetypes::Points2D {
    archetypes::Points2D::new(labels.iter().map(|label| label.at.map(|length| length as f32)))
        .with_radii([0.0])
        .with_colors(labels.iter().map(|label| colour_of(label.colour)))
        .with_labels(labels.iter().map(|label| label.words.as_str()))
        .with_show_labels(true)
}

/// Rerun draws a pixel of an image as a unit of length: the transform gives the image its place and size.
fn picture_in_2d(picture: &ScenePicture) -> Vec<Part> {
    // Width and height stand in the first chunk of a PNG file.
    let number = |from: usize| Some(u32::from_be_bytes(picture.png.get(from..from + 4)?.try_into().ok()?));
    let pixels = [16, 20].map(|from| number(from).map_or(1.0, f64::from));
    let scale = [picture.width / pixels[0], picture.height / pixels[1], 1.0].map(|factor| factor as f32);
    let place = archetypes::Transform3D::from_translation_scale([picture.left as f32, picture.top as f32, 0.0], scale);
    let image = archetypes::EncodedImage::from_file_contents(picture.png.to_vec());
    vec![Box::new(place), Box::new(image.with_draw_order(LOWEST + f32::from(picture.layer)).with_opacity(OPACITY))]
}

fn whole(number: u64) -> i64 {
    i64::try_from(number).unwrap_or(i64::MAX)
}

/// Entity of the large gaze points of the last moment.
fn recent(gaze: &str) -> String {
    format!("{gaze}/recent")
}

/// Entity of the circle around the newest gaze point. The viewer shows the points of the last seconds, but one circle.
fn around(gaze: &str) -> String {
    format!("{gaze}/around")
}

fn circle((at, colour): ([f64; 2], Color)) -> Part {
    let at = at.map(|length| length as f32);
    Box::new(archetypes::Ellipses2D::update_fields().with_centers([at]).with_colors([colour]))
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

/// Rerun's elements for collision solids: all solids of one shape are in one element.
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
