//! BIDS tables of gaze samples, of fixations and blinks that the eye tracker found, and of the robot arm's motion.

use serde_json::{Map, Value, json};

use super::event_cells;
use super::tsv::{self, BidsColumn, BidsFile, TaskFacts, device_seconds, or_nothing, seconds};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::robot::ArmSample;
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::{Session, TimestampedEvent};

/// Intervals between samples that are longer than this count as gaps and are left out of the sampling rate, in seconds.
const GAP_S: f64 = 0.5;

const GAZE: [BidsColumn; 7] = [
    BidsColumn::of_unit(
        "timestamp",
        "s",
        "Session time at which the sample was taken, by the tracker's clock set against the session's; where the tracker tells no time, \
         when it arrived. Samples are in its order",
    ),
    BidsColumn::of_unit(
        "x_coordinate",
        "1",
        "Fraction of the display's width, from its left edge, as recorded: without the offset that a gaze check found",
    ),
    BidsColumn::of_unit(
        "y_coordinate",
        "1",
        "Fraction of the display's height, from its upper edge downwards, as recorded",
    ),
    BidsColumn::of_unit("confidence", "1", "The tracker's confidence, 0 to 1; below 0.6 the sample is not used"),
    BidsColumn::of_unit("arrival", "s", "Session time at which the sample arrived"),
    BidsColumn::of_unit("device_time", "s", "Time on the tracker's own clock"),
    BidsColumn::new("seq", "Number of the sample in the log"),
];

const FOUND: &[(&str, &str)] = &[
    ("fixation", "A fixation, as the tracker finds them"),
    ("eyes_closed", "Onset of a blink"),
    ("eyes_opened", "Offset of a blink"),
];

const EYE_EVENTS: [BidsColumn; 8] = [
    BidsColumn::of_unit("onset", "s", "Session time, as the timestamps of the samples"),
    BidsColumn::of_unit("duration", "s", "Of fixations; n/a where the tracker does not tell it"),
    BidsColumn::of_levels("trial_type", FOUND, "What the tracker found"),
    BidsColumn::of_unit("x_coordinate", "1", "Place of a fixation, in fractions of the display's width"),
    BidsColumn::of_unit("y_coordinate", "1", "The same, in fractions of its height"),
    BidsColumn::of_unit("dispersion", "deg", "How far the samples of a fixation are spread"),
    BidsColumn::of_unit("confidence", "1", "The tracker's confidence, 0 to 1"),
    BidsColumn::new("seq", "Number of the event in the log"),
];

const PHASES: &[(&str, &str)] = &[
    ("rests", "It stands above the buttons"),
    ("retracts", "Comes up from a button"),
    ("travels", "On its way over the buttons"),
    ("hovers", "Above its button, ready to press"),
    ("presses", "Down on its button"),
];

const ARM: [BidsColumn; 14] = [
    BidsColumn::of_unit("timestamp", "s", "Session time"),
    BidsColumn::of_levels("phase", PHASES, "What the arm does"),
    BidsColumn::of_unit("joint_1", "rad", "Angle of the first joint, from the base on"),
    BidsColumn::of_unit("joint_2", "rad", "Angle of the second joint"),
    BidsColumn::of_unit("joint_3", "rad", "Angle of the third joint"),
    BidsColumn::of_unit("joint_4", "rad", "Angle of the fourth joint"),
    BidsColumn::of_unit("joint_5", "rad", "Angle of the fifth joint"),
    BidsColumn::of_unit("joint_6", "rad", "Angle of the sixth joint"),
    BidsColumn::of_unit("force", "N", "The greatest contact force since the sample before"),
    BidsColumn::of_unit("hand_x", "m", "The middle of the participant's hand, in the frame of the arm's base"),
    BidsColumn::of_unit("hand_y", "m", "The same, y"),
    BidsColumn::of_unit("hand_z", "m", "The same, z"),
    BidsColumn::of_unit("hand_distance", "m", "Distance of the participant's hand from the arm"),
    BidsColumn::new("seq", "Number of the sample in the log"),
];

/// A table with too many rows to keep in memory: each row is written at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LongTable {
    /// Gaze samples, in the order in which they were taken.
    Gaze,
    /// Samples of the robot's arm.
    Arm,
    /// Beliefs, an aspect a row.
    Beliefs,
}

impl LongTable {
    /// All long tables.
    pub const ALL: [LongTable; 3] = [LongTable::Gaze, LongTable::Arm, LongTable::Beliefs];
}

/// A row of a long table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LongTableRow {
    /// The table to which the row belongs.
    pub table: LongTable,
    /// Time by which the rows of the table are ordered; rows of equal times keep their order.
    pub time: SessionTime,
    /// Text of the row, including the line end.
    pub line: String,
}

/// What the sidecar file of a long table says of its rows, counted row by row in the order of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongTableFacts {
    /// Number of rows.
    pub rows: u64,
    first: Option<SessionTime>,
    last: Option<SessionTime>,
    /// Number, and sum in seconds, of the intervals that are no gaps.
    intervals: (f64, f64),
}

impl LongTableFacts {
    /// Counts the next row of the table.
    pub fn add(&mut self, time: SessionTime) {
        self.rows += 1;
        self.first = self.first.or(Some(time));
        let interval = self.last.replace(time).map(|last| time.secs_since(last));
        if let Some(interval) = interval.filter(|interval| *interval < GAP_S) {
            self.intervals = (self.intervals.0 + 1.0, self.intervals.1 + interval);
        }
    }

    /// Sampling rate in Hz over intervals without gaps; 0 if there is no such interval.
    fn rate_hz(&self) -> f64 {
        let (count, sum) = self.intervals;
        if sum > 0.0 { (1000.0 * count / sum).round() / 1000.0 } else { 0.0 }
    }
}

/// Rows of the BIDS tables of gaze samples, of fixations and blinks, and of arm samples.
#[derive(Debug, Default)]
pub(super) struct SampleRows {
    eye_events: Vec<(SessionTime, String)>,
}

impl SampleRows {
    pub(super) fn gaze(stamped: &TimestampedEvent, sample: &GazeSample) -> LongTableRow {
        let taken = sample.taken_ns.unwrap_or(stamped.time);
        let device = or_nothing(sample.device_ns.map(device_seconds));
        let (x, y, confidence) = (sample.x.to_string(), sample.y.to_string(), sample.confidence.to_string());
        let cells = [seconds(taken), x, y, confidence, seconds(stamped.time), device, stamped.seq.to_string()];
        LongTableRow { table: LongTable::Gaze, time: taken, line: tsv::line(cells) }
    }

    pub(super) fn arm(stamped: &TimestampedEvent, sample: &ArmSample) -> LongTableRow {
        let joints = sample.joints.iter().map(f64::to_string);
        let hand = sample.hand_m.iter().map(f64::to_string);
        let cells = [seconds(stamped.time), event_cells::name(&sample.phase)].into_iter().chain(joints);
        let cells = cells.chain([sample.force_n.to_string()]).chain(hand);
        let cells = cells.chain([sample.hand_away_m.to_string(), stamped.seq.to_string()]);
        LongTableRow { table: LongTable::Arm, time: stamped.time, line: tsv::line(cells) }
    }

    /// Adds a fixation or a blink that the eye tracker found; returns `false` for every other event of the tracker.
    pub(super) fn note_found(&mut self, stamped: &TimestampedEvent, event: &TrackerEvent) -> bool {
        let (onset, cells) = match event {
            TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, began_ns, .. } => {
                let [x, y] = [at.map(|at| at[0]), at.map(|at| at[1])].map(or_nothing);
                let duration = (duration_ms / 1000.0).to_string();
                let numbers = [dispersion_deg.to_string(), confidence.to_string()];
                let [dispersion, confidence] = numbers;
                (*began_ns, [duration, "fixation".to_string(), x, y, dispersion, confidence])
            }
            TrackerEvent::Blink { closed, confidence, taken_ns, .. } => {
                let kind = if *closed { "eyes_closed" } else { "eyes_opened" }.to_string();
                let none = || tsv::NOTHING.to_string();
                (*taken_ns, [none(), kind, none(), none(), none(), confidence.to_string()])
            }
            _ => return false,
        };
        let cells = [seconds(onset)].into_iter().chain(cells).chain([stamped.seq.to_string()]);
        self.eye_events.push((onset, tsv::line(cells)));
        true
    }

    /// Number of fixations and blinks.
    pub(super) fn found(&self) -> u64 {
        self.eye_events.len() as u64
    }

    /// The sidecar files of the long tables of samples that have rows, and the table of fixations and blinks. In a
    /// recording without gaze, fixations and blinks are in the table of events.
    pub(super) fn into_files(
        mut self,
        session: &Session,
        about: &ViewingFacts,
        task: &TaskFacts,
        long: &[LongTableFacts; 3],
    ) -> Vec<BidsFile> {
        let [gaze, arm, _] = long;
        self.eye_events.sort_by_key(|(time, _)| *time);
        let mut files = Vec::new();
        if gaze.rows > 0 {
            let mut sidecar = about.sidecar(session);
            task.tell(&mut sidecar);
            add_table(&mut sidecar, gaze, &GAZE);
            files.push(BidsFile::json(format!("{}.json", about.stem(LongTable::Gaze)), &sidecar.into()));
            if !self.eye_events.is_empty() {
                let mut sidecar = tsv::described(&EYE_EVENTS);
                task.tell(&mut sidecar);
                sidecar.insert("Columns".to_string(), json!(tsv::names(&EYE_EVENTS)));
                sidecar.insert("Description".to_string(), json!("Fixations and blinks, as the eye tracker found them"));
                sidecar.insert("OnsetSource".to_string(), json!("timestamp"));
                let name = format!("{}events", about.stem(LongTable::Gaze));
                let text: String = self.eye_events.iter().map(|(_, line)| line.as_str()).collect();
                files.push(BidsFile::new(format!("{name}.tsv.gz"), text));
                files.push(BidsFile::json(format!("{name}.json"), &sidecar.into()));
            }
        }
        if arm.rows > 0 {
            let mut sidecar = Map::new();
            task.tell(&mut sidecar);
            add_table(&mut sidecar, arm, &ARM);
            let told = "Motion of the robot's arm, which the participant sees; sampled while it moves";
            sidecar.insert("Description".to_string(), json!(told));
            files.push(BidsFile::json(format!("{}.json", about.stem(LongTable::Arm)), &sidecar.into()));
        }
        files
    }
}

/// What is known of the participant's view of the display and of the gaze data, for sidecar files.
#[derive(Clone, Debug)]
pub(super) struct ViewingFacts {
    /// Whether the gaze is the position of a mouse pointer, not of an eye.
    pub is_pointer: bool,
    /// Size of the display's page in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Number of gaze accuracy checks.
    pub gaze_checks: u64,
}

impl ViewingFacts {
    /// End of the names of a long table's files, without the last ending.
    pub(super) fn stem(&self, table: LongTable) -> &'static str {
        match table {
            LongTable::Gaze if self.is_pointer => "recording-pointer_physio",
            LongTable::Gaze => "recording-eye1_physio",
            LongTable::Arm => "recording-arm_stim",
            LongTable::Beliefs => "beh",
        }
    }

    /// Description of the wall display for the sidecar file of the table of events.
    pub(super) fn presentation(&self, session: &Session) -> Value {
        let mut display = json!({
            "ScreenDistance": session.spec.tracker.distance_m,
            "ScreenOrigin": ["top", "left"],
            "ScreenSize": session.kitchen.display_m,
            "SoftwareName": "tomcom",
        });
        if let Some(resolution) = self.resolution {
            display["ScreenResolution"] = json!(resolution);
        }
        display
    }

    fn sidecar(&self, session: &Session) -> Map<String, Value> {
        let mut about = Map::new();
        let mut tell = |key: &str, value: Value| about.insert(key.to_string(), value);
        if self.is_pointer {
            tell("PhysioType", json!("generic"));
            tell("Description", json!("Place of the mouse pointer on the display, which stands in for gaze"));
            return about;
        }
        tell("PhysioType", json!("eyetrack"));
        tell("RecordedEye", json!("cyclopean"));
        // BIDS asks for the display's size in pixels, which is known only if a display was connected.
        if self.resolution.is_some() {
            tell("SampleCoordinateSystem", json!("gaze-on-screen"));
        } else {
            let [width, height] = session.kitchen.display_m;
            tell("SampleCoordinateSystem", json!("custom"));
            let told = format!(
                "Fractions of the display's width and height from its upper left corner, y downwards; the display is {width} m wide and \
                 {height} m high"
            );
            tell("SampleCoordinateSystemDescription", json!(told));
        }
        match session.spec.participant.gaze {
            GazeSource::Pupil => _ = tell("Manufacturer", json!("Pupil Labs")),
            GazeSource::Simulated => _ = tell("ManufacturersModelName", json!("simulated eyes of tomcom")),
            _ => {}
        }
        tell("CalibrationCount", json!(self.gaze_checks));
        if let Some(accepted) = &session.calibrated {
            let found = &accepted.found;
            tell("AverageCalibrationError", json!(found.accuracy_deg));
            tell("AverageCalibrationErrorCorrected", json!(found.corrected_deg));
            tell("GazeOffset", json!(found.offset));
        }
        about
    }
}

/// Adds the sampling rate, the first time and the columns of a table of samples to the table's sidecar file.
fn add_table(sidecar: &mut Map<String, Value>, facts: &LongTableFacts, columns: &[BidsColumn]) {
    sidecar.insert("SamplingFrequency".to_string(), json!(facts.rate_hz()));
    sidecar.insert("StartTime".to_string(), json!(facts.first.map_or(0.0, SessionTime::as_secs_f64)));
    sidecar.insert("Columns".to_string(), json!(tsv::names(columns)));
    sidecar.extend(tsv::described(columns));
}
