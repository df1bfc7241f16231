//! The participant's gaze in a session: the rate of its samples, their faults, and which locations are looked at.

use crate::base::time::SessionTime;
use crate::gaze::GazeSample;
use crate::gaze::quality::{GazeFault, SampleChecker};
use crate::kitchen::state::MAX_LOCATIONS;

/// The participant's gaze as far as the console needs it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GazeStatus {
    /// When the newest sample came, usable or not.
    pub arrived: Option<SessionTime>,
    pub last: Option<(SessionTime, GazeSample)>,
    /// When each location was last looked at (gaze inside its area), indexed by location.
    pub looked_at: [Option<SessionTime>; MAX_LOCATIONS],
    /// Samples so far; those with too low a confidence or outside of the display are counted apart.
    pub samples: u64,
    pub unusable: u64,
    /// Those that were recorded and are not read, by kind.
    pub judge: SampleChecker,
    /// What is wrong with the newest sample.
    pub fault: Option<GazeFault>,
    /// Samples a second, smoothed over about a second: see [`super::Session::gaze_hz`].
    pub(crate) rate_hz: f64,
    /// Since when samples come without a gap; nothing after a pause.
    pub(crate) steady_since: Option<SessionTime>,
}
