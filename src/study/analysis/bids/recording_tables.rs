//! The BIDS tables of one recording: events, gaze samples, fixations and blinks, arm samples and beliefs.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::analysis::bids::events::{self, EventCells, EventRow, event_columns};
use crate::analysis::bids::{BidsFile, described, heading, names, row, seconds};
use crate::column::{Levels, TableColumn, columns};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::kitchen::Agent;
use tomcom_core::robot::ArmSample;
use tomcom_session::event::{Event, TrialEndReason};
use tomcom_session::gaze_check::GazeCheckEvent;
use tomcom_session::plan::AnswerFormat;
use tomcom_session::probes::ProbeEvent;
use tomcom_session::protocol::ProtocolEvent;
use tomcom_session::settings::GazeSource;
use tomcom_session::tracker::TrackerEvent;
use tomcom_session::wall_display::DisplayEvent;
use tomcom_session::{Session, TimestampedEvent, TrialPhase};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PressOutcome {
    pub effective: bool,
    /// `None` for presses that are not judged: those of the robot, and those outside the trial.
    pub error: Option<bool>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct BidsRowCounts {
    pub events: u64,
    pub gaze: u64,
    pub eye_events: u64,
    pub arm: u64,
    pub beliefs: u64,
    /// Number of events that were left out because they contain words that somebody typed.
    pub words_left_out: u64,
}

#[derive(Debug)]
pub struct RecordingTables {
    with_words: bool,
    rows: Vec<EventRow>,
    spans: OpenSpans,
    eye_events: Vec<EyeEvent>,
    long: Vec<LongTableRow>,
    is_pointer: bool,
    /// Size of the display's page in pixels; BIDS asks for it, but it is known only if a display was connected.
    resolution: Option<[u32; 2]>,
    gaze_checks: u64,
    words_left_out: u64,
    pub(crate) ended: Option<TrialEndReason>,
}

impl RecordingTables {
    /// `with_words`: whether text that somebody typed is exported, too.
    pub fn new(session: &Session, with_words: bool) -> RecordingTables {
        RecordingTables {
            with_words,
            rows: Vec::new(),
            spans: OpenSpans::default(),
            eye_events: Vec::new(),
            long: Vec::new(),
            is_pointer: session.spec.participant.gaze == GazeSource::Mouse,
            resolution: None,
            gaze_checks: 0,
            words_left_out: 0,
            ended: None,
        }
    }

    /// Adds an event that was applied to the session. `outcome`: effect and judgement of the event, if it is a press.
    pub fn note(&mut self, stamped: &TimestampedEvent, session: &Session, outcome: Option<PressOutcome>) {
        let eye_event = eye_event(stamped);
        let is_of_eyes = eye_event.is_some();
        self.eye_events.extend(eye_event);
        match &stamped.event {
            Event::Gaze(sample) => {
                let time = sample.taken_ns.unwrap_or(stamped.time);
                let line = row(&gaze_columns(), &LoggedSample { logged: stamped, sample });
                return self.long.push(LongTableRow { table: LongTable::Gaze, time, line });
            }
            Event::RobotMoves(sample) => {
                let (time, line) = (stamped.time, row(&arm_columns(), &LoggedSample { logged: stamped, sample }));
                return self.long.push(LongTableRow { table: LongTable::Arm, time, line });
            }
            Event::TrialEnded { reason } => self.ended = Some(*reason),
            Event::TrialAborted { .. } => self.ended = Some(TrialEndReason::Aborted),
            Event::Calibration(GazeCheckEvent::Measured { found: Some(_) }) => self.gaze_checks += 1,
            Event::Display(DisplayEvent::Connected { width_px, height_px }) => {
                self.resolution = Some([*width_px, *height_px]);
            }
            _ => {}
        }
        self.long.extend(belief_rows(stamped));
        let (duration, over) = self.spans.note(self.rows.len(), stamped.time, &stamped.event);
        for (row, lasted) in over {
            self.rows[row].duration = Some(lasted);
        }
        let mut cells = EventCells::default();
        cells.take(&stamped.event, is_words(&stamped.event, session));
        if let Event::Probe(ProbeEvent::Asked { question, .. } | ProbeEvent::Answered { question, .. }) = &stamped.event
            && let Some(open) = &session.probes.open
            && let Some(asked) = (*question as usize).checked_sub(1).and_then(|index| open.questions.get(index))
        {
            cells.ask_about(&asked.about);
        }
        self.words_left_out += u64::from(!self.with_words && !cells.words.is_empty());
        let is_on = matches!(session.phase, TrialPhase::Running | TrialPhase::Paused)
            || matches!(stamped.event, Event::TrialEnded { .. } | Event::TrialAborted { .. });
        self.rows.push(EventRow {
            onset: stamped.time,
            duration,
            kind: stamped.event.kind(),
            seq: stamped.seq,
            trial_time: is_on.then(|| session.trial_clock(stamped.time)),
            outcome,
            cells,
            is_of_eyes,
        });
    }

    /// The rows since the last call, to be written at once: a recording of hours has millions of them.
    pub fn take_rows(&mut self) -> std::vec::Drain<'_, LongTableRow> {
        self.long.drain(..)
    }

    /// End of the names of a long table's files, without the last ending.
    fn stem(&self, table: LongTable) -> &'static str {
        match table {
            LongTable::Gaze if self.is_pointer => "recording-pointer_physio",
            LongTable::Gaze => "recording-eye1_physio",
            LongTable::Arm => "recording-arm_stim",
            LongTable::Beliefs => "beh",
        }
    }

    /// End of a long table's file name, and its first line, which is empty for tables that BIDS wants without one.
    pub(crate) fn long_table(&self, table: LongTable) -> (String, String) {
        let stem = self.stem(table);
        match table {
            LongTable::Gaze | LongTable::Arm => (format!("{stem}.tsv.gz"), String::new()),
            LongTable::Beliefs => (format!("{stem}.tsv"), heading(&belief_columns())),
        }
    }

    /// The files of the recording's tables but the long ones, after the last event, with the numbers of rows of all of
    /// them. `long`: what was counted of the rows of the long tables, in the order of [`LongTable::ALL`]. In a recording
    /// without gaze, fixations and blinks are in the table of events.
    pub(crate) fn into_files(
        mut self,
        session: &Session,
        long: &[LongTableFacts; 3],
    ) -> (Vec<BidsFile>, BidsRowCounts) {
        let [gaze, arm, beliefs] = long;
        let has_gaze = gaze.rows > 0;
        let rows: Vec<&EventRow> = self.rows.iter().filter(|row| !(has_gaze && row.is_of_eyes)).collect();
        let counts = BidsRowCounts {
            events: rows.len() as u64,
            gaze: gaze.rows,
            eye_events: if has_gaze { self.eye_events.len() as u64 } else { 0 },
            arm: arm.rows,
            beliefs: beliefs.rows,
            words_left_out: self.words_left_out,
        };
        let columns = event_columns(self.with_words);
        let lines: String = rows.into_iter().map(|one| row(&columns, one)).collect();
        let mut about = described(&columns);
        tell_task(&mut about, session);
        about.insert("StimulusPresentation".to_string(), self.presentation(session));
        let mut files: Vec<BidsFile> = BidsFile::table("events", &columns, &lines, about).into();
        if beliefs.rows > 0 {
            let mut about = described(&belief_columns());
            tell_task(&mut about, session);
            about.insert("Description".to_string(), "Beliefs about the kitchen, an aspect a row".into());
            files.push(BidsFile::json("beh.json", &about.into()));
        }
        if has_gaze {
            let stem = self.stem(LongTable::Gaze);
            let mut about = self.about_gaze(session);
            tell_task(&mut about, session);
            tell_samples(&mut about, gaze, &gaze_columns());
            files.push(BidsFile::json(format!("{stem}.json"), &about.into()));
            if !self.eye_events.is_empty() {
                self.eye_events.sort_by_key(|found| found.onset);
                let columns = eye_event_columns();
                let mut about = described(&columns);
                tell_task(&mut about, session);
                about.insert("Columns".to_string(), json!(names(&columns)));
                about.insert("Description".to_string(), json!("Fixations and blinks, as the eye tracker found them"));
                about.insert("OnsetSource".to_string(), json!("timestamp"));
                let text: String = self.eye_events.iter().map(|found| row(&columns, found)).collect();
                files.push(BidsFile::new(format!("{stem}events.tsv.gz"), text));
                files.push(BidsFile::json(format!("{stem}events.json"), &about.into()));
            }
        }
        if arm.rows > 0 {
            let mut about = Map::new();
            tell_task(&mut about, session);
            tell_samples(&mut about, arm, &arm_columns());
            let told = "Motion of the robot's arm, which the participant sees; sampled while it moves";
            about.insert("Description".to_string(), json!(told));
            files.push(BidsFile::json(format!("{}.json", self.stem(LongTable::Arm)), &about.into()));
        }
        (files, counts)
    }

    fn presentation(&self, session: &Session) -> Value {
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

    fn about_gaze(&self, session: &Session) -> Map<String, Value> {
        let mut about = Map::new();
        let mut tell = |key: &str, value: Value| about.insert(key.to_string(), value);
        if self.is_pointer {
            tell("PhysioType", json!("generic"));
            tell("Description", json!("Place of the mouse pointer on the display, which stands in for gaze"));
            return about;
        }
        tell("PhysioType", json!("eyetrack"));
        tell("RecordedEye", json!("cyclopean"));
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

fn tell_task(about: &mut Map<String, Value>, session: &Session) {
    let title = &session.kitchen.title;
    let told = format!("A person and a robot cook together what is ordered, by pressing buttons: {title}");
    about.insert("TaskName".to_string(), json!(session.kitchen.name));
    about.insert("TaskDescription".to_string(), json!(told));
}

fn tell_samples<Row>(about: &mut Map<String, Value>, facts: &LongTableFacts, columns: &[TableColumn<Row>]) {
    about.insert("SamplingFrequency".to_string(), json!(facts.rate_hz()));
    about.insert("StartTime".to_string(), json!(facts.first.map_or(0.0, SessionTime::as_secs_f64)));
    about.insert("Columns".to_string(), json!(names(columns)));
    about.extend(described(columns));
}

fn is_words(event: &Event, session: &Session) -> bool {
    let Event::Protocol(ProtocolEvent::ItemAnswered { item, .. }) = event else { return false };
    let form = session.questionnaire().and_then(|asked| asked.form(asked.position(item)?));
    matches!(form, Some(AnswerFormat::Text { .. }))
}

/// Spans of time; those up to `Probe` end with the trial.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Span {
    Trial,
    Pause,
    Order(String),
    RobotPress,
    RobotIdle,
    RobotStop,
    RobotHold,
    Signal,
    Offer,
    Probe,
    Phase,
    Safety,
    Target,
    TrackerLoss,
    DisplayUnseen,
    DisplayLoss,
    Unfocused,
    EyesClosed,
}

#[derive(Debug, Default)]
struct OpenSpans(BTreeMap<Span, (usize, SessionTime)>);

impl OpenSpans {
    /// Notes an event that stands in row `row` of the table: returns the event's duration so far (`None` for a span
    /// that goes on), and the spans that the event ends, each as the row of the event that began the span and its
    /// duration.
    fn note(
        &mut self,
        row: usize,
        time: SessionTime,
        event: &Event,
    ) -> (Option<SessionTime>, Vec<(usize, SessionTime)>) {
        let (begins, ends) = (begun_span(event), ended_spans(event));
        let is_over = |span: &Span| match event {
            Event::SessionEnded => true,
            Event::TrialEnded { .. } | Event::TrialAborted { .. } => *span <= Span::Probe,
            _ => ends.contains(span) || begins.as_ref() == Some(span),
        };
        let over: Vec<(usize, SessionTime)> =
            self.0.iter().filter(|(span, _)| is_over(span)).map(|(_, (row, since))| (*row, time - *since)).collect();
        self.0.retain(|span, _| !is_over(span));
        match begins {
            Some(span) => {
                self.0.insert(span, (row, time));
                (None, over)
            }
            None => (Some(SessionTime::ZERO), over),
        }
    }
}

fn begun_span(event: &Event) -> Option<Span> {
    Some(match event {
        Event::TrialStarted => Span::Trial,
        Event::TrialPaused => Span::Pause,
        Event::Protocol(ProtocolEvent::PhaseStarted { .. }) => Span::Phase,
        Event::OrderShown { order, .. } => Span::Order(order.clone()),
        Event::RobotIntends { .. } => Span::RobotPress,
        Event::RobotIdles { .. } => Span::RobotIdle,
        Event::RobotStopped => Span::RobotStop,
        Event::RobotHeld { .. } => Span::RobotHold,
        Event::RobotSafety { .. } => Span::Safety,
        Event::SignalShown { .. } => Span::Signal,
        Event::OfferOpened(_) => Span::Offer,
        Event::Probe(ProbeEvent::Begun { .. }) => Span::Probe,
        Event::Calibration(GazeCheckEvent::TargetShown { .. }) => Span::Target,
        Event::Tracker(TrackerEvent::Lost { .. }) => Span::TrackerLoss,
        Event::Tracker(TrackerEvent::DisplayLost | TrackerEvent::OtherSurfaces { .. }) => Span::DisplayUnseen,
        Event::Tracker(TrackerEvent::Blink { closed: true, .. }) => Span::EyesClosed,
        Event::Display(DisplayEvent::Lost) => Span::DisplayLoss,
        Event::FocusLost => Span::Unfocused,
        _ => return None,
    })
}

/// The spans of time that an event ends. (An event that begins a span also ends an earlier span of the same kind; such
/// an earlier span is not listed here.)
fn ended_spans(event: &Event) -> Vec<Span> {
    match event {
        Event::TrialResumed => vec![Span::Pause],
        Event::OrderCleared { order } => vec![Span::Order(order.clone())],
        Event::Press { agent: Agent::Robot, .. } | Event::RobotAborts { .. } => vec![Span::RobotPress],
        Event::RobotIntends { .. } => vec![Span::RobotIdle],
        Event::RobotIdles { .. } => vec![Span::RobotPress],
        Event::RobotResumed => vec![Span::RobotStop],
        Event::RobotReleased { .. } => vec![Span::RobotHold],
        Event::SignalEnded { .. } => vec![Span::Signal],
        Event::OfferClosed { .. } => vec![Span::Offer],
        Event::Probe(ProbeEvent::Ended { .. }) => vec![Span::Probe],
        Event::Calibration(
            GazeCheckEvent::TargetsHidden | GazeCheckEvent::Dismissed | GazeCheckEvent::Begun { .. },
        ) => vec![Span::Target],
        Event::Tracker(TrackerEvent::Connected { .. }) => vec![Span::TrackerLoss],
        Event::Tracker(TrackerEvent::DisplayFound) => vec![Span::DisplayUnseen],
        Event::Tracker(TrackerEvent::Blink { closed: false, .. }) => vec![Span::EyesClosed],
        Event::Display(DisplayEvent::Connected { .. }) => vec![Span::DisplayLoss],
        Event::FocusRegained => vec![Span::Unfocused],
        _ => Vec::new(),
    }
}

const BELIEF_SOURCES: Levels = &[
    ("participant", "The belief of a simulated participant before its press"),
    ("estimate", "The belief estimate before the press, made from what could be known then"),
];

struct BeliefRow<'a> {
    seq: u64,
    source: &'static str,
    press: Option<u64>,
    aspect: &'a str,
    believes: &'a str,
    p_truth: f64,
    precision: Option<f64>,
}

fn belief_columns<'a>() -> Vec<TableColumn<BeliefRow<'a>>> {
    columns! { |row: BeliefRow<'a>|
        "seq", "", "Number of the event in the log, as in the events" => row.seq;
        "source", BELIEF_SOURCES, "Whose probabilities they are" => row.source;
        "press", "", "Number (seq) of the press that an estimate belongs to" => row.press;
        "aspect", "", "What is believed something of: a place, or the recipe of a dish" => row.aspect;
        "believes", "", "The likeliest value" => row.believes;
        "p_truth", "1", "Probability of the true value" => row.p_truth;
        "precision", "1", "Precision of the estimate: the sum of the parameters of its Dirichlet distribution"
            => row.precision;
    }
}

fn belief_rows(stamped: &TimestampedEvent) -> Vec<LongTableRow> {
    let (seq, columns) = (stamped.seq, belief_columns());
    let line = |one| LongTableRow { table: LongTable::Beliefs, time: stamped.time, line: row(&columns, &one) };
    match &stamped.event {
        Event::ParticipantBelieves(belief) => {
            let about = belief.aspects.iter().map(|one| BeliefRow {
                seq,
                source: "participant",
                press: None,
                aspect: &one.aspect,
                believes: &one.believes,
                p_truth: one.p_truth,
                precision: None,
            });
            about.map(line).collect()
        }
        Event::BeliefEstimated(estimate) => {
            let about = estimate.aspects.iter().map(|one| BeliefRow {
                seq,
                source: "estimate",
                press: Some(estimate.press),
                aspect: &one.aspect,
                believes: &one.believes,
                p_truth: one.p_truth,
                precision: Some(one.precision),
            });
            about.map(line).collect()
        }
        _ => Vec::new(),
    }
}

/// Intervals between samples that are longer than this count as gaps and are left out of the sampling rate, in seconds.
const GAP_S: f64 = 0.5;

struct LoggedSample<'a, Sample> {
    logged: &'a TimestampedEvent,
    sample: &'a Sample,
}

fn gaze_columns<'a>() -> Vec<TableColumn<LoggedSample<'a, GazeSample>>> {
    columns! { |row: LoggedSample<'a, GazeSample>|
        "timestamp", "s", "Session time at which the sample was taken, by the tracker's clock set against the \
            session's; where the tracker tells no time, when it arrived. Samples are in its order"
            => seconds(row.sample.taken_ns.unwrap_or(row.logged.time));
        "x_coordinate", "1", "Fraction of the display's width, from its left edge, as recorded: without the \
            offset that a gaze check found" => row.sample.x;
        "y_coordinate", "1", "Fraction of the display's height, from its upper edge downwards, as recorded"
            => row.sample.y;
        "confidence", "1", "The tracker's confidence, 0 to 1; below 0.6 the sample is not used"
            => row.sample.confidence;
        "arrival", "s", "Session time at which the sample arrived" => seconds(row.logged.time);
        "device_time", "s", "Time on the tracker's own clock" => row.sample.device_ns.map(device_seconds);
        "seq", "", "Number of the sample in the log" => row.logged.seq;
    }
}

const FOUND: Levels = &[
    ("fixation", "A fixation, as the tracker finds them"),
    ("eyes_closed", "Onset of a blink"),
    ("eyes_opened", "Offset of a blink"),
];

fn eye_event_columns() -> Vec<TableColumn<EyeEvent>> {
    columns! { |row: EyeEvent|
        "onset", "s", "Session time, as the timestamps of the samples" => seconds(row.onset);
        "duration", "s", "Of fixations; n/a where the tracker does not tell it" => row.duration_s;
        "trial_type", FOUND, "What the tracker found" => row.kind;
        "x_coordinate", "1", "Place of a fixation, in fractions of the display's width" => row.at.map(|[x, _]| x);
        "y_coordinate", "1", "The same, in fractions of its height" => row.at.map(|[_, y]| y);
        "dispersion", "deg", "How far the samples of a fixation are spread" => row.dispersion_deg;
        "confidence", "1", "The tracker's confidence, 0 to 1" => row.confidence;
        "seq", "", "Number of the event in the log" => row.seq;
    }
}

const PHASES: Levels = &[
    ("rests", "It stands above the buttons"),
    ("retracts", "Comes up from a button"),
    ("travels", "On its way over the buttons"),
    ("hovers", "Above its button, ready to press"),
    ("presses", "Down on its button"),
];

fn arm_columns<'a>() -> Vec<TableColumn<LoggedSample<'a, ArmSample>>> {
    columns! { |row: LoggedSample<'a, ArmSample>|
        "timestamp", "s", "Session time" => seconds(row.logged.time);
        "phase", PHASES, "What the arm does" => events::name(&row.sample.phase);
        "joint_1", "rad", "Angle of the first joint, from the base on" => row.sample.joints[0];
        "joint_2", "rad", "Angle of the second joint" => row.sample.joints[1];
        "joint_3", "rad", "Angle of the third joint" => row.sample.joints[2];
        "joint_4", "rad", "Angle of the fourth joint" => row.sample.joints[3];
        "joint_5", "rad", "Angle of the fifth joint" => row.sample.joints[4];
        "joint_6", "rad", "Angle of the sixth joint" => row.sample.joints[5];
        "force", "N", "The greatest contact force since the sample before" => row.sample.force_n;
        "hand_x", "m", "The middle of the participant's hand, in the frame of the arm's base" => row.sample.hand_m.map(|at_m| at_m[0]);
        "hand_y", "m", "The same, y" => row.sample.hand_m.map(|at_m| at_m[1]);
        "hand_z", "m", "The same, z" => row.sample.hand_m.map(|at_m| at_m[2]);
        "hand_distance", "m", "Distance of the participant's hand from the arm" => row.sample.hand_away_m;
        "seq", "", "Number of the sample in the log" => row.logged.seq;
    }
}

/// A table with too many rows to keep in memory: each row is written at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LongTable {
    Gaze,
    Arm,
    Beliefs,
}

impl LongTable {
    pub const ALL: [LongTable; 3] = [LongTable::Gaze, LongTable::Arm, LongTable::Beliefs];
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LongTableRow {
    pub table: LongTable,
    /// Time by which the rows of the table are ordered; rows of equal times keep their order.
    pub time: SessionTime,
    pub line: String,
}

/// What the sidecar file of a long table says of its rows, counted row by row in the order of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongTableFacts {
    pub rows: u64,
    first: Option<SessionTime>,
    last: Option<SessionTime>,
    /// Number, and sum in seconds, of the intervals that are no gaps.
    intervals: (f64, f64),
}

impl LongTableFacts {
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

#[derive(Debug)]
struct EyeEvent {
    onset: SessionTime,
    duration_s: Option<f64>,
    kind: &'static str,
    /// In fractions of the display.
    at: Option<[f64; 2]>,
    dispersion_deg: Option<f64>,
    confidence: f64,
    seq: u64,
}

/// A fixation or a blink that the eye tracker found; `None` for every other event.
fn eye_event(stamped: &TimestampedEvent) -> Option<EyeEvent> {
    let Event::Tracker(event) = &stamped.event else { return None };
    let seq = stamped.seq;
    Some(match *event {
        TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, began_ns, .. } => EyeEvent {
            onset: began_ns,
            duration_s: Some(duration_ms / 1000.0),
            kind: "fixation",
            at,
            dispersion_deg: Some(dispersion_deg),
            confidence,
            seq,
        },
        TrackerEvent::Blink { closed, confidence, taken_ns, .. } => EyeEvent {
            onset: taken_ns,
            duration_s: None,
            kind: if closed { "eyes_closed" } else { "eyes_opened" },
            at: None,
            dispersion_deg: None,
            confidence,
            seq,
        },
        _ => return None,
    })
}

/// Time on a tracker's clock, which can be negative, in seconds with nine decimals.
fn device_seconds(ns: i64) -> String {
    let sign = if ns < 0 { "-" } else { "" };
    format!("{sign}{}", seconds(SessionTime(ns.unsigned_abs())))
}
