//! The participant's gaze in a session: the sampling rate, faults of samples, and the locations looked at.

use tomcom_core::base::time::SessionTime;
use tomcom_core::gaze::GazeSample;
use tomcom_core::gaze::quality::{GazeFault, GazeFaultDetector};
use tomcom_core::kitchen::state::MAX_LOCATIONS;

/// State of the participant's gaze stream in a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStatus {
    /// Arrival time of the latest gaze sample, whether the sample was usable or not.
    pub arrived: Option<SessionTime>,
    /// The newest usable gaze sample that lies on the display, and its arrival time.
    pub last: Option<(SessionTime, GazeSample)>,
    /// Time at which the last gaze sample inside each location's area was taken: the participant's last look there.
    pub looked_at: [Option<SessionTime>; MAX_LOCATIONS],
    /// Locations in whose areas the latest gaze sample lies, as a bit set; empty if that sample is faulty or unusable, or
    /// was taken while the kitchen was not on the display.
    pub here: u32,
    /// Number of all gaze samples; samples with low confidence or outside the display are also counted in `unusable`.
    pub samples: u64,
    /// Number of gaze samples with too low a confidence or outside of the display.
    pub unusable: u64,
    /// Detector that finds faulty gaze samples and counts them by kind.
    pub judge: GazeFaultDetector,
    /// Fault of the latest gaze sample.
    pub fault: Option<GazeFault>,
    /// Sampling rate of the gaze in Hz, measured over about a second: see [`super::Session::gaze_hz`].
    pub(crate) rate_hz: f64,
    /// The present measurement of the sampling rate.
    pub(crate) measured: Option<RateMeasurement>,
}

/// A measurement of the sampling rate, from one gaze sample on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RateMeasurement {
    /// Arrival of the first sample.
    pub since: SessionTime,
    /// Time at which the first sample was taken.
    pub first_taken: SessionTime,
    /// Number of samples since.
    pub samples: u32,
}
