//! The participant's gaze in a session: the rate of its samples, their faults, and which locations are looked at.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::gaze::quality::{GazeFault, SampleChecker};
use crate::kitchen::state::MAX_LOCATIONS;

/// State of the gaze stream in a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStatus {
    /// Arrival time of the latest sample, usable or not.
    pub arrived: Option<SessionTime>,
    /// The newest usable sample that lies on the display, and when it arrived.
    pub last: Option<(SessionTime, GazeSample)>,
    /// Time of the last look at each location (gaze inside its area).
    pub looked_at: [Option<SessionTime>; MAX_LOCATIONS],
    /// Number of samples; samples with low confidence or outside the display are counted in `unusable`.
    pub samples: u64,
    /// Of these, samples with too low a confidence or outside of the display.
    pub unusable: u64,
    /// Detector and counts of faulty samples.
    pub judge: SampleChecker,
    /// Fault of the latest sample.
    pub fault: Option<GazeFault>,
    /// Sampling rate in Hz, smoothed over about a second: see [`super::Session::gaze_hz`].
    pub(crate) rate_hz: f64,
    /// Start of the present gapless run of samples; `None` after a pause.
    pub(crate) steady_since: Option<SessionTime>,
}
