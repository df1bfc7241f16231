//! The eye tracker: its settings, its connection, detection of the display, dropped input, fixations and blinks.

use serde::{Deserialize, Serialize};

use super::participant_settings::GazeSource;
use super::setting_checks::SettingError;
use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::quality::DroppedInputCounts;
use tomcom_core::gaze::device_clock::StampFault;
use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_core::gaze::tags::{DisplayTags, TagError};
use tomcom_core::kitchen::Kitchen;

/// Settings of the eye tracker.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrackerSpec {
    /// Network address of the computer on which the program Pupil Capture runs.
    pub address: String,
    /// Network port of Pupil Capture's interface Pupil Remote.
    pub port: u16,
    /// Name of the surface that Pupil Capture defines by the AprilTags on the wall display.
    pub surface: String,
    /// Corners of the tracked surface in fractions of the display: top left, top right, bottom right, bottom left. By
    /// default the surface that Pupil Capture creates by itself, the hull of the tags' black squares.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<[[f64; 2]; 4]>,
    /// Whether Pupil Capture makes a recording of every trial. Its own recordings are annotated in any case.
    pub record: bool,
    /// Path of the file from which gaze is replayed, relative to the session file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Time in the replayed gaze file at which the trial starts, in seconds after the file's first sample; negative:
    /// the trial starts before the first sample.
    pub file_start_s: f64,
    /// How gaze samples without a confidence are taken: in lines of JSON, in gaze files, and where Pupil Capture sends NaN.
    pub missing_confidence: MissingConfidence,
    /// Distance from the participant's eyes to the wall display, in metres.
    pub distance_m: f64,
    /// Drop-outs (times without gaze) of the simulated eye tracker; none by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gaps: Option<GazeGapSpec>,
}

/// How a gaze sample is taken whose source does not say how confident it is. Some trackers know no confidence at all;
/// others leave it out where they have lost the eyes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MissingConfidence {
    /// The sample is recorded with the confidence 1, and read.
    Good,
    /// The sample is recorded with the confidence 0, and not read.
    #[default]
    Bad,
}

impl MissingConfidence {
    /// The confidence with which such samples are recorded.
    pub fn confidence(self) -> f64 {
        match self {
            MissingConfidence::Good => 1.0,
            MissingConfidence::Bad => 0.0,
        }
    }
}

/// Drop-outs of the simulated eye tracker: periods without any gaze sample.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GazeGapSpec {
    /// Mean time from the end of a drop-out to the beginning of the next one, in seconds.
    pub every_s: f64,
    /// Shortest duration of a drop-out of gaze, in seconds. Durations are distributed evenly on a logarithmic scale.
    pub shortest_s: f64,
    /// Longest duration of a drop-out of gaze, in seconds.
    pub longest_s: f64,
}

impl Default for TrackerSpec {
    fn default() -> Self {
        let (address, surface) = ("127.0.0.1".to_string(), "wall".to_string());
        TrackerSpec {
            address,
            port: 50020,
            surface,
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
    /// Map from the tracked surface to the display: from these settings' corners, or else from the hull of the tags.
    ///
    /// # Errors
    /// The tags do not fit on the display, or the corners are no surface.
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

/// An event of the eye tracker. All events of the eye tracker come from outside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "what", rename_all = "snake_case")]
pub enum TrackerEvent {
    /// The eye tracker's program responds.
    Connected {
        /// Name by which the eye tracker identifies itself.
        device: String,
    },
    /// The eye tracker's program does not respond any more; connecting to the program is retried without limit.
    Lost {
        /// Why the connection to the tracker's program was lost.
        reason: String,
    },
    /// The eye tracker detects the wall display by its AprilTags.
    DisplayFound,
    /// The eye tracker does not detect the wall display, so no gaze on the display is known.
    DisplayLost,
    /// The eye tracker detects surfaces, but none of them is the wall display.
    OtherSurfaces {
        /// Names of the surfaces that the tracker detects.
        names: Vec<String>,
    },
    /// Several streams could be the eye tracker's, and the settings do not choose among them.
    SeveralStreams {
        /// Descriptions of the streams; empty: there are no longer several.
        streams: Vec<String>,
    },
    /// The eye tracker's program reports on its own recording of the trial.
    Recording {
        /// The state of the eye tracker's own recording.
        state: TrackerRecording,
    },
    /// Number of inputs from the tracker that could not be recorded since the session began; reported at most four
    /// times per second, when the number has grown.
    Dropped(DroppedInputCounts),
    /// A finished fixation that the eye tracker detected.
    Fixation {
        /// Position of the fixation in fractions of the display, if it was on the display.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<[f64; 2]>,
        /// Duration of the fixation, in milliseconds.
        duration_ms: f64,
        /// Dispersion of the fixation's gaze samples, in degrees.
        dispersion_deg: f64,
        /// The tracker's confidence in the fixation, 0 to 1.
        confidence: f64,
        /// Beginning of the fixation on the tracker's clock, in nanoseconds.
        device_ns: i64,
        /// Session time at which the fixation began.
        began_ns: SessionTime,
    },
    /// The clock of the tracker's time stamps was set, as several samples agree.
    ClockSet {
        /// By how much the tracker's clock was set ahead, in seconds; negative: back.
        by_s: f64,
        /// Arrival, in session time, of the first gaze sample whose time was uncertain until the step was detected.
        uncertain_since_ns: SessionTime,
    },
    /// The time stamps of gaze samples cannot be used, and samples count as taken when they arrive; or they can be used
    /// again.
    Stamps {
        /// What is wrong with the time stamps; nothing: they are those of a clock.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fault: Option<StampFault>,
    },
    /// Onset or offset of a blink that the eye tracker detected.
    Blink {
        /// Whether the eyes closed (onset of the blink); false: the eyes opened (offset).
        closed: bool,
        /// The tracker's confidence in the blink, 0 to 1.
        confidence: f64,
        /// Time of the blink's onset or offset on the tracker's clock, in nanoseconds.
        device_ns: i64,
        /// Session time of the blink's onset or offset.
        taken_ns: SessionTime,
    },
}

/// State of the recording that the eye tracker's own program makes of the trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrackerRecording {
    /// The tracker's recording began at our request.
    Begun,
    /// The tracker's recording that began at our request before this program ended goes on.
    GoesOn,
    /// The tracker's recording did not begin: its program is recording already, or cannot record.
    NotBegun,
    /// The tracker's recording ended before the trial ended.
    Ended,
    /// The tracker's program accepts no annotations.
    NotAnnotated,
}

/// State of the connection to the eye tracker's program.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum TrackerConnection {
    /// No message from the eye tracker's program has been received yet.
    #[default]
    Unknown,
    /// The eye tracker's program responds.
    Connected {
        /// Name by which the eye tracker identifies itself.
        device: String,
    },
    /// The eye tracker's program does not respond any more.
    Lost {
        /// Session time since which the tracker's program has not responded.
        since: SessionTime,
        /// Why the connection to the tracker's program was lost.
        reason: String,
    },
}

/// State of the eye tracker in a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackerStatus {
    /// State of the connection to the tracker's program.
    pub link: TrackerConnection,
    /// Whether the tracker detects the wall display; `None` if the tracker has not reported on the display.
    pub sees_display: Option<bool>,
    /// Names of the surfaces that the tracker detects instead of the wall display.
    pub other_surfaces: Vec<String>,
    /// Descriptions of the streams among which the settings do not choose the tracker's.
    pub several_streams: Vec<String>,
    /// What is wrong with the time stamps of gaze samples, because of which they are not used.
    pub stamp_fault: Option<StampFault>,
    /// Last report on the recording that the tracker's program makes of the trial.
    pub recording: Option<TrackerRecording>,
    /// Number of lost connections to the tracker's program.
    pub losses: u64,
    /// Numbers of the tracker's inputs that could not be recorded, by kind.
    pub dropped: DroppedInputCounts,
    /// How often the clock of the tracker's time stamps was set.
    pub clock_steps: u64,
    /// Number of fixations that the tracker detected.
    pub fixations: u64,
    /// Number of blinks that the tracker detected.
    pub blinks: u64,
}

impl TrackerStatus {
    /// Whether the tracker's program records the trial at our request.
    pub fn is_recording(&self) -> bool {
        matches!(self.recording, Some(TrackerRecording::Begun | TrackerRecording::GoesOn))
    }

    /// Applies an event of the eye tracker that the session accepts.
    pub(super) fn apply(&mut self, now: SessionTime, event: &TrackerEvent) {
        match event {
            TrackerEvent::Connected { device } => self.link = TrackerConnection::Connected { device: device.clone() },
            TrackerEvent::Lost { reason } => {
                self.losses += 1;
                self.link = TrackerConnection::Lost { since: now, reason: reason.clone() };
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

/// Whether the session accepts this event of the eye tracker.
///
/// # Errors
/// The reason for which the event is refused.
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
    match numbers.iter().all(|number| number.is_finite()) {
        true => Ok(()),
        false => Err("what the tracker tells is not a number"),
    }
}
