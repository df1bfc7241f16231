//! The eye tracker: its settings, its connection, detection of the display, dropped input, fixations and blinks.

use serde::{Deserialize, Serialize};

use crate::admit::unless;
use crate::settings::{GazeSource, SettingError};
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_core::gaze::quality::DroppedInputCounts;
use tomcom_core::gaze::tags::{DisplayTags, SurfaceHomography, TagError};
use tomcom_core::kitchen::Kitchen;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrackerSpec {
    /// The computer on which Pupil Capture runs.
    pub address: String,
    /// Of Pupil Capture's interface Pupil Remote.
    pub port: u16,
    /// The surface that Pupil Capture defines by the AprilTags on the wall display.
    pub surface: String,
    /// Corners of the surface in fractions of the display: top left, top right, bottom right, bottom left. By default
    /// the surface that Pupil Capture creates by itself, the hull of the tags' black squares.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<[[f64; 2]; 4]>,
    /// Whether Pupil Capture makes a recording of every trial. Its own recordings are annotated in any case.
    pub record: bool,
    /// File from which gaze is replayed, relative to the session file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Time in that file at which the trial starts, after its first sample; negative: before it.
    pub file_start_s: f64,
    /// In lines of JSON, in gaze files, and where Pupil Capture sends NaN.
    pub missing_confidence: MissingConfidence,
    /// From the participant's eyes to the wall display.
    pub distance_m: f64,
    /// Drop-outs of the simulated eye tracker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<GazeGapSpec>,
}

/// How a gaze sample is taken whose source does not say how confident it is. Some trackers know no confidence at all;
/// others leave it out where they have lost the eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MissingConfidence {
    /// Recorded with the confidence 1, and read.
    Good,
    /// Recorded with the confidence 0, and not read.
    #[default]
    Bad,
}

impl MissingConfidence {
    pub fn confidence(self) -> f64 {
        match self {
            MissingConfidence::Good => 1.0,
            MissingConfidence::Bad => 0.0,
        }
    }
}

/// Periods without any gaze sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeGapSpec {
    /// Mean time from the end of a drop-out to the beginning of the next one.
    pub every_s: f64,
    /// Durations are distributed evenly on a logarithmic scale.
    pub shortest_s: f64,
    pub longest_s: f64,
}

impl Default for TrackerSpec {
    fn default() -> Self {
        TrackerSpec {
            address: "127.0.0.1".to_string(),
            port: 50020,
            surface: "wall".to_string(),
            corners: None,
            record: true,
            file: None,
            file_start_s: 0.0,
            missing_confidence: MissingConfidence::default(),
            distance_m: 2.0,
            gaps: None,
        }
    }
}

impl TrackerSpec {
    /// From these settings' corners, or else from the hull of the tags; an error if the tags do not fit on the display,
    /// or the corners are no surface.
    pub fn surface_map(&self, kitchen: &Kitchen) -> Result<SurfaceHomography, TagError> {
        let corners = match self.corners {
            Some(corners) => corners,
            None => DisplayTags::place(kitchen)?.hull(),
        };
        SurfaceHomography::new(corners).ok_or_else(|| TagError {
            found: format!("corners = {corners:?}"),
            remedy: "a convex quadrangle".to_string(),
        })
    }

    pub(super) fn check(&self, gaze: GazeSource) -> Result<(), SettingError> {
        if let Some(GazeGapSpec { shortest_s, longest_s, .. }) = self.gaps
            && shortest_s > longest_s
        {
            let found = format!("shortest_s = {shortest_s}, longest_s = {longest_s}");
            return Err(SettingError::new("tracker.gaps", found, "a longest drop-out of at least the shortest one"));
        }
        let is_short = |text: &str| (1..=100).contains(&text.len()) && !text.chars().any(char::is_control);
        if !is_short(&self.address) || self.address.contains(char::is_whitespace) {
            let found = format!("address = {:?}", self.address);
            return Err(SettingError::new("tracker.address", found, "1 to 100 signs without spaces"));
        }
        // Pupil Capture's own names contain spaces: its first surface is "Surface 1".
        if !is_short(&self.surface) || self.surface.trim() != self.surface {
            let found = format!("surface = {:?}", self.surface);
            let remedy = "the surface's name in Capture: 1 to 100 signs, no space before and after it";
            return Err(SettingError::new("tracker.surface", found, remedy));
        }
        if let Some(corners) = self.corners
            && SurfaceHomography::new(corners).is_none()
        {
            let remedy = "four corners in fractions of the display: top left, top right, bottom right, bottom left";
            return Err(SettingError::new("tracker.corners", format!("corners = {corners:?}"), remedy));
        }
        if gaze == GazeSource::File && self.file.is_none() {
            let remedy = "file = \"gaze.csv\" in [tracker], or --gaze-file PATH";
            return Err(SettingError::new("participant.gaze", "gaze = \"file\", and no file".to_string(), remedy));
        }
        Ok(())
    }
}

/// All of them come from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum TrackerEvent {
    Connected {
        /// Name by which it identifies itself.
        device: String,
    },
    /// Connecting is retried without limit.
    Lost { reason: String },
    /// The tracker detects the wall display by its AprilTags.
    DisplayFound,
    /// No gaze on the display is known.
    DisplayLost,
    /// The tracker detects surfaces, but none of them is the wall display.
    OtherSurfaces { names: Vec<String> },
    /// Several streams could be the tracker's, and the settings do not choose among them.
    SeveralStreams {
        /// Descriptions; empty: there are no longer several.
        streams: Vec<String>,
    },
    /// Of the tracker's own recording of the trial.
    Recording { state: TrackerRecording },
    /// Inputs that could not be recorded since the session began; reported at most four times per second, when the
    /// number has grown.
    Dropped(DroppedInputCounts),
    /// A finished fixation.
    Fixation {
        /// In fractions of the display, if it was there.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<[f64; 2]>,
        duration_ms: f64,
        /// Of its gaze samples.
        dispersion_deg: f64,
        /// 0 to 1.
        confidence: f64,
        /// Its beginning on the tracker's clock.
        device_ns: i64,
        began_ns: SessionTime,
    },
    /// The clock of the tracker's time stamps was set, as several samples agree.
    ClockSet {
        /// Negative: back.
        by_s: f64,
        /// Arrival of the first gaze sample whose time was uncertain until the step was detected.
        uncertain_since_ns: SessionTime,
    },
    /// Time stamps cannot be used, and samples count as taken when they arrive; or they can be used again.
    Stamps {
        /// `None`: they are those of a clock.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fault: Option<StampFault>,
    },
    /// Onset or offset of a blink.
    Blink {
        /// Onset; false: offset.
        closed: bool,
        /// 0 to 1.
        confidence: f64,
        /// On the tracker's clock.
        device_ns: i64,
        taken_ns: SessionTime,
    },
}

/// Of the recording that the tracker's own program makes of the trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrackerRecording {
    /// At our request.
    Begun,
    /// It began at our request before this program ended.
    GoesOn,
    /// The tracker's program is recording already, or cannot record.
    NotBegun,
    /// Before the trial ended.
    Ended,
    /// The tracker's program accepts no annotations.
    NotAnnotated,
}

/// To the tracker's program, or to the button box.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceConnection {
    /// No message has been received yet.
    #[default]
    Unknown,
    /// By its name or path.
    Connected { device: String },
    /// Why, and since when.
    Lost { since: SessionTime, reason: String },
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackerStatus {
    pub link: DeviceConnection,
    /// `None` if the tracker has not reported on the display.
    pub sees_display: Option<bool>,
    /// Surfaces that the tracker detects instead of the wall display.
    pub other_surfaces: Vec<String>,
    /// Streams among which the settings do not choose.
    pub several_streams: Vec<String>,
    /// Why the time stamps of gaze samples are not used.
    pub stamp_fault: Option<StampFault>,
    /// The last report on the tracker's own recording.
    pub recording: Option<TrackerRecording>,
    /// Number of lost connections.
    pub losses: u64,
    /// Inputs that could not be recorded, by kind.
    pub dropped: DroppedInputCounts,
    /// How often the clock of the tracker's time stamps was set.
    pub clock_steps: u64,
    pub fixations: u64,
    pub blinks: u64,
}

impl TrackerStatus {
    /// Whether the tracker's program records the trial at our request.
    pub fn is_recording(&self) -> bool {
        matches!(self.recording, Some(TrackerRecording::Begun | TrackerRecording::GoesOn))
    }

    pub(super) fn apply(&mut self, now: SessionTime, event: &TrackerEvent) {
        match event {
            TrackerEvent::Connected { device } => self.link = DeviceConnection::Connected { device: device.clone() },
            TrackerEvent::Lost { reason } => {
                self.losses += 1;
                self.link = DeviceConnection::Lost { since: now, reason: reason.clone() };
                self.sees_display = None;
                self.other_surfaces.clear();
            }
            TrackerEvent::DisplayFound => {
                self.sees_display = Some(true);
                self.other_surfaces.clear();
            }
            TrackerEvent::DisplayLost => self.sees_display = Some(false),
            TrackerEvent::OtherSurfaces { names } => self.other_surfaces.clone_from(names),
            TrackerEvent::SeveralStreams { streams } => self.several_streams.clone_from(streams),
            TrackerEvent::Recording { state: TrackerRecording::NotAnnotated } => {}
            TrackerEvent::Recording { state } => self.recording = Some(*state),
            TrackerEvent::Stamps { fault } => self.stamp_fault = *fault,
            TrackerEvent::Dropped(counts) => self.dropped = *counts,
            TrackerEvent::ClockSet { .. } => self.clock_steps += 1,
            TrackerEvent::Fixation { .. } => self.fixations += 1,
            TrackerEvent::Blink { closed, .. } => self.blinks += u64::from(*closed),
        }
    }
}

pub(super) fn admit(event: &TrackerEvent) -> Result<(), &'static str> {
    let numbers = match event {
        TrackerEvent::Fixation { at, duration_ms, dispersion_deg, confidence, .. } => {
            let [x, y] = at.unwrap_or_default();
            vec![x, y, *duration_ms, *dispersion_deg, *confidence]
        }
        TrackerEvent::Blink { confidence, .. } => vec![*confidence],
        TrackerEvent::ClockSet { by_s, .. } => vec![*by_s],
        TrackerEvent::Stamps { fault: Some(StampFault::Rate(rate)) } => vec![*rate],
        _ => Vec::new(),
    };
    unless(numbers.iter().all(|number| number.is_finite()), "what the tracker tells is not a number")
}
